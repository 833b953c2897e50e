#include "gravity/conserve.h"

#include <Eigen/Eigenvalues>

#include "core/parallel.h"

namespace cairn::gravity {

MassCentre mass_centre(std::span<const Vec3> positions, std::span<const double> masses) {
  const std::size_t n = positions.size();
  if (n == 0) return {0.0, Vec3::Zero()};
  const double mass = parallel_sum(n, 0.0, [&](std::size_t i) { return masses[i]; });
  // About one of the points, so that a pile far from the origin keeps its digits.
  const Vec3 origin = positions[0];
  const Vec3 moment = parallel_sum(n, Vec3(Vec3::Zero()), [&](std::size_t i) -> Vec3 {
    return (mass > 0.0 ? masses[i] : 1.0) * (positions[i] - origin);
  });
  return {mass, origin + moment / (mass > 0.0 ? mass : static_cast<double>(n))};
}

Turn turn(const Mat3& inertia, const Vec3& torque, double smallest) {
  Turn result{Vec3::Zero(), torque};
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(inertia);
  for (int k = 0; k < 3; ++k) {
    const double moment = axes.eigenvalues()[k];
    if (moment <= 0.0 || moment <= smallest * axes.eigenvalues()[2]) continue;
    const Vec3 axis = axes.eigenvectors().col(k);
    result.acceleration += axis.dot(torque) / moment * axis;
    result.rest -= axis.dot(torque) * axis;
  }
  return result;
}

Mat3 inertia(std::span<const Vec3> positions, std::span<const double> masses, const Vec3& centre) {
  return parallel_sum(positions.size(), Mat3(Mat3::Zero()), [&](std::size_t i) -> Mat3 {
    const Vec3 d = positions[i] - centre;
    return masses[i] * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
  });
}

void remove_net(std::span<const Vec3> positions, std::span<const double> masses,
                std::span<Vec3> acceleration) {
  constexpr double kSmallest = 1e-12;  // what rounding makes of the moment of collinear points
  const std::size_t n = positions.size();
  const MassCentre all = mass_centre(positions, masses);
  if (all.mass <= 0.0) return;
  const Mat3 moments = inertia(positions, masses, all.centre);
  // The second time takes away what rounding left of a large net force or torque.
  for (int pass = 0; pass < 2; ++pass) {
    const Vec3 mean = parallel_sum(n, Vec3(Vec3::Zero()),
                                   [&](std::size_t i) -> Vec3 { return masses[i] * acceleration[i]; }) /
                      all.mass;
    const Vec3 torque = parallel_sum(n, Vec3(Vec3::Zero()), [&](std::size_t i) -> Vec3 {
      return masses[i] * (positions[i] - all.centre).cross(acceleration[i] - mean);
    });
    const Vec3 alpha = turn(moments, torque, kSmallest).acceleration;
    parallel_for(n, [&](std::size_t i) { acceleration[i] -= mean + alpha.cross(positions[i] - all.centre); });
  }
}

void sum_groups(std::span<const Vec3> positions, std::span<const double> masses,
                std::span<const std::uint32_t> first, std::span<const Vec3> acceleration,
                std::span<const Vec3> centres, std::span<Vec3> force, std::span<Vec3> torque) {
  parallel_for(centres.size(), [&](std::size_t g) {
    force[g].setZero();
    torque[g].setZero();
    for (std::size_t i = first[g]; i < first[g + 1]; ++i) {
      const Vec3 f = masses[i] * acceleration[i];
      force[g] += f;
      torque[g] += (positions[i] - centres[g]).cross(f);
    }
  });
}

}  // namespace cairn::gravity
