#include "contact/kinematics.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/kinematics.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>

#include "core/parallel.h"
#include "core/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {
namespace {

/// Motions of many spheres are out of the caches before they are read: they are written past them.
void write(const SphereMotion& from, bool many, SphereMotion& to) {
  if (!many) {
    to = from;
    return;
  }
  for (std::size_t k = 0; k < sizeof(SphereMotion) / sizeof(double); k += kLanes)
    hn::Stream(Batch::load(from.position + k).v, Tag(), to.position + k);
}

}  // namespace

void compute_motions(const Bodies& bodies, std::span<const Vec3> spin_mid, double dt, const Vec3& rate,
                     std::size_t first, std::size_t last, std::vector<SphereMotion>& motions) {
  const Spheres& spheres = bodies.spheres;
  const double half = 0.5 * dt;
  const bool flows = rate != Vec3::Zero(), many = motions.size() > kManySpheres;
  SphereMotion m;
  for (std::size_t b = first; b < last; ++b) {
    Vec3 velocity_mid = bodies.velocity[b];
    if (flows) velocity_mid += rate.cwiseProduct(bodies.position[b]);
    const Vec3 velocity_end = velocity_mid + (half / bodies.mass[b]) * bodies.force[b];
    const Vec3 momentum_end = bodies.spin[b] + half * bodies.torque[b];
    const std::uint32_t begin = bodies.first_sphere[b], end = bodies.first_sphere[b + 1];
    if (is_ball(bodies, b)) {  // no arm
      Eigen::Map<Vec3>(m.position) = spheres.position[begin];
      m.radius = spheres.radius[begin];
      Eigen::Map<Vec3>(m.velocity_mid) = velocity_mid;
      Eigen::Map<Vec3>(m.spin_mid) = spin_mid[b - first];
      Eigen::Map<Vec3>(m.velocity) = velocity_end;
      Eigen::Map<Vec3>(m.spin) = (1.0 / bodies.inertia[b].x()) * momentum_end;
      write(m, many, motions[begin]);
      continue;
    }
    const Quat& q = bodies.orientation[b];
    const Vec3 w_end = q * (q.conjugate() * momentum_end).cwiseQuotient(bodies.inertia[b]);
    const Vec3& w_mid = spin_mid[b - first];
    const Vec3 turn = half * w_mid;
    const double share = 1.0 / (1.0 + turn.squaredNorm());
    for (std::uint32_t s = begin; s < end; ++s) {
      const Vec3 arm = spheres.position[s] - bodies.position[b];
      // The mean of the arms before and after the drift: arm = arm_mid + turn x arm_mid.
      const Vec3 arm_mid = share * (arm - turn.cross(arm) + turn.dot(arm) * turn);
      Eigen::Map<Vec3>(m.position) = spheres.position[s];
      m.radius = spheres.radius[s];
      Eigen::Map<Vec3>(m.velocity_mid) = velocity_mid + w_mid.cross(arm_mid);
      Eigen::Map<Vec3>(m.spin_mid) = w_mid;
      Eigen::Map<Vec3>(m.velocity) = velocity_end + w_end.cross(arm);
      Eigen::Map<Vec3>(m.spin) = w_end;
      write(m, many, motions[s]);
    }
  }
  if (many) hwy::FlushStream();  // before other threads read them
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn {

HWY_EXPORT(compute_motions);

void compute_motions(const Bodies& bodies, std::span<const Vec3> spin_mid, double dt, const Vec3& rate,
                     std::size_t begin, std::size_t end, std::vector<SphereMotion>& motions) {
  HWY_DYNAMIC_DISPATCH(compute_motions)(bodies, spin_mid, dt, rate, begin, end, motions);
}

void compute_motions(const Bodies& bodies, std::span<const Vec3> spin_mid, double dt,
                     std::vector<SphereMotion>& motions, const Vec3& rate) {
  motions.resize(bodies.spheres.size());
  parallel_blocks(bodies.size(), kBodyBlock, [&](std::size_t begin, std::size_t end) {
    compute_motions(bodies, spin_mid.subspan(begin), dt, rate, begin, end, motions);
  });
}

void move_motions(const Spheres& spheres, std::vector<SphereMotion>& motions) {
  parallel_for(spheres.size(),
               [&](std::size_t s) { Eigen::Map<Vec3>(motions[s].position) = spheres.position[s]; });
}

}  // namespace cairn
#endif
