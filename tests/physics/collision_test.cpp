// Blows of two bodies against closed forms: restitution, momenta after the blow, duration, energy.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/law/pair.h"
#include "motion/drift.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kStiffness = 1e7;   // N/m
constexpr double kDensity = 2000.0;  // kg/m^3

/// A scene of smooth bodies put by hand, without gravity; `contact` adds keys to its contact table.
std::string smooth_scene(double restitution, const std::string& bodies, const std::string& contact) {
  return scene_text({.restitution = restitution}, fmt::format("stiffness = {}\n{}", kStiffness, contact), "",
                    bodies, 1e3);
}

/// The two sides of a blow as the first touch finds them.
struct Blow {
  Vec3 normal, arm_i, arm_j;                    ///< from body 0 to body 1 (or into the wall)
  double mass;                                  ///< effective, kg
  Vec3 velocity_i, velocity_j, spin_i, spin_j;  ///< before
  double approach;                              ///< m/s
};

Vec3 point_velocity(const Bodies& bodies, std::size_t b, const Vec3& arm) {
  return bodies.velocity[b] + angular_velocity(bodies, b).cross(arm);
}

/// Steps until something touches and describes the blow; the closed form takes the geometry of this moment
/// and the velocities before.
Blow meet(Experiment& e) {
  const Bodies& bodies = e.state.bodies;
  std::vector<Vec3> velocity = bodies.velocity, spin = bodies.spin;
  for (int k = 0; k < 200'000 && !e.touching(); ++k) {
    velocity = bodies.velocity;
    spin = bodies.spin;
    e.advance(1);
  }
  EXPECT_TRUE(e.touching());
  Blow blow;
  Inertia other;
  blow.arm_j = blow.velocity_j = blow.spin_j = Vec3::Zero();
  const Inertia first{1.0 / bodies.mass[0], inverse_inertia(bodies, 0)};
  if (!e.state.walls.empty()) {
    const Vec3 x = bodies.spheres.position[e.state.walls.contacts.front().sphere];
    const WallTouch touch = e.state.walls.walls[0].nearest(x);
    blow.normal = touch.n;
    blow.arm_i = x + touch.arm * touch.n - bodies.position[0];
  } else {
    const ContactRecord r = e.state.contacts.records().front();
    const Vec3 a = bodies.spheres.position[r.i], b = bodies.spheres.position[r.j];
    blow.normal = (b - a).normalized();
    const Vec3 c = a + bodies.spheres.radius[r.i] * blow.normal;
    blow.arm_i = c - bodies.position[0];
    blow.arm_j = c - bodies.position[1];
    other = {1.0 / bodies.mass[1], inverse_inertia(bodies, 1)};
    blow.velocity_j = velocity[1];
    blow.spin_j = spin[1];
  }
  blow.velocity_i = velocity[0];
  blow.spin_i = spin[0];
  const auto mobility = [&](const Inertia& side, const Vec3& arm) {
    const Vec3 lever = arm.cross(blow.normal);
    return side.inverse_mass + lever.dot(side.inverse_inertia * lever);
  };
  const auto towards = [&](const Inertia& side, const Vec3& v, const Vec3& l, const Vec3& arm) {
    return (v + (side.inverse_inertia * l).cross(arm)).dot(blow.normal);
  };
  blow.mass = 1.0 / (mobility(first, blow.arm_i) + mobility(other, blow.arm_j));
  blow.approach = towards(first, blow.velocity_i, blow.spin_i, blow.arm_i) -
                  towards(other, blow.velocity_j, blow.spin_j, blow.arm_j);
  return blow;
}

/// Speed of parting at the contact point (m/s).
double parting(const Experiment& e, const Blow& blow) {
  const Bodies& bodies = e.state.bodies;
  double speed = -point_velocity(bodies, 0, blow.arm_i).dot(blow.normal);
  if (bodies.size() > 1) speed += point_velocity(bodies, 1, blow.arm_j).dot(blow.normal);
  return speed;
}

struct Setting {
  const char* name;
  std::string bodies;
};

