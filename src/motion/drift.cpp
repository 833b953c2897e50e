#include "motion/drift.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "motion/drift.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "body/cells.h"
#include "core/parallel.h"
#include "core/simd-inl.h"
#include "core/vector.h"

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {
namespace {

template <class T>
struct SineCosine {
  T sine, cosine;
};

/// For |x| up to 0.2, where the series is exact to round-off.
template <class T>
CAIRN_INLINE SineCosine<T> sine_cosine_series(T x) {
  const T x2 = x * x, one(1.0);
  T s = fma(x2, T(-1.0 / 110), one), c = fma(x2, T(-1.0 / 132), one);
  s = fma(x2 * T(-1.0 / 72), s, one);
  c = fma(x2 * T(-1.0 / 90), c, one);
  s = fma(x2 * T(-1.0 / 42), s, one);
  c = fma(x2 * T(-1.0 / 56), c, one);
  s = fma(x2 * T(-1.0 / 20), s, one);
  c = fma(x2 * T(-1.0 / 30), c, one);
  s = fma(x2 * T(-1.0 / 6), s, one);
  c = fma(x2 * T(-1.0 / 12), c, one);
  return {x * s, fma(T(-0.5) * x2, c, one)};
}

/// The angles of a step are small; others are halved until they are. No library's sine: their last bits
/// differ.
template <class T>
CAIRN_INLINE SineCosine<T> sine_cosine(T x) {
  const T limit(0.2), half(0.5);
  if (!any(abs(x) > limit)) return sine_cosine_series(x);
  int halvings = 0;
  T small = x;
  for (; halvings < 64 && any(abs(small) > limit); ++halvings) small = half * small;
  SineCosine<T> out = sine_cosine_series(small);
  for (; halvings > 0; --halvings) {
    const T sine = T(2.0) * out.sine * out.cosine, cosine = fma(T(-2.0) * out.sine, out.sine, T(1.0));
    out = {sine, cosine};
  }
  return out;
}

/// Quat, one or several at a time.
template <class T>
struct Quaternion {
  T w;
  Triple<T> v;

  CAIRN_INLINE friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {fma(a.w, b.w, -dot(a.v, b.v)), fma(a.w, b.v, fma(b.w, a.v, cross(a.v, b.v)))};
  }
  CAIRN_INLINE Quaternion conjugate() const { return {w, T(-1.0) * v}; }
  CAIRN_INLINE Triple<T> rotate(const Triple<T>& a) const {
    const Triple<T> b = cross(v, a);
    return fma(T(2.0), fma(w, b, cross(v, b)), a);
  }
  CAIRN_INLINE Quaternion normalized() const {
    const T scale = rsqrt(fma(w, w, dot(v, v)));
    return {scale * w, scale * v};
  }
};

template <int k, class T>
CAIRN_INLINE T& component(Triple<T>& a) {
  if constexpr (k == 0)
    return a.x;
  else if constexpr (k == 1)
    return a.y;
  else
    return a.z;
}

/// Free flow of H = p_k^2 / (2 I_k) over dt: body-frame momentum p turns by -angle about axis k, the attitude
/// by +angle.
template <int k, class T>
CAIRN_INLINE void turn(Quaternion<T>& q, Triple<T>& p, Triple<T> inverse_inertia, T dt) {
  constexpr int a = (k + 1) % 3, b = (k + 2) % 3;
  const SineCosine<T> half = sine_cosine(T(0.5) * dt * component<k>(p) * component<k>(inverse_inertia));
  const T sine = T(2.0) * half.sine * half.cosine, cosine = fma(T(-2.0) * half.sine, half.sine, T(1.0));
  T &pa = component<a>(p), &pb = component<b>(p);
  const T pa0 = pa, pb0 = pb;
  pa = fma(cosine, pa0, sine * pb0);
  pb = fma(cosine, pb0, -(sine * pa0));
  Quaternion<T> about{half.cosine, {T(0.0), T(0.0), T(0.0)}};
  component<k>(about.v) = half.sine;
  q = q * about;
}

/// Rotation over dt, in the body frame before it, of a free top with momentum p in that frame.
template <class T>
CAIRN_INLINE Quaternion<T> free_top_turn(Triple<T> p, const Triple<T>& inertia, T dt) {
  const T one(1.0), zero(0.0), half = T(0.5) * dt;
  const Triple<T> inverse{one / inertia.x, one / inertia.y, one / inertia.z};
  Quaternion<T> q{one, {zero, zero, zero}};
  turn<0>(q, p, inverse, half);
  turn<1>(q, p, inverse, half);
  turn<2>(q, p, inverse, dt);
  turn<1>(q, p, inverse, half);
  turn<0>(q, p, inverse, half);
  return q;
}

/// Balls of a block, each with the turn of its step: the vector along the axis whose length is the tangent of
/// half the angle (and a number that is not used).
struct Turns {
  std::size_t count = 0;
  std::size_t ball[kBodyBlock];
  alignas(64) double half[kBodyBlock][4];

  void add(std::size_t b, const Vec3& turn) {
    ball[count] = b;
    Eigen::Map<Vec3>{half[count]} = turn;
    half[count++][3] = 0.0;
  }
};

/// Balls turn, quaternion by quaternion, exactly.
void turn_balls(Bodies& bodies, const Turns& turns) {
  for (std::size_t k = 0; k < turns.count; k += kLanes) {
    double* rows[kLanes];
    const double* halves[kLanes];
    for (std::size_t l = 0; l < kLanes; ++l) {  // spare places repeat a ball
      const std::size_t turn = std::min(k + l, turns.count - 1);
      rows[l] = bodies.orientation[turns.ball[turn]].coeffs().data();
      halves[l] = turns.half[turn];
    }
    Batch q[4], h[4];
    load_transposed(rows, q);
    load_transposed(halves, h);
    const Triple<Batch> half{h[0], h[1], h[2]}, v{q[0], q[1], q[2]};
    const Batch w = fma(-half.x, v.x, fma(-half.y, v.y, fma(-half.z, v.z, q[3])));  // (1, half) q
    const Triple<Batch> turned = fma(q[3], half, cross(half, v) + v);
    // 1 / length; the series is exact to round-off below the limit.
    const Batch length2 = fma(w, w, dot(turned, turned)), e = length2 - Batch(1.0), limit(1e-4);
    Batch scale = fma(e, fma(e, fma(e, Batch(-0.3125), Batch(0.375)), Batch(-0.5)), Batch(1.0));
    if (any(abs(e) > limit)) scale = select(abs(e) > limit, rsqrt(length2), scale);
    store_transposed({scale * turned.x, scale * turned.y, scale * turned.z, scale * w}, rows);
  }
}

/// kLanes bodies turn over dt; spare places repeat a body.
void turn_bodies(Bodies& bodies, const std::size_t (&index)[kLanes], double dt, std::size_t begin,
                 std::span<Vec3> spin_mid) {
  double* rows[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) rows[l] = bodies.orientation[index[l]].coeffs().data();
  const auto gather = [&](const std::vector<Vec3>& from) HWY_ATTR -> Triple<Batch> {
    Lanes x, y, z;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const Vec3& v = from[index[l]];
      x[l] = v.x();
      y[l] = v.y();
      z[l] = v.z();
    }
    return {x.batch(), y.batch(), z.batch()};
  };
  const Triple<Batch> momentum = gather(bodies.spin), inertia = gather(bodies.inertia);
  Batch q[4];
  load_transposed(rows, q);
  const Quaternion<Batch> attitude{q[3], {q[0], q[1], q[2]}};
  const Batch step(dt);
  const Quaternion<Batch> turn = free_top_turn(attitude.conjugate().rotate(momentum), inertia, step);
  const Triple<Batch> w = attitude.rotate(Batch(2.0) / (step * turn.w) * turn.v);
  const Quaternion<Batch> turned = (attitude * turn).normalized();
  store_transposed({turned.v.x, turned.v.y, turned.v.z, turned.w}, rows);
  const Lanes x(w.x), y(w.y), z(w.z);
  for (std::size_t l = 0; l < kLanes; ++l) spin_mid[index[l] - begin] = {x[l], y[l], z[l]};
}

