// Stiffness of materials: static overlaps, blows, tangential oscillations, a change of materials.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

const double kMass = 2000.0 * 4.0 / 3.0 * kPi;  // kg, of a ball of 1 m

std::string material(const std::string& name, double restitution, double friction, const std::string& more) {
  return fmt::format(
      "[[material]]\nname = '{}'\nrestitution_normal = {:.17g}\nrestitution_tangential = {:.17g}\nfriction = "
      "{:.17g}\n"
      "friction_rolling = 0\nfriction_twisting = 0\n{}\n",
      name, restitution, restitution, friction, more);
}

std::string ball(const std::string& material, const Vec3& position, const Vec3& velocity = Vec3::Zero(),
                 const Vec3& spin = Vec3::Zero()) {
  return fmt::format(
      "[[body]]\nshape = 'sphere'\ndensity = 2000\nmaterial = '{}'\nposition = {}\nvelocity = "
      "{}\nangular_velocity = {}\n",
      material, toml(position), toml(velocity), toml(spin));
}

std::string floor_of(const std::string& material) {
  return fmt::format("[[wall]]\nkind = 'plane'\nmaterial = '{}'\n", material);
}

std::string stage(const std::string& gravity, const std::string& contact = {}, double duration = 1e4) {
  return fmt::format("[gravity]\n{}\n[contact]\n{}\n[[stage]]\nname = 's'\nduration = {}\n",
                     gravity.empty() ? "method = 'none'" : gravity, contact, duration);
}

double in_series(double a, double b) {
  return 2.0 / (1.0 / a + 1.0 / b);
}

TEST(Stiffness, AStackOfTwoMaterialsSinksByItsPairs) {
  constexpr double soft = 1e6, hard = 5e6, plain = 2e6, g = 1.0;
  Experiment e(material("soft", 0.1, 0.0, fmt::format("stiffness = {}", soft)) +
               material("hard", 0.1, 0.0, fmt::format("stiffness = {}", hard)) +
               material("plain", 0.1, 0.0, "") + ball("soft", {0, 0, 1.0}) + ball("hard", {0, 0, 3.0}) +
               ball("plain", {9, 0, 1.0}) + floor_of("hard") +
               stage(field({0, 0, -g}), fmt::format("stiffness = {}", plain)));
  e.begin();
  e.advance(static_cast<std::uint64_t>(20.0 / e.physics.contacts.dt));
  const Bodies& bodies = e.state.bodies;
  const double z0 = bodies.position[0].z(), z1 = bodies.position[1].z();
  report::close("two balls on a floor of another stiffness: overlap with the floor, m",
                "weight / k in series", 1.0 - z0, 2.0 * kMass * g / in_series(soft, hard), 1e-6);
  report::close("the same: overlap of the balls, m", "weight / k in series", 2.0 - (z1 - z0),
                kMass * g / in_series(soft, hard), 1e-6);
  report::close("a ball without a stiffness of its own on that floor: overlap, m", "weight / k in series",
                1.0 - bodies.position[2].z(), kMass * g / in_series(plain, hard), 1e-6);
  // Stored energy: of three springs.
  const double k = in_series(soft, hard), load = kMass * g;
  EXPECT_NEAR(e.spring_energy(),
              0.5 * (4.0 * load * load / k + load * load / k + load * load / in_series(plain, hard)),
              1e-6 * load * load / k);
}

TEST(Stiffness, BlowsOfTwoMaterialsReturnTheRestitutionAndLastAsTheirSpring) {
  constexpr double soft = 1e6, hard = 9e6, speed = 0.05;
  const double e55 = 0.55, log_e = std::log(e55), zeta = -log_e / std::sqrt(kPi * kPi + log_e * log_e);
  Experiment e(material("soft", e55, 0.0, fmt::format("stiffness = {}", soft)) +
               material("hard", e55, 0.0, fmt::format("stiffness = {}", hard)) + ball("soft", {0, 0, 0}) +
               ball("hard", {2.01, 0, 0}, {-speed, 0, 0}) + stage("", "steps_per_contact = 200"));
  e.begin();
  double begun = 0.0;
  while (!e.touching()) e.advance(1);
  begun = e.state.clock.time();
  while (e.touching()) e.advance(1);
  const double lasted = e.state.clock.time() - begun;
  report::close("blow of balls of two stiffnesses: restitution", "that of their materials",
                (e.state.bodies.velocity[1].x() - e.state.bodies.velocity[0].x()) / speed, e55, 1e-3);
  report::close("the same: how long it lasts, s", "half a damped period of the springs in series", lasted,
                kPi / std::sqrt(in_series(soft, hard) / (0.5 * kMass) * (1.0 - zeta * zeta)), 0.01);
}