/// Central and off-centre blows at 1 cm/s: overlaps stay under 1e-3 m and the bodies hardly turn.
std::vector<Setting> settings() {
  const auto put = [](const char* shape, double size, const Vec3& position,
                      const Vec3& velocity = Vec3::Zero(), const Quat& orientation = Quat::Identity(),
                      const Vec3& spin = Vec3::Zero()) {
    return body({shape, size, kDensity, position, velocity, spin, orientation});
  };
  const Vec3 right(0.01, 0, 0), origin = Vec3::Zero();
  return {
      {"two spheres, central", put("sphere", 1.0, origin, right) + put("sphere", 2.0, {3.0001, 0, 0})},
      {"two spheres, grazing", put("sphere", 1.0, origin, right) + put("sphere", 1.0, {1.6001, 1.2, 0})},
      {"sphere on wall", put("sphere", 1.0, {0, 0, 1.0001}, {0.004, 0, -0.01}) + wall()},
      {"dumbbell flat side against sphere", put("dumbbell", 1.0, origin, right, Quat(1, 0, 0, 1)) +
                                                put("sphere", 1.0, {2.0001, 0.8660254037844386, 0})},
      {"dumbbell end on wall, upright",
       put("dumbbell", 1.0, {0, 0, 1.8661}, {0, 0, -0.01}, Quat(1, 0, 1, 0)) + wall()},
      {"dumbbell off-centre on wall",
       put("dumbbell", 1.0, {0, 0, 1.8}, {0.003, 0, -0.01}, Quat(0.92, 0, 0.39, 0)) + wall()},
      {"two tetrahedra, off-centre",
       put("tetrahedron", 1.0, origin, right, Quat(0.9, 0.1, 0.4, 0.2)) +
           put("tetrahedron", 1.0, {4, 0.7, -0.4}, origin, Quat::Identity(), {1e-5, 2e-5, 0})},
      {"rod against cube", put("rod4", 1.0, origin, right, Quat(1, 0, 0.1, 0.8)) +
                               put("cube", 1.5, {5, 1.3, 0.5}, origin, Quat(0.8, 0.3, 0.1, 0.2))},
  };
}

/// Moves the bodies on, free of forces, until the smallest gap is a hundredth of a millimetre: the blow is
/// short, the way to it long.
void approach(Experiment& e) {
  Bodies& bodies = e.state.bodies;
  for (double gap = 1.0; gap > 2e-5 && !e.touching();) {
    gap = 1e300;
    const Spheres& s = bodies.spheres;
    for (std::size_t a = 0; a < s.size(); ++a) {
      for (std::size_t b = a + 1; b < s.size(); ++b)
        if (s.body[a] != s.body[b])
          gap = std::min(gap, (s.position[a] - s.position[b]).norm() - s.radius[a] - s.radius[b]);
      for (const Wall& wall : e.state.walls.walls)
        gap = std::min(gap, wall.nearest(s.position[a]).arm - s.radius[a]);
    }
    const double safe = std::max(0.0, gap - 1e-5) / 0.02;  // no point moves faster than 2 cm/s
    for (Vec3& v : bodies.force) v.setZero();
    std::vector<Vec3> mid;
    drift(bodies, safe, mid);
    place_spheres(bodies);
  }
}

/// What a blow did, against the closed forms of an impulse and of the damped oscillator
/// x'' + 2 zeta w x' + w^2 x = 0, which touches until x = 0 again, half a damped period later.
struct Struck {
  double restitution;
  double momenta;  ///< error of all momenta and spins over the impulse, with 1 m for a lever
  double duration, expected_duration;  ///< s, in whole steps
  double overlap, expected_overlap;    ///< m
};