/// x + rest += way, with what x cannot hold in `rest` (Knuth's two-sum). Equal steps are rounded alike:
/// without this a body in free flight moves on average by another velocity than its momentum's.
void add_exactly(Vec3& x, Vec3& rest, const Vec3& way) {
  const Vec3 all = way + rest, sum = x + all, taken = sum - x;
  rest = (x - (sum - taken)) + (all - taken);
  x = sum;
}

/// tan(x) / x, from x^2.
double tangent_ratio(double x2) {
  if (x2 > 1e-4) {
    const double x = std::sqrt(x2);
    const SineCosine<double> at = sine_cosine(x);
    return at.sine / (at.cosine * x);
  }
  return 1.0 + x2 * (1.0 / 3.0) * (1.0 + x2 * 0.4 * (1.0 + x2 * (17.0 / 42.0)));
}

}  // namespace

Quat rotate_free_top(const Quat& attitude, const Vec3& angular_momentum, const Vec3& inertia, double dt) {
  const Quaternion<double> q{attitude.w(), triple(attitude.vec())};
  const Quaternion<double> turned =
      (q * free_top_turn(q.conjugate().rotate(triple(angular_momentum)), triple(inertia), dt)).normalized();
  return {turned.w, turned.v.x, turned.v.y, turned.v.z};
}

