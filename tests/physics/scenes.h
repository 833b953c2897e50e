// Scenes of a few bodies as text, and bodies led by hand: what the tests of single contacts share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "analysis/budget.h"
#include "physics/experiment.h"

namespace cairn {

/// The one material of a scene; by default elastic, smooth and dry.
struct Surface {
  double restitution = 1.0;  ///< normal and tangential
  double friction = 0.0, rolling = 0.0, twisting = 0.0, beta = 0.5, cohesion = 0.0;
};

/// One body of a scene.
struct Put {
  std::string shape = "sphere";
  double size = 1.0, density = 2000.0;
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(), spin = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

inline std::string toml(const Vec3& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z());
}

inline std::string body(const Put& put) {
  const Quat& q = put.orientation;
  return fmt::format(
      "[[body]]\nshape = '{}'\nsize = {:.17g}\ndensity = {:.17g}\nposition = {}\nvelocity = {}\n"
      "angular_velocity = {}\norientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\nmaterial = 'surface'\n",
      put.shape, put.size, put.density, toml(put.position), toml(put.velocity), toml(put.spin), q.w(), q.x(),
      q.y(), q.z());
}

/// A solid half-space through `point`; `normal` points out of it.
inline std::string wall(const Vec3& normal = Vec3::UnitZ(), const Vec3& point = Vec3::Zero()) {
  return fmt::format("[[wall]]\nkind = 'plane'\npoint = {}\nnormal = {}\nmaterial = 'surface'\n", toml(point),
                     toml(normal));
}

/// A ball of bodies of one shape and size at random, 20 % of it filled.
inline std::string cloud(const std::string& shape, int count, double size, double density) {
  return fmt::format(
      "[[cloud]]\nshape = [{{ shape = '{}' }}]\ncount = {}\nsize = {}\ndensity = {}\nfilling = 0.2\n"
      "material = 'surface'\n",
      shape, count, size, density);
}

/// A scene of one stage. `contact` and `gravity` are the keys of those tables.
inline std::string scene_text(const Surface& s, const std::string& contact, const std::string& gravity,
                              const std::string& content, double duration = 1e6) {
  return fmt::format(R"(
[[material]]
name = "surface"
restitution_normal = {0:.17g}
restitution_tangential = {0:.17g}
friction = {1:.17g}
friction_rolling = {2:.17g}
friction_twisting = {3:.17g}
shape_factor = {4:.17g}
cohesion = {5:.17g}
[contact]
{6}
[gravity]
{7}
[[stage]]
name = "test"
duration = {8:.17g}
{9}
)",
                     s.restitution, s.friction, s.rolling, s.twisting, s.beta, s.cohesion, contact,
                     gravity.empty() ? "method = 'none'" : gravity, duration, content);
}

/// A hundred mixed bodies that fall together under exact gravity to a pile that turns once in some hours.
inline std::string hundred_bodies() {
  return "seed = 8\n" +
         scene_text({.restitution = 0.3, .friction = 0.6, .rolling = 0.5, .twisting = 0.5, .cohesion = 1.0},
                    "max_overlap = 0.05\noverlap_limit = 0.5\nsteps_per_contact = 30", "method = 'direct'",
                    R"(
[[cloud]]
shape = [{ shape = 'dumbbell' }, { shape = 'tetrahedron' }, { shape = 'diamond' }, { shape = 'sphere' }]
count = 100
size = 5
density = 3000
filling = 0.2
spin_period = 40000
material = 'surface'
)",
                    1e4);
}

/// A uniform field as keys of the gravity table.
inline std::string field(const Vec3& g) {
  return "method = 'none'\nfield = " + toml(g);
}

/// Leads body b by hand through the next step: nothing that acted on it counts, it moves as told.
inline void lead(Experiment& e, std::size_t b, const Vec3& velocity, const Vec3& angular_velocity) {
  Bodies& bodies = e.state.bodies;
  const Quat& q = bodies.orientation[b];
  bodies.force[b].setZero();
  bodies.torque[b].setZero();
  bodies.velocity[b] = velocity;
  bodies.spin[b] = q * (q.conjugate() * angular_velocity).cwiseProduct(bodies.inertia[b]);
}

/// Tilts the field g of a level floor slowly to `angle` towards x; mean acceleration of body 0 (m/s^2)
/// afterwards.
inline double acceleration_after_tilting(Experiment& e, double g, double angle) {
  constexpr double tilting = 1.0, rest = 0.5, measuring = 0.25;  // s
  e.begin();
  const double dt = e.physics.contacts.dt;
  for (double t = 0.0; t < tilting + rest; t += dt) {
    const double part = 0.5 - 0.5 * std::cos(kPi * std::min(1.0, t / tilting));
    e.physics.field = g * Vec3(std::sin(part * angle), 0.0, -std::cos(part * angle));
    e.advance(1);
  }
  const double before = e.state.bodies.velocity[0].x();
  const auto steps = static_cast<std::uint64_t>(measuring / dt);
  e.advance(steps);
  return (e.state.bodies.velocity[0].x() - before) / (static_cast<double>(steps) * dt);
}

/// Runs until bodies that meet have parted again.
inline void pass_blow(Experiment& e) {
  for (int k = 0; k < 100000 && !e.touching(); ++k) e.advance(1);
  ASSERT_TRUE(e.touching());
  for (int k = 0; k < 100000 && e.touching(); ++k) e.advance(1);
  ASSERT_FALSE(e.touching());
}

/// Change of the momentum over the sum of the bodies' magnitudes.
inline double momentum_drift(const Budget& before, const Budget& after) {
  return (after.momentum - before.momentum).norm() / before.momentum_scale;
}
/// The same of the angular momentum about the mass centre.
inline double angular_drift(const Budget& before, const Budget& after) {
  return (after.angular_momentum_about_center - before.angular_momentum_about_center).norm() /
         before.angular_scale_about_center;
}

/// Kinetic energy and what the springs hold (J).
inline double mechanical_energy(const Experiment& e) {
  return e.kinetic_energy() + e.spring_energy();
}

/// Least-squares slope of log y against log x.
inline double order_of(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double a = std::log(x[k]), b = std::log(y[k]);
    sx += a;
    sy += b;
    sxx += a * a;
    sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace cairn