/// The first step is `phase` of a step shorter.
Struck strike(const Setting& setting, double restitution, double steps_per_contact, double phase) {
  Experiment e(
      smooth_scene(restitution, setting.bodies, fmt::format("steps_per_contact = {}", steps_per_contact)));
  e.begin();
  approach(e);
  Bodies& bodies = e.state.bodies;
  const double dt = e.physics.contacts.dt;
  std::vector<Vec3> mid;
  drift(bodies, phase * dt, mid);
  e.begin();
  const Blow blow = meet(e);
  EXPECT_GT(blow.approach, 0.002);
  std::uint64_t steps = 0;
  for (; e.touching() && steps < 20'000; ++steps) e.advance(1);
  EXPECT_FALSE(e.touching());

  const double impulse = (1.0 + restitution) * blow.mass * blow.approach;
  const Vec3 j = impulse * blow.normal;
  double error = (bodies.mass[0] * (bodies.velocity[0] - blow.velocity_i) + j).norm();
  error = std::max(error, (bodies.spin[0] - blow.spin_i + blow.arm_i.cross(j)).norm());
  if (bodies.size() > 1) {
    error = std::max(error, (bodies.mass[1] * (bodies.velocity[1] - blow.velocity_j) - j).norm());
    error = std::max(error, (bodies.spin[1] - blow.spin_j - blow.arm_j.cross(j)).norm());
  }
  const double omega = std::sqrt(kStiffness / blow.mass), zeta = 0.5 * damping_ratio(restitution),
               damped = omega * std::sqrt(1.0 - zeta * zeta);
  const auto& radii = bodies.spheres.radius;
  return {.restitution = parting(e, blow) / blow.approach,
          .momenta = error / impulse,
          .duration = static_cast<double>(steps) * dt,
          .expected_duration = kPi / damped,
          .overlap = e.state.ledger.largest_overlap * *std::min_element(radii.begin(), radii.end()),
          .expected_overlap = blow.approach / omega * std::exp(-zeta * omega / damped * std::acos(zeta))};
}

TEST(Blow, GivesTheRestitutionAskedForAndTheMomentaOfAnImpulse) {
  for (const Setting& setting : settings())
    for (const double restitution : {0.05, 0.2, 0.55, 0.9}) {
      SCOPED_TRACE(fmt::format("{}, e = {}", setting.name, restitution));
      const Struck out = strike(setting, restitution, 1000.0, 0.0);
      const std::string what = fmt::format("{}, e = {}", setting.name, restitution);
      report::near(what + ": restitution at the contact point", "value asked for", out.restitution,
                   restitution, std::max(0.0025, 0.005 * restitution));
      report::error(what + ": momenta and spins of both bodies after the blow, worst, over the impulse",
                    "impulse (1 + e) mu u_n at the contact point", out.momenta, 0.003);
      report::close(what + ": duration, s", "damped oscillator", out.duration, out.expected_duration, 0.005);
      report::close(what + ": greatest overlap, m", "damped oscillator", out.overlap, out.expected_overlap,
                    0.005);
      EXPECT_LT(out.overlap, 1e-3);  // and so under 1e-3 radii
    }
}

TEST(Blow, GivesTheRestitutionAskedForAtEveryPhaseOfTheDefaultStep) {
  constexpr int phases = 10;
  for (const Setting& setting : settings())
    for (const double restitution : {0.05, 0.55}) {
      SCOPED_TRACE(fmt::format("{}, e = {}", setting.name, restitution));
      double mean = 0.0, worst = 0.0;
      for (int k = 0; k < phases; ++k) {
        const double out = strike(setting, restitution, 50.0, (k + 0.5) / phases).restitution;
        mean += out / phases;
        worst = std::max(worst, std::abs(out - restitution));
      }
      const std::string what =
          fmt::format("{}, e = {}: restitution, 50 steps per contact, ", setting.name, restitution);
      // The time step is a fiftieth of the shortest mode of this very pair.
      const double tolerance = restitution < 0.1 ? 0.0025 : 0.0055 * restitution;
      report::near(what + fmt::format("mean of {} phases", phases), "value asked for", mean, restitution,
                   tolerance);
      report::error(what + "worst phase", "value asked for", worst, tolerance);
    }
}

/// Relative change of kinetic energy in an elastic, frictionless blow of two tetrahedra that meet off-centre,
/// root mean square over eight phases of the step at first touch.
double energy_error(double steps_per_contact) {
  constexpr int phases = 8;
  double sum = 0.0;
  for (int phase = 0; phase < phases; ++phase) {
    Experiment e(smooth_scene(1.0,
                              fmt::format(R"(
[[body]]
shape = "tetrahedron"
density = {0}
material = "surface"
velocity = [0.1, 0, 0]
angular_velocity = [0.05, 0.02, -0.03]
orientation = [0.9, 0.1, 0.4, 0.2]
[[body]]
shape = "tetrahedron"
density = {0}
material = "surface"
position = [3.2, 0.7, -0.4]
)",
                                          kDensity),
                              fmt::format("steps_per_contact = {}", steps_per_contact)));
    e.begin();
    e.state.bodies.position[1].x() += phase * 0.1 * e.physics.contacts.dt / phases;
    e.begin();
    EXPECT_FALSE(e.touching());
    const double before = e.kinetic_energy();
    double deepest = 0.0;
    for (double t = 0.0; t < 8.0; t += e.physics.contacts.dt) {
      e.advance(1);
      deepest = std::max(deepest, e.spring_energy());
    }
    EXPECT_FALSE(e.touching());
    EXPECT_GT(deepest, 0.2 * before);  // they did meet
    EXPECT_EQ(e.state.ledger.dissipated, 0.0);
    sum += std::pow(e.kinetic_energy() / before - 1.0, 2);
  }
  return std::sqrt(sum / phases);
}

TEST(ElasticBlow, OffCentreTetrahedraKeepTheirEnergyToSecondOrder) {
  const std::vector<double> steps{25, 50, 100, 200};
  report::Curve curve{"two tetrahedra, elastic", steps, {}};
  for (const double n : steps) curve.y.push_back(energy_error(n));
  report::error(
      "two tetrahedra off-centre, elastic: change of kinetic energy at 50 steps per contact, relative",
      "conserved", curve.y[1], 1e-3);
  // On the average of phases: a single blow depends on the phase of the step at first touch.
  report::within("order of that error, 25 to 200 steps per contact", "second order or better",
                 -order_of(curve.x, curve.y), 1.7, 3.5);
  report::plot("elastic-blow", "Energy error of an elastic off-centre blow of two tetrahedra.",
               {"steps per contact", "relative error of the energy", true, true}, {curve});
}

}  // namespace
}  // namespace cairn