void kick(Bodies& bodies, double dt, std::size_t begin, std::size_t end) {
  for (std::size_t b = begin; b < end; ++b) {
    bodies.velocity[b] += (dt / bodies.mass[b]) * bodies.force[b];
    bodies.spin[b] += dt * bodies.torque[b];
  }
}

bool drift(Bodies& bodies, double dt, std::size_t begin, std::size_t end, std::span<Vec3> spin_mid) {
  const double reach =
      bodies.cell_edge > 0.0 ? kCellReach * bodies.cell_edge : std::numeric_limits<double>::infinity();
  bool left = false;
  std::size_t turning[kLanes], count = 0;
  Turns turns;
  for (std::size_t b = begin; b < end; ++b) {
    Vec3& x = bodies.position[b];
    add_exactly(x, bodies.remainder[b], dt * bodies.velocity[b]);
    left |= x.cwiseAbs().maxCoeff() > reach;
    if (is_ball(bodies, b)) {
      const Vec3 w = (1.0 / bodies.inertia[b].x()) * bodies.spin[b];
      const Vec3 mid = tangent_ratio(0.25 * dt * dt * w.squaredNorm()) * w;
      spin_mid[b - begin] = mid;
      turns.add(b, 0.5 * dt * mid);
    } else {
      turning[count++] = b;
    }
    if (count == kLanes || (count > 0 && b + 1 == end)) {
      std::fill(turning + count, turning + kLanes, turning[0]);
      turn_bodies(bodies, turning, dt, begin, spin_mid);
      count = 0;
    }
  }
  turn_balls(bodies, turns);
  return left;
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn {

namespace {
HWY_EXPORT(rotate_free_top);
HWY_EXPORT(kick);
HWY_EXPORT(drift);
}  // namespace

Quat rotate_free_top(const Quat& attitude, const Vec3& angular_momentum, const Vec3& inertia, double dt) {
  return HWY_DYNAMIC_DISPATCH(rotate_free_top)(attitude, angular_momentum, inertia, dt);
}

void kick(Bodies& bodies, double dt, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(kick)(bodies, dt, begin, end);
}

void kick(Bodies& bodies, double dt) {
  parallel_blocks(bodies.size(), kBodyBlock,
                  [&](std::size_t begin, std::size_t end) { kick(bodies, dt, begin, end); });
}

bool drift(Bodies& bodies, double dt, std::size_t begin, std::size_t end, std::span<Vec3> spin_mid) {
  return HWY_DYNAMIC_DISPATCH(drift)(bodies, dt, begin, end, spin_mid);
}

void drift(Bodies& bodies, double dt, std::vector<Vec3>& spin_mid) {
  spin_mid.resize(bodies.size());
  std::atomic<bool> left = false;
  parallel_blocks(bodies.size(), kBodyBlock, [&](std::size_t begin, std::size_t end) {
    if (drift(bodies, dt, begin, end, std::span(spin_mid).subspan(begin)))
      left.store(true, std::memory_order_relaxed);
  });
  if (left) settle_cells(bodies);
}

void deform(Bodies& bodies, const Vec3& stretch, std::size_t begin, std::size_t end) {
  for (std::size_t b = begin; b < end; ++b) {
    bodies.position[b] = bodies.position[b].cwiseProduct(stretch);
    bodies.velocity[b] = bodies.velocity[b].cwiseQuotient(stretch);
  }
}

}  // namespace cairn
#endif