TEST(Stiffness, OneStiffnessForAllIsThatOfTheScene) {
  const std::string bodies = ball("m", {0, 0, 0.999}, {0.02, 0, 0}, {0, 0.1, 0}) +
                             ball("m", {1.9, 0, 1.2}, {-0.1, 0, 0}) + floor_of("m");
  Experiment own(material("m", 0.5, 0.7, "stiffness = 3e6") + bodies + stage(field({0, 0, -1})));
  Experiment scene(material("m", 0.5, 0.7, "") + bodies + stage(field({0, 0, -1}), "stiffness = 3e6"));
  for (Experiment* e : {&own, &scene}) {
    e->begin();
    e->advance(2000);
  }
  EXPECT_EQ(own.physics.contacts.dt, scene.physics.contacts.dt);
  EXPECT_EQ(own.state.bodies.position, scene.state.bodies.position);
  EXPECT_EQ(own.state.bodies.spin, scene.state.bodies.spin);
}

// A ball that rests on a rough floor and is pushed a little: contact point on its spring, 1/mu_t = 1/m +
// l^2/I.
TEST(StiffnessRatio, ATangentialOscillationHasItsFrequency) {
  constexpr double k_n = 1e6, g = 1.0;
  for (const double ratio : {0.2, 2.0 / 7.0, 0.8}) {
    const double sag = kMass * g / k_n, lever = 1.0 - sag, push = 1e-6;
    Experiment e(
        material("m", 1.0, 100.0, fmt::format("stiffness = {}\nstiffness_ratio = {:.17g}", k_n, ratio)) +
        ball("m", {0, 0, lever}, {push, 0, 0}) + floor_of("m") +
        stage(field({0, 0, -g}), "steps_per_contact = 200"));
    e.begin();
    const double dt = e.physics.contacts.dt;
    const Bodies& bodies = e.state.bodies;
    double before = push, first = 0.0, last = 0.0;
    int crossings = 0;
    for (int k = 0; k < 100'000 && crossings < 21; ++k) {
      e.advance(1);
      const double slip = bodies.velocity[0].x() - lever * angular_velocity(bodies, 0).y();
      if (slip * before < 0.0) {
        last = e.state.clock.time() - dt * slip / (slip - before);
        if (crossings++ == 0) first = last;
      }
      before = slip;
    }
    ASSERT_EQ(crossings, 21);
    const double rate = std::sqrt(ratio * k_n * (1.0 / kMass + lever * lever / (0.4 * kMass)));
    report::close(
        fmt::format("ball on a rough floor, k_S / k_N = {:.3g}: rate of its tangential oscillation, rad/s",
                    ratio),
        "rate^2 = k_S (1/m + l^2/I)", 20.0 * kPi / (last - first), rate, 1e-4);
  }
}

// Without damping or sliding the contact point has turned by pi sqrt(7/2 k_S/k_N) when the normal blow is
// over.
TEST(StiffnessRatio, AnObliqueBlowReturnsTheTangentialSpeedOfItsRatio) {
  constexpr double k_n = 1e8, speed = 0.1, slip = 1e-4;
  for (const double ratio : {0.15, 2.0 / 7.0, 0.5, 1.0}) {
    Experiment e(
        material("m", 1.0, 1e4, fmt::format("stiffness = {}\nstiffness_ratio = {:.17g}", k_n, ratio)) +
        ball("m", {0, 0, 1.01}, {slip, 0, -speed}) + floor_of("m") + stage("", "steps_per_contact = 200"));
    e.begin();
    pass_blow(e);
    const Bodies& bodies = e.state.bodies;
    const double after = bodies.velocity[0].x() - angular_velocity(bodies, 0).y();
    report::near(
        fmt::format("oblique blow without sliding, k_S / k_N = {:.3g}: tangential speed after over before",
                    ratio),
        "cos(pi sqrt(7/2 k_S/k_N))", after / slip, std::cos(kPi * std::sqrt(3.5 * ratio)), 0.01);
  }
}

}  // namespace
}  // namespace cairn
