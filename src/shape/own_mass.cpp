#include "shape/own_mass.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace cairn {

MassSpread spread_of_spheres(const Shape& shape) {
  const std::vector<double>& masses = shape.own.of_spheres;
  const double total = std::accumulate(masses.begin(), masses.end(), 0.0);
  MassSpread spread{Vec3::Zero(), Mat3::Zero()};
  for (std::size_t i = 0; i < masses.size(); ++i) spread.center += masses[i] / total * shape.centers[i];
  for (std::size_t i = 0; i < masses.size(); ++i)
    spread.inertia += masses[i] / total * ball_inertia(shape.centers[i] - spread.center, shape.radii[i]);
  return spread;
}

namespace {

/// Mean of the centres by the volumes of the spheres.
Vec3 center_by_volume(const Shape& shape) {
  double volume = 0.0;
  Vec3 center = Vec3::Zero();
  for (std::size_t i = 0; i < shape.radii.size(); ++i) {
    const double r = shape.radii[i];
    volume += r * r * r;
    center += r * r * r * shape.centers[i];
  }
  return center / volume;
}

std::optional<MassComplaint> check_inertia(const Mat3& inertia) {
  constexpr double thinnest = 1e-9;
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(moments[0] >= thinnest * moments[2] && moments[2] > 0.0))
    return MassComplaint{
        "inertia", fmt::format("expected principal moments above 0, none below {:g} of the greatest, found "
                               "{:.9g}, {:.9g}, {:.9g}",
                               thinnest, moments[0], moments[1], moments[2])};
  if (moments[2] > moments[0] + moments[1] + kLaminaRounding * moments[2])
    return MassComplaint{
        "inertia", fmt::format("expected no principal moment above the sum of the two others (a lamina's is "
                               "that sum), found {:.9g}, {:.9g}, {:.9g}",
                               moments[0], moments[1], moments[2])};
  return {};
}

}  // namespace

std::optional<MassComplaint> check_own_mass(const Shape& shape) {
  const OwnMass& own = shape.own;
  const auto positive = [](double mass) { return mass > 0.0 && std::isfinite(mass); };
  if (!own.of_spheres.empty() && (own.of_spheres.size() != shape.radii.size() ||
                                  !std::all_of(own.of_spheres.begin(), own.of_spheres.end(), positive)))
    return MassComplaint{"mass", "expected a mass above 0 of every sphere, or of none"};
  if (own.center && own.of_spheres.empty() && !own.inertia)
    return MassComplaint{"center_of_mass", "expected an inertia about it, or masses of the spheres"};
  if (own.center && !own.of_spheres.empty()) {
    const Vec3 center = spread_of_spheres(shape).center;
    double reach = 0.0;
    for (const Vec3& c : shape.centers) reach = std::max(reach, (c - center).norm());
    constexpr double rounding = 1e-6;
    if ((*own.center - center).norm() > rounding * reach)
      return MassComplaint{"center_of_mass",
                           fmt::format("expected that of the spheres' masses, [{:.9g}, {:.9g}, {:.9g}]",
                                       center.x(), center.y(), center.z())};
  }
  if (!own.inertia) return {};
  if (const auto complaint = check_inertia(*own.inertia)) return complaint;
  const Vec3 center =
      own.center.value_or(own.of_spheres.empty() ? center_by_volume(shape) : spread_of_spheres(shape).center);
  double reach = 0.0;
  for (std::size_t i = 0; i < shape.radii.size(); ++i)
    reach = std::max(reach, (shape.centers[i] - center).norm() + shape.radii[i]);
  const double gyration = std::sqrt(0.5 * own.inertia->trace());
  if (gyration > 2.0 * reach)
    return MassComplaint{"inertia",
                         fmt::format("expected a radius of gyration within the body, whose spheres reach "
                                     "{:.4g} from its mass centre, found {:.4g}",
                                     reach, gyration)};
  return {};
}

}  // namespace cairn
