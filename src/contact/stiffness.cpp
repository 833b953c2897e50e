#include "contact/stiffness.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "contact/law/pair.h"

namespace cairn {

namespace {

constexpr double kPacking = 0.6;     // bulk over particle density of a random pile
constexpr double kForceChain = 8.0;  // strongest chain over mean load

double solid_volume(const Bodies& bodies) {
  double volume = 0.0;
  for (double r : bodies.spheres.radius) volume += 4.0 / 3.0 * kPi * r * r * r;
  return volume;
}

double largest_eigenvalue(const Mat3& m) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(m, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

/// M times the greatest point mobility a contact on the body can meet, along the normal and in the plane.
struct Mobility {
  double normal = 1.0, tangential = 1.0;
};

Mobility greatest_mobility(const Bodies& bodies, std::size_t b) {
  constexpr int directions = 500;
  const Mat3 inverse = (bodies.mass[b] * bodies.inertia[b].cwiseInverse()).asDiagonal();
  const auto rotational = [&](const Vec3& arm) -> Mat3 {
    Mat3 skew;
    skew << 0.0, -arm.z(), arm.y(), arm.z(), 0.0, -arm.x(), -arm.y(), arm.x(), 0.0;
    return skew * inverse * skew.transpose();
  };
  Mobility out;
  for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
    const Vec3& arm = bodies.spheres.offset[s];
    out.normal = std::max(out.normal, 1.0 + largest_eigenvalue(rotational(arm)));
    for (int k = 0; k < directions; ++k) {  // normals on a Fibonacci spiral
      const double z = 1.0 - (2 * k + 1.0) / directions, angle = kPi * (3.0 - std::sqrt(5.0)) * k;
      const double rho = std::sqrt(1.0 - z * z);
      const Vec3 n(rho * std::cos(angle), rho * std::sin(angle), z);
      const Mat3 plane = Mat3::Identity() - n * n.transpose();
      const Mat3 in_plane = plane * rotational(arm + bodies.spheres.radius[s] * n) * plane;
      out.tangential = std::max(out.tangential, 1.0 + largest_eigenvalue(in_plane));
    }
  }
  return out;
}

}  // namespace

double escape_speed(const Bodies& bodies) {
  double mass = 0.0;
  for (double m : bodies.mass) mass += m;
  const double radius = std::cbrt(3.0 * solid_volume(bodies) / (4.0 * kPi * kPacking));
  return std::sqrt(2.0 * kGravitationalConstant * mass / radius);
}

double choose_stiffness(const Bodies& bodies, const ContactDemand& demand) {
  const auto& radii = bodies.spheres.radius;
  const double overlap = demand.max_overlap * *std::min_element(radii.begin(), radii.end());
  const double largest_radius = *std::max_element(radii.begin(), radii.end());
  const double largest_mass = *std::max_element(bodies.mass.begin(), bodies.mass.end());
  double mass = 0.0;
  for (double m : bodies.mass) mass += m;

  double force = demand.cohesion * std::pow(demand.shape_factor * largest_radius, 2);
  if (demand.self_gravity) {
    const double volume = solid_volume(bodies);
    const double density = kPacking * mass / volume;
    const double pile_radius = std::cbrt(3.0 * volume / (4.0 * kPi * kPacking));
    const double pressure =
        2.0 / 3.0 * kPi * kGravitationalConstant * density * density * pile_radius * pile_radius;
    double body_area = 0.0;  // of the sphere with the volume of the heaviest body's spheres
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      double cube = 0.0;
      for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
        cube += std::pow(radii[s], 3);
      body_area = std::max(body_area, kPi * std::pow(cube, 2.0 / 3.0));
    }
    force += kForceChain * pressure * body_area;
  }
  // Under a uniform field a column as high as the cube root of the number of bodies rests on one contact.
  force += kForceChain * demand.field * largest_mass * std::cbrt(static_cast<double>(bodies.size()));
  const double impact = largest_mass * std::pow(demand.impact_speed / overlap, 2);
  return std::max(impact, force / overlap);
}

double shortest_contact_time(const Bodies& bodies, double k_n, double shape_factor, bool rolling,
                             bool walls) {
  const auto& radii = bodies.spheres.radius;
  std::map<std::uint32_t, Mobility> mobility;  // M times the mobility does not depend on size or density
  double normal = 0.0, tangential = 0.0, roll = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    auto [it, fresh] = mobility.try_emplace(bodies.shape[b]);
    if (fresh) it->second = greatest_mobility(bodies, b);
    normal = std::max(normal, it->second.normal / bodies.mass[b]);
    tangential = std::max(tangential, it->second.tangential / bodies.mass[b]);
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
      roll = std::max(roll, radii[s] * radii[s] / bodies.inertia[b][0]);
  }
  // Squared frequencies of two equal worst bodies.
  double fastest = std::max(2.0 * k_n * normal, 2.0 * kTangentialRatio * k_n * tangential);
  if (rolling) {
    const auto [least, most] = std::minmax_element(radii.begin(), radii.end());
    const double ratio = walls ? 0.0 : *least / *most;  // of the partners' radii: R = r / (1 + ratio)
    const double patch =
        shape_factor * shape_factor * roll * (1.0 + ratio * ratio) / ((1.0 + ratio) * (1.0 + ratio));
    fastest = std::max(fastest, std::max(1.0, 2.0 * kTangentialRatio) * k_n * patch);
  }
  return kPi / std::sqrt(fastest);
}

}  // namespace cairn
