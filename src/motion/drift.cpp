#include "motion/drift.h"

#include <atomic>
#include <cmath>
#include <limits>

#include "body/cells.h"
#include "core/parallel.h"

namespace cairn {

namespace {

struct SineCosine {
  double sine, cosine;
};

/// sin and cos; the angles of a step are small, where the series is exact to round-off and far cheaper.
SineCosine sine_cosine(double x) {
  const double x2 = x * x;
  if (x2 > 0.04) return {std::sin(x), std::cos(x)};
  const double sine =
      x * (1.0 - x2 / 6 * (1.0 - x2 / 20 * (1.0 - x2 / 42 * (1.0 - x2 / 72 * (1.0 - x2 / 110)))));
  const double cosine =
      1.0 - x2 / 2 * (1.0 - x2 / 12 * (1.0 - x2 / 30 * (1.0 - x2 / 56 * (1.0 - x2 / 90 * (1.0 - x2 / 132)))));
  return {sine, cosine};
}

/// Free flow of H = p_k^2 / (2 I_k) over dt: body-frame momentum p turns by -angle about axis k, the attitude
/// by +angle.
template <int k>
void turn(Quat& q, Vec3& p, double inertia, double dt) {
  constexpr int a = (k + 1) % 3, b = (k + 2) % 3;
  const SineCosine half = sine_cosine(0.5 * dt * p[k] / inertia);
  const double sine = 2.0 * half.sine * half.cosine, cosine = 1.0 - 2.0 * half.sine * half.sine;
  const double pa = p[a], pb = p[b];
  p[a] = cosine * pa + sine * pb;
  p[b] = cosine * pb - sine * pa;
  Vec3 axis = Vec3::Zero();
  axis[k] = half.sine;
  q = q * Quat(half.cosine, axis.x(), axis.y(), axis.z());
}

/// Rotation over dt, in the body frame before it, of a free top with momentum p in that frame.
Quat free_top_turn(Vec3 p, const Vec3& inertia, double dt) {
  Quat q = Quat::Identity();
  turn<0>(q, p, inertia[0], 0.5 * dt);
  turn<1>(q, p, inertia[1], 0.5 * dt);
  turn<2>(q, p, inertia[2], dt);
  turn<1>(q, p, inertia[1], 0.5 * dt);
  turn<0>(q, p, inertia[0], 0.5 * dt);
  return q;
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
  return 1.0 + x2 / 3.0 * (1.0 + x2 * 0.4 * (1.0 + x2 * 17.0 / 42.0));
}

}  // namespace

Quat rotate_free_top(const Quat& attitude, const Vec3& angular_momentum, const Vec3& inertia, double dt) {
  return (attitude * free_top_turn(attitude.conjugate() * angular_momentum, inertia, dt)).normalized();
}

void kick(Bodies& bodies, double dt) {
  parallel_for(bodies.size(), [&](std::size_t b) {
    bodies.velocity[b] += (dt / bodies.mass[b]) * bodies.force[b];
    bodies.spin[b] += dt * bodies.torque[b];
  });
}

void drift(Bodies& bodies, double dt, std::vector<Vec3>& spin_mid) {
  spin_mid.resize(bodies.size());
  const double reach =
      bodies.cell_edge > 0.0 ? kCellReach * bodies.cell_edge : std::numeric_limits<double>::infinity();
  std::atomic<bool> left = false;
  parallel_for(bodies.size(), [&](std::size_t b) {
    Vec3& x = bodies.position[b];
    add_exactly(x, bodies.remainder[b], dt * bodies.velocity[b]);
    if (x.cwiseAbs().maxCoeff() > reach) left.store(true, std::memory_order_relaxed);
    if (bodies.sphere_count(b) == 1) {  // the attitude of a loose sphere moves nothing
      const Vec3 w = (1.0 / bodies.inertia[b].x()) * bodies.spin[b];
      spin_mid[b] = tangent_ratio(0.25 * dt * dt * w.squaredNorm()) * w;
      return;
    }
    Quat& attitude = bodies.orientation[b];
    const Quat turn = free_top_turn(attitude.conjugate() * bodies.spin[b], bodies.inertia[b], dt);
    spin_mid[b] = attitude * (2.0 / (dt * turn.w()) * turn.vec());
    attitude = (attitude * turn).normalized();
  });
  if (left) settle_cells(bodies);
}

void deform(Bodies& bodies, const Vec3& stretch) {
  parallel_for(bodies.size(), [&](std::size_t b) {
    bodies.position[b] = bodies.position[b].cwiseProduct(stretch);
    bodies.velocity[b] = bodies.velocity[b].cwiseQuotient(stretch);
  });
}

}  // namespace cairn
