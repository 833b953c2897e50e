#include "motion/drift.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "body/cells.h"
#include "core/parallel.h"
#include "core/vector.h"

namespace cairn {

namespace {

template <class T>
struct SineCosine {
  T sine, cosine;
};

/// Where the series of `sine_cosine` does not reach.
void set_exactly(double x, bool large, SineCosine<double>& out) {
  if (large) out = {std::sin(x), std::cos(x)};
}
void set_exactly(Batch x, Mask large, SineCosine<Batch>& out) {
  for (std::size_t l = 0; l < kLanes; ++l)
    if (large.v[l]) {
      out.sine.v[l] = std::sin(x[l]);
      out.cosine.v[l] = std::cos(x[l]);
    }
}

/// The angles of a step are small, where the series is exact to round-off and far cheaper.
template <class T>
CAIRN_INLINE SineCosine<T> sine_cosine(T x) {
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
  SineCosine<T> out{x * s, fma(T(-0.5) * x2, c, one)};
  const auto large = x2 > T(0.04);
  if (any(large)) set_exactly(x, large, out);
  return out;
}

/// Quat, one or eight at a time.
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
  alignas(64) double half[kBodyBlock + 1][4];

  void add(std::size_t b, const Vec3& turn) {
    ball[count] = b;
    Eigen::Map<Vec3>{half[count]} = turn;
    half[count++][3] = 0.0;
  }
};

/// Two balls turn at once, quaternion by quaternion, exactly.
void turn_balls(Bodies& bodies, Turns& turns) {
  using V = Batch::Vector;
  using I = Mask::Vector;
  constexpr I x{0, 0, 0, 0, 4, 4, 4, 4}, y{1, 1, 1, 1, 5, 5, 5, 5}, z{2, 2, 2, 2, 6, 6, 6, 6};
  constexpr I with_x{3, 2, 1, 0, 7, 6, 5, 4}, with_y{2, 3, 0, 1, 6, 7, 4, 5}, with_z{1, 0, 3, 2, 5, 4, 7, 6};
  constexpr V sign_x{1, -1, 1, -1, 1, -1, 1, -1}, sign_y{1, 1, -1, -1, 1, 1, -1, -1},
      sign_z{-1, 1, 1, -1, -1, 1, 1, -1};
  std::fill(turns.half[turns.count], turns.half[turns.count] + 4, 0.0);
  for (std::size_t k = 0; k < turns.count; k += 2) {
    double* first = bodies.orientation[turns.ball[k]].coeffs().data();
    double* second = k + 1 < turns.count ? bodies.orientation[turns.ball[k + 1]].coeffs().data() : first;
    V q = simd_detail::load(first, second), h;
    __builtin_memcpy(&h, turns.half[k], sizeof h);
    // (1, h) q
    q = fma(Batch(sign_x * __builtin_shuffle(h, x)), __builtin_shuffle(q, with_x),
            fma(Batch(sign_y * __builtin_shuffle(h, y)), __builtin_shuffle(q, with_y),
                fma(Batch(sign_z * __builtin_shuffle(h, z)), __builtin_shuffle(q, with_z), Batch(q))))
            .v;
    const V pairs = q * q + __builtin_shuffle(q * q, with_z);
    const Batch length2 = pairs + __builtin_shuffle(pairs, with_y);
    // 1 / length; the series is exact to round-off below the limit.
    const Batch e = length2 - Batch(1.0), limit(1e-4);
    Batch scale = fma(e, fma(e, fma(e, Batch(-0.3125), Batch(0.375)), Batch(-0.5)), Batch(1.0));
    if (any(abs(e) > limit)) scale = select(abs(e) > limit, rsqrt(length2), scale);
    q = q * scale.v;
    simd_detail::Half low = __builtin_shufflevector(q, q, 0, 1, 2, 3),
                      high = __builtin_shufflevector(q, q, 4, 5, 6, 7);
    if (second != first) __builtin_memcpy(second, &high, sizeof high);
    __builtin_memcpy(first, &low, sizeof low);
  }
}

/// Eight bodies turn over dt; spare places repeat a body.
void turn_bodies(Bodies& bodies, const std::size_t (&index)[kLanes], double dt, std::size_t begin,
                 std::span<Vec3> spin_mid) {
  double* rows[kLanes];
  Triple<Batch> momentum, inertia;
  for (std::size_t l = 0; l < kLanes; ++l) {
    rows[l] = bodies.orientation[index[l]].coeffs().data();
    const Vec3 &spin = bodies.spin[index[l]], &moments = bodies.inertia[index[l]];
    momentum.x.v[l] = spin.x();
    momentum.y.v[l] = spin.y();
    momentum.z.v[l] = spin.z();
    inertia.x.v[l] = moments.x();
    inertia.y.v[l] = moments.y();
    inertia.z.v[l] = moments.z();
  }
  Batch q[4];
  load_transposed({rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7]}, q);
  const Quaternion<Batch> attitude{q[3], {q[0], q[1], q[2]}};
  const Batch step(dt);
  const Quaternion<Batch> turn = free_top_turn(attitude.conjugate().rotate(momentum), inertia, step);
  const Triple<Batch> w = attitude.rotate(Batch(2.0) / (step * turn.w) * turn.v);
  const Quaternion<Batch> turned = (attitude * turn).normalized();
  store_transposed({turned.v.x, turned.v.y, turned.v.z, turned.w}, rows);
  for (std::size_t l = 0; l < kLanes; ++l) spin_mid[index[l] - begin] = {w.x[l], w.y[l], w.z[l]};
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
  if (x2 > 1e-4) return std::tan(std::sqrt(x2)) / std::sqrt(x2);
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

void kick(Bodies& bodies, double dt) {
  parallel_blocks(bodies.size(), kBodyBlock,
                  [&](std::size_t begin, std::size_t end) { kick(bodies, dt, begin, end); });
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
