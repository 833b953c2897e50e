#include "contact/stiffness.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "contact/law/pair.h"
#include "core/elementary.h"

namespace cairn {

namespace {

constexpr double kPacking = 0.6;     // bulk over particle density of a random pile
constexpr double kForceChain = 8.0;  // strongest chain over mean load

/// Sum of the cubed radii (m^3) of the spheres of body b.
double cubed_radii(const Bodies& bodies, std::size_t b) {
  double cube = 0.0;
  for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
    cube += cubed(bodies.spheres.radius[s]);
  return cube;
}

double cubed_radii(const Bodies& bodies) {
  double cube = 0.0;
  for (double r : bodies.spheres.radius) cube += cubed(r);
  return cube;
}

double total_mass(const Bodies& bodies) {
  return std::accumulate(bodies.mass.begin(), bodies.mass.end(), 0.0);
}

/// Mass (kg) that gives way in a contact; a held body gives way to none.
double yielding_mass(const Bodies& bodies, std::size_t b) {
  return is_held(bodies, b) ? std::numeric_limits<double>::infinity() : bodies.mass[b];
}

double largest_radius(const Bodies& bodies, std::size_t b) {
  const auto* radii = bodies.spheres.radius.data();
  return *std::max_element(radii + bodies.first_sphere[b], radii + bodies.first_sphere[b + 1]);
}

/// The bodies with the greatest and the next greatest value; the same one where there is no other.
class Greatest {
 public:
  /// Takes the bodies' values one after the other.
  void add(std::uint32_t body, double value) {
    if (value > first_) {
      next_ = first_;
      next_body_ = body_;
      first_ = value;
      body_ = body;
    } else if (value > next_) {
      next_ = value;
      next_body_ = body;
    }
  }
  double first() const { return first_; }
  double next() const { return next_body_ ? next_ : first_; }
  std::uint32_t body() const { return *body_; }
  /// Where it is among those that body b can meet.
  std::uint32_t other_than(std::uint32_t b) const {
    return !body_ || b == *body_ ? next_body_.value_or(b) : *body_;
  }
  Encounter of_both() const { return {*body_, next_body_.value_or(*body_)}; }

 private:
  double first_ = -1.0, next_ = -1.0;
  std::optional<std::uint32_t> body_, next_body_;
};

/// Calls visit(sphere, its body, the other or none for a wall) for each sphere and those that can load it
/// most among the bodies that it can meet: one that is the greatest in something. Where it is the larger
/// sphere of the pair, the pair has its turn at the smaller one.
template <class Visit>
void for_worst_pairs(const Bodies& bodies, bool walls, Visit&& visit) {
  Greatest mass, free, size, radius;
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    mass.add(b, yielding_mass(bodies, b));
    if (!is_held(bodies, b)) free.add(b, bodies.mass[b]);
    size.add(b, cubed_radii(bodies, b));
    radius.add(b, largest_radius(bodies, b));
  }
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    const std::uint32_t heaviest = is_held(bodies, b) ? free.body() : mass.other_than(b),
                        largest = size.other_than(b), roundest = radius.other_than(b);
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      if (walls) visit(s, b, std::optional<std::uint32_t>());
      if (walls && bodies.size() == 1) continue;
      visit(s, b, std::optional(heaviest));
      if (largest != heaviest) visit(s, b, std::optional(largest));
      if (roundest != heaviest && roundest != largest) visit(s, b, std::optional(roundest));
    }
  }
}

/// Pull of cohesion (N) between sphere s and the largest one of what its body meets.
double pull(const Bodies& bodies, const ContactDemand& demand, std::uint32_t s,
            const std::optional<std::uint32_t>& other) {
  const double r = bodies.spheres.radius[s];
  if (!other) return demand.wall_cohesion * r * r;
  const double partner = largest_radius(bodies, *other), radius = r * partner / (r + partner);
  return demand.cohesion * radius * radius;
}

