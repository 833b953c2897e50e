#include "gravity/conserve.h"

#include <Eigen/Eigenvalues>

#include "core/parallel.h"

namespace cairn::gravity {

void sum_groups(std::span<const Vec3> positions, std::span<const double> masses,
                std::span<const std::uint32_t> first, std::span<const Vec3> acceleration,
                std::span<const Vec3> centres, Wrenches& out) {
  const bool points = centres.size() == positions.size();
  out.force.resize(centres.size());
  out.torque.resize(points ? 0 : centres.size());
  parallel_for(centres.size(), [&](std::size_t g) {
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t i = first[g]; i < first[g + 1]; ++i) {
      const Vec3 f = masses[i] * acceleration[i];
      force += f;
      torque += (positions[i] - centres[g]).cross(f);
    }
    out.force[g] = force;
    if (!points) out.torque[g] = torque;
  });
}

Turn turn(const Mat3& inertia, const Vec3& torque, double smallest) {
  Turn result{Vec3::Zero(), torque};
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia);
  for (int k = 0; k < 3; ++k) {
    const double moment = axes.eigenvalues()[k];
    if (moment <= 0.0 || moment <= smallest * axes.eigenvalues()[2]) continue;
    const Vec3 axis = axes.eigenvectors().col(k);
    result.rotation += axis.dot(torque) / moment * axis;
    result.rest -= axis.dot(torque) * axis;
  }
  return result;
}

NetWrench& NetWrench::operator+=(const NetWrench& other) {
  force += other.force;
  torque += other.torque;
  mass += other.mass;
  weight += other.weight;
  first += other.first;
  second += other.second;
  return *this;
}

Balance balance(const NetWrench& net, const Vec3& origin) {
  // Below this, forces with so short a lever would be large; the groups' own rotation takes the torque.
  constexpr double kSmallest = 1e-6;
  const bool felt = net.weight > 0.0;
  const Vec3 centre = felt ? Vec3(net.first / net.weight) : Vec3(Vec3::Zero());
  const Mat3 second = net.second - net.weight * centre * centre.transpose();
  const Turn t =
      turn(second.trace() * Mat3::Identity() - second, centre.cross(net.force) - net.torque, kSmallest);
  Balance out{.origin = origin, .rotation = t.rotation, .torque = t.rest / net.mass};
  if (felt) out.shift = -net.force / net.weight - t.rotation.cross(centre);
  return out;
}

}  // namespace cairn::gravity
