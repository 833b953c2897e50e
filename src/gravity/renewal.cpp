#include "gravity/renewal.h"

#include "core/parallel.h"
#include "gravity/conserve.h"

namespace cairn::gravity {

namespace {

Mat3 rotation(const Vec3& angle) {
  const double size = angle.norm();
  if (size == 0.0) return Mat3::Identity();
  return Eigen::AngleAxisd(size, angle / size).toRotationMatrix();
}

}  // namespace

void remove_net_wrench(std::span<const Vec3> group_positions, std::span<const double> group_masses,
                       std::span<Vec3> force, std::span<Vec3> torque) {
  // Below this, forces with so short a lever would be large; the groups' own rotation takes the torque
  // instead.
  constexpr double kSmallest = 1e-6;
  const std::size_t n = group_positions.size();
  const MassCentre all = mass_centre(group_positions, group_masses);
  if (all.mass <= 0.0) return;
  const Mat3 moments = inertia(group_positions, group_masses, all.centre);
  for (int pass = 0; pass < 2; ++pass) {
    const Vec3 mean = parallel_sum(n, Vec3(Vec3::Zero()), [&](std::size_t g) { return force[g]; }) / all.mass;
    const Vec3 net = parallel_sum(n, Vec3(Vec3::Zero()), [&](std::size_t g) -> Vec3 {
      return torque[g] + (group_positions[g] - all.centre).cross(force[g] - group_masses[g] * mean);
    });
    const Turn t = turn(moments, net, kSmallest);
    parallel_for(n, [&](std::size_t g) {
      force[g] -= group_masses[g] * (mean + t.acceleration.cross(group_positions[g] - all.centre));
      torque[g] -= group_masses[g] / all.mass * t.rest;
    });
  }
}

void renew(HeldGravity& held, std::span<const Vec3> group_positions, std::span<const double> group_masses,
           std::span<const Vec3> force, std::span<const Vec3> torque, double time, const Vec3& omega) {
  held.force.assign(force.begin(), force.end());
  held.torque.assign(torque.begin(), torque.end());
  held.time = time;
  held.omega = omega;
  remove_net_wrench(group_positions, group_masses, held.force, held.torque);
}

void extrapolate(const HeldGravity& held, double time, std::span<const Vec3> group_positions,
                 std::span<const double> group_masses, std::span<Vec3> force, std::span<Vec3> torque) {
  if (time == held.time) {
    std::copy(held.force.begin(), held.force.end(), force.begin());
    std::copy(held.torque.begin(), held.torque.end(), torque.begin());
    return;
  }
  const Mat3 turned = rotation(held.omega * (time - held.time));
  parallel_for(force.size(), [&](std::size_t g) {
    force[g] = turned * held.force[g];
    torque[g] = turned * held.torque[g];
  });
  remove_net_wrench(group_positions, group_masses, force, torque);
}

}  // namespace cairn::gravity