/// The smaller radius (m) of sphere s and the largest one of what its body meets.
double smaller_radius(const Bodies& bodies, std::uint32_t s, const std::optional<std::uint32_t>& other) {
  const double r = bodies.spheres.radius[s];
  return other ? std::min(r, largest_radius(bodies, *other)) : r;
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
      const Vec3 n(rho * sine_and_cosine(angle).cosine, rho * sine_and_cosine(angle).sine, z);
      const Mat3 plane = Mat3::Identity() - n * n.transpose();
      const Mat3 in_plane = plane * rotational(arm + bodies.spheres.radius[s] * n) * plane;
      out.tangential = std::max(out.tangential, 1.0 + largest_eigenvalue(in_plane));
    }
  }
  return out;
}

}  // namespace

double escape_speed(const Bodies& bodies) {
  double steepest = total_mass(bodies) / cube_root(cubed_radii(bodies) / kPacking);  // kg/m
  for (std::size_t b = 0; b < bodies.size(); ++b)
    steepest = std::max(steepest, bodies.mass[b] / cube_root(cubed_radii(bodies, b)));
  return std::sqrt(2.0 * kGravitationalConstant * steepest);
}

double load_of_a_contact(const Bodies& bodies, double load) {
  return load * std::min(1.0, kForceChain / squared(cube_root(static_cast<double>(bodies.size()))));
}

StiffnessChoice choose_stiffness(const Bodies& bodies, const ContactDemand& demand) {
  const double mass = total_mass(bodies), cubes = cubed_radii(bodies);
  double load = 0.0;  // N/m^2, over the squared radius of the sphere with the volume of a body's spheres
  if (demand.self_gravity) {
    const double density = kPacking * mass / (4.0 / 3.0 * kPi * cubes);
    const double pile_radius = cube_root(cubes / kPacking);
    load += kForceChain * kPi * 2.0 / 3.0 * kPi * kGravitationalConstant * density * density * pile_radius *
            pile_radius;
  }
  if (demand.field > 0.0) {
    // At the foot of a column as high as the cube root of the number of equal bodies, or of a heavier body.
    double weighing = 0.0, size = 0.0, heaviest = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (is_held(bodies, b)) continue;
      const double cube = cubed_radii(bodies, b);
      weighing += bodies.mass[b];
      size += cube;
      heaviest = std::max(heaviest, bodies.mass[b] / squared(cube_root(cube)));
    }
    load += kForceChain * demand.field * std::max(heaviest, weighing / squared(cube_root(size)));
  }
  if (demand.wall_load > 0.0)
    load += load_of_a_contact(bodies, demand.wall_load) /
            squared(cube_root(cubes / static_cast<double>(bodies.size())));
  StiffnessChoice choice;
  for_worst_pairs(bodies, demand.walls, [&](std::uint32_t s, std::uint32_t b, const auto& other) {
    const double overlap = demand.max_overlap * bodies.spheres.radius[s];
    const double own = yielding_mass(bodies, b);
    const double lighter = other ? std::min(own, yielding_mass(bodies, *other)) : own;
    if (std::isinf(lighter)) return;  // held bodies do not meet
    const double impact = lighter * squared(demand.impact_speed / overlap);
    double cube = cubed_radii(bodies, b);
    if (other) cube = std::min(cube, cubed_radii(bodies, *other));
    const double force = pull(bodies, demand, s, other) + load * squared(cube_root(cube));
    const double aim = demand.max_overlap * smaller_radius(bodies, s, other), rest = force / aim;
    double fall = 0.0;  // a light body takes no more of it than its speed, the wall's, needs
    if (demand.wall_fall > 0.0)
      fall = 2.0 / squared(aim) *
             std::max(load_of_a_contact(bodies, demand.wall_fall),
                      std::min(1.0, lighter / demand.wall_mass) * demand.wall_fall);
    using Cause = StiffnessChoice::Cause;
    const double k_n = std::max({impact, fall, rest});
    if (k_n > choice.k_n)
      choice = {k_n,
                k_n == impact ? Cause::impact
                : k_n == fall ? Cause::wall_fall
                              : Cause::load,
                s,
                {b, other}};
  });
  return choice;
}

double greatest_pull(const Bodies& bodies, const ContactDemand& demand) {
  double greatest = 0.0;
  for_worst_pairs(bodies, demand.walls, [&](std::uint32_t s, std::uint32_t, const auto& other) {
    greatest = std::max(greatest, pull(bodies, demand, s, other) / smaller_radius(bodies, s, other));
  });
  return greatest;
}

