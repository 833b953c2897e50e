// Bodies that touch nothing: stages without contacts, and a body that is alone.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kG = kGravitationalConstant;

/// Place in the plane x y of a Kepler orbit with periapsis q on x at time 0.
Vec3 kepler(double gm, double q, double eccentricity, double t) {
  const double a = q / (1.0 - eccentricity), mean = std::sqrt(gm / (a * a * a)) * t;
  double e = mean;
  for (int k = 0; k < 100; ++k)
    e -= (e - eccentricity * std::sin(e) - mean) / (1.0 - eccentricity * std::cos(e));
  return {a * (std::cos(e) - eccentricity), a * std::sqrt(1.0 - eccentricity * eccentricity) * std::sin(e),
          0.0};
}

/// Greatest error of the distance vector of two balls over `turns` orbits, over the semi-major axis.
double orbit_error(double eccentricity, const std::string& contact, double turns, Physics& physics) {
  const double q = 1.6, mass = 2000.0 * 4.0 / 3.0 * kPi, gm = kG * mass * (1.0 + 0.125);
  const double a = q / (1.0 - eccentricity), period = 2.0 * kPi * std::sqrt(a * a * a / gm);
  const Vec3 speed(0.0, std::sqrt(gm * (1.0 + eccentricity) / q), 0.0);
  Experiment e(
      scene_text({}, contact, "method = 'direct'\ninterval = 1",
                 body({.size = 1.0, .position = {-q / 9.0, 0, 0}, .velocity = -1.0 / 9.0 * speed}) +
                     body({.size = 0.5, .position = {q * 8.0 / 9.0, 0, 0}, .velocity = 8.0 / 9.0 * speed}),
                 1e7));
  e.begin();
  physics = e.physics;
  const Bodies& bodies = e.state.bodies;
  double worst = 0.0;
  while (e.state.clock.time() < turns * period) {
    e.advance(20);
    const Vec3 d = place(bodies, 1) - place(bodies, 0);
    worst = std::max(worst, (d - kepler(gm, q, eccentricity, e.state.clock.time())).norm() / a);
  }
  EXPECT_EQ(e.state.contacts.slots(), 0u);
  return worst;
}

TEST(NoContacts, TwoBodiesOnKeplersOrbits) {
  Physics physics;
  for (const double eccentricity : {0.1, 0.6}) {
    report::error(
        fmt::format("two balls on an orbit of eccentricity {}, no stiffness and no time step given: "
                    "their places over three turns, semi-major axes",
                    eccentricity),
        "Kepler's equation", orbit_error(eccentricity, "enabled = false", 3.0, physics),
        eccentricity < 0.5 ? 2e-4 : 1e-3);
    EXPECT_FALSE(physics.can_touch);
    EXPECT_NEAR(physics.contacts.dt, 0.01 / std::sqrt(kG * 2000.0 * 4.0 / 3.0 * kPi), 0.01);
  }
  const double coarse = orbit_error(0.6, "enabled = false\ntime_step = 40", 1.0, physics),
               fine = orbit_error(0.6, "enabled = false\ntime_step = 20", 1.0, physics);
  report::near("the same: order in the time step", "2", std::log2(coarse / fine), 2.0, 0.05);
}

TEST(NoContacts, BodiesAreNoObstacle) {
  const Vec3 spin(0.3, -0.1, 0.4);
  const std::string two =
      body({.shape = "cube", .position = {-5, 0.3, 0}, .velocity = {1, 0, 0}, .spin = spin}) +
      body({.position = {5, 0, 0}, .velocity = {-1, 0, 0}});
  Experiment e(scene_text({}, "enabled = false", "", two, 10.0));
  e.begin();
  Bodies& bodies = e.state.bodies;
  const Vec3 momentum = bodies.spin[0];
  EXPECT_EQ(e.state.k_n, 0.0);
  e.advance(e.physics.steps);
  EXPECT_LT((place(bodies, 0) - Vec3(5, 0.3, 0)).norm(), 1e-12);
  EXPECT_LT((place(bodies, 1) - Vec3(-5, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(bodies.velocity[0], Vec3(1, 0, 0));
  EXPECT_EQ(bodies.spin[0], momentum);
  EXPECT_EQ(e.state.ledger.largest_overlap, 0.0);

  // With contacts they bounce; a single body needs none, nor their stiffness.
  Experiment bounce(scene_text({}, "stiffness = 1e8", "", two, 10.0));
  bounce.begin();
  bounce.advance(bounce.physics.steps);
  EXPECT_GT(bounce.state.bodies.velocity[1].x(), 0.0);
  Experiment alone(scene_text({}, "", "", body({.velocity = {1, 2, 3}}), 10.0));
  alone.begin();
  EXPECT_FALSE(alone.physics.can_touch);
  EXPECT_EQ(alone.physics.steps, 1000u);
  Experiment above_floor(scene_text({}, "stiffness = 1e6", "", body({.position = {0, 0, 3}}) + wall(), 10.0));
  above_floor.begin();
  EXPECT_TRUE(above_floor.physics.can_touch);
}

/// Spin that a rod gains as it passes a planet, kg m^2/s.
Vec3 flyby(const std::string& contact, Physics& physics) {
  const std::string planet =
      "[[perturber]]\nname = 'P'\ngm = 4e14\nradius = 6e6\n[perturber.orbit]\neccentricity = 1.5\n"
      "periapsis = 1e7\nperiapsis_time = 20000\n";
  Experiment e(scene_text(
      {}, contact, "", body({.shape = "rod4", .orientation = Quat(0.8, 0.3, -0.4, 0.3)}) + planet, 40000.0));
  e.begin();
  physics = e.physics;
  e.advance(e.physics.steps);
  return e.state.bodies.spin[0];
}

TEST(NoContacts, ASingleBodyPastAPlanetNeedsNoKeysOfContacts) {
  Physics physics;
  const Vec3 exact = flyby("time_step = 0.5", physics), gained = flyby("", physics);
  EXPECT_FALSE(physics.can_touch);
  EXPECT_NEAR(physics.contacts.dt, 0.01 * std::sqrt(std::pow(1e7, 3) / 4e14), 0.01);
  report::error("rod past a planet, no key of contacts: spin that it gains, relative",
                "the same in steps of 0.5 s", (gained - exact).norm() / exact.norm(), 3e-5);
}

}  // namespace
}  // namespace cairn