ShortestContact shortest_contact(const Bodies& bodies, const ContactLaws& laws) {
  const auto& radii = bodies.spheres.radius;
  std::map<std::uint32_t, Mobility> mobility;  // M times the mobility does not depend on size or density
  struct OfMaterial {
    Greatest normal, sliding, turning;
    std::size_t bodies = 0;  // not held
    std::optional<std::uint32_t> held;
  };
  std::vector<OfMaterial> worst(laws.materials);
  std::size_t free = 0;
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    OfMaterial& material = worst[laws.material[b]];
    if (is_held(bodies, b)) {
      material.held = b;
      continue;
    }
    ++free;
    auto [it, fresh] = mobility.try_emplace(bodies.shape[b]);
    if (fresh) it->second = greatest_mobility(bodies, b);
    material.normal.add(b, it->second.normal / bodies.mass[b]);
    material.sliding.add(b, it->second.tangential / bodies.mass[b]);
    const double radius = largest_radius(bodies, b);
    material.turning.add(b, radius * radius / bodies.inertia[b][0]);
    ++material.bodies;
  }
  // Squared frequencies of the two worst bodies of the materials; what is held adds no mobility.
  double fastest = 0.0;
  ShortestContact out;
  const auto take = [&](ShortestContact::Mode mode, double square, const Encounter& encounter) {
    if (square <= fastest) return;
    fastest = square;
    out = {kPi / std::sqrt(square), mode, encounter};
  };
  const auto take_all = [&](const PairLaw& law, double normal, double sliding, double turning,
                            const auto& who) {
    using Mode = ShortestContact::Mode;
    take(Mode::normal, law.k_n * normal, who(&OfMaterial::normal));
    take(Mode::sliding, law.k_s * sliding, who(&OfMaterial::sliding));
    if (laws.rolling)
      take(Mode::rolling, std::max(law.k_n, 2.0 * law.k_s) * law.beta * law.beta * turning,
           who(&OfMaterial::turning));
  };
  // R^2 / I summed over both, R = r / (1 + ratio of the radii): most when the worse one is the smaller.
  const auto [least, most] = std::minmax_element(radii.begin(), radii.end());
  const double ratio = *least / *most;
  for (std::size_t m = 0; m < worst.size(); ++m) {
    const OfMaterial& a = worst[m];
    if (a.bodies == 0) continue;
    for (std::size_t w = 0; w < laws.walls.size() / laws.materials; ++w)
      take_all(laws.walls[w * laws.materials + m], a.normal.first() + 1.0 / laws.lightest_wall,
               a.sliding.first() + 1.0 / laws.lightest_wall, a.turning.first(), [&](auto of) {
                 return Encounter{(a.*of).body(), {}};
               });
    for (std::size_t n = 0; n < worst.size(); ++n)
      if (worst[n].held)
        take_all(laws.bodies[m * laws.materials + n], a.normal.first(), a.sliding.first(),
                 a.turning.first() / ((1.0 + ratio) * (1.0 + ratio)), [&](auto of) {
                   return Encounter{(a.*of).body(), worst[n].held};
                 });
    for (std::size_t n = m; n < worst.size(); ++n) {
      const OfMaterial& b = worst[n];
      const bool alone = n == m && a.bodies == 1 && free > 1;  // it meets only those of others
      if (b.bodies == 0 || alone) continue;
      const auto second = [&](auto of) { return n == m ? (a.*of).next() : (b.*of).first(); };
      const double turning[] = {a.turning.first(), second(&OfMaterial::turning)};
      take_all(laws.bodies[m * laws.materials + n], a.normal.first() + second(&OfMaterial::normal),
               a.sliding.first() + second(&OfMaterial::sliding),
               (std::max(turning[0], turning[1]) + ratio * ratio * std::min(turning[0], turning[1])) /
                   ((1.0 + ratio) * (1.0 + ratio)),
               [&](auto of) {
                 return n == m ? (a.*of).of_both() : Encounter{(a.*of).body(), (b.*of).body()};
               });
    }
  }
  return out;
}

}  // namespace cairn
