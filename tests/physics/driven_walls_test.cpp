// Walls under a load against closed forms, and bodies that walls do not touch.
#include <gtest/gtest.h>

#include <cmath>

#include "physics/experiment.h"
#include "physics/report.h"
#include "sim/warnings.h"

namespace cairn {
namespace {

constexpr double kStiffness = 1e6;  // N/m

std::string scene(const std::string& material, const std::string& bodies, const std::string& field = "") {
  return fmt::format(R"(
[gravity]
method = "none"
{}
[contact]
stiffness = {}
[[material]]
name = "surface"
{}
[[stage]]
name = "only"
duration = 1e3
{}
)",
                     field, kStiffness, material, bodies);
}

/// A piston, 2 m above the zero, over a held ball of that height.
std::string piston(double load, double mass, double damping, const std::string& more = "") {
  return fmt::format(R"(
[[body]]
shape = "sphere"
density = 1000
held = {{}}
position = [0, 0, 1]
[[body]]
shape = "sphere"
density = 1000
position = [50, 0, 0]
walls = []
[[wall]]
kind = "plane"
normal = [0, 0, -1]
point = [0, 0, 2]
load = {}
load_mass = {}
load_damping = {}
{}
)",
                     load, mass, damping, more);
}

TEST(DrivenWalls, APistonOnASpringSwingsAsAnOscillator) {
  constexpr double load = 5000.0, mass = 300.0;
  Experiment e(scene("restitution_normal = 1\nfriction = 0", piston(load, mass, 0.0)));
  e.begin();
  const double omega = std::sqrt(kStiffness / mass), depth = load / kStiffness;
  double worst = 0.0, astray = 0.0;
  const DrivenWalls& wall = e.state.walls.driven;
  // It never parts from the ball: it begins at rest, just in touch.
  while (e.state.clock.time() < 10.0 * 2.0 * kPi / omega) {
    e.advance(1);
    const double t = e.state.clock.time();
    worst = std::max(worst, std::abs(wall.place[0] - depth * (1.0 - std::cos(omega * t))) / depth);
    const double kinetic = 0.5 * mass * wall.speed[0] * wall.speed[0];
    astray = std::max(astray, std::abs(kinetic + e.spring_energy() - load * wall.place[0]) / (load * depth));
  }
  report::error("piston of a held ball, undamped, ten periods: displacement, worst, over the mean depth",
                "(F/k) (1 - cos sqrt(k/m) t)", worst, 2e-2);
  report::error("the same: kinetic and elastic energy less the work of the load, worst, over that work",
                "none", astray, 2e-3);
}

TEST(DrivenWalls, ADampedPistonComesToRestAtLoadOverStiffness) {
  constexpr double load = 5000.0, mass = 300.0, damping = 4000.0;
  Experiment e(scene("restitution_normal = 1\nfriction = 0", piston(load, mass, damping)));
  e.begin();
  const DrivenWalls& wall = e.state.walls.driven;
  const double gamma = 0.5 * damping / mass, omega = std::sqrt(kStiffness / mass - gamma * gamma);
  double worst = 0.0;
  while (e.state.clock.time() < 3.0) {
    e.advance(1);
    const double t = e.state.clock.time(), depth = load / kStiffness;
    const double closed =
        depth * (1.0 - std::exp(-gamma * t) * (std::cos(omega * t) + gamma / omega * std::sin(omega * t)));
    worst = std::max(worst, std::abs(wall.place[0] - closed) / depth);
  }
  report::error("the same with drag: displacement, worst, over the depth at rest", "damped oscillator", worst,
                1e-2);
  report::close("the same: depth at rest (m)", "F/k", wall.place[0], load / kStiffness, 1e-6);
  report::close("the same: force on it at rest (N)", "load",
                -e.state.walls.loads.force[0].dot(Vec3(0, 0, -1)), load, 1e-6);
}

TEST(DrivenWalls, ABlowOfAPistonGivesTheRestitutionAskedFor) {
  // A free ball against a wall of its own mass: they exchange their velocities but for what is lost.
  Experiment e(scene("restitution_normal = 0.6\nfriction = 0", R"(
[[body]]
shape = "sphere"
density = 1000
position = [0, 0, 0.999]
velocity = [0, 0, 1]
[[wall]]
kind = "plane"
normal = [0, 0, -1]
point = [0, 0, 2]
load = 0
load_mass = 4188.790204786391
)"));
  e.begin();
  while (!e.touching()) e.advance(1);
  while (e.touching()) e.advance(1);
  const double ball = e.state.bodies.velocity[0].z(), wall = -e.state.walls.driven.speed[0];
  report::close("ball against a wall that moves freely: e", "asked for", wall - ball, 0.6, 5e-3);
  report::close("the same: momentum of both, over that of the ball", "conserved", wall + ball, 1.0, 1e-12);
  const double energy = e.kinetic_energy() + 0.5 * e.state.bodies.mass[0] * wall * wall;
  report::close("the same: energy of both and what is dissipated (J)", "conserved",
                energy + e.state.ledger.dissipated, 0.5 * e.state.bodies.mass[0], 1e-2);
}

// Grains between three fixed walls and three under a pressure: at rest every pair of walls bears the load.
TEST(DrivenWalls, AxesAreCompressedEachByItsLoad) {
  const Vec3 load(3000.0, 2000.0, 4000.0);
  std::string text = R"(
[[lattice]]
kind = "sc"
size = 0.5
density = 1000
random_orientation = true
shape = "tetrahedron"
region = { kind = "box", size = [4, 4, 4] }
)";
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 n = Vec3::Unit(axis);
    text += fmt::format("[[wall]]\nkind = 'plane'\nnormal = [{0}, {1}, {2}]\npoint = [{3}, {4}, {5}]\n",
                        n.x(), n.y(), n.z(), -3 * n.x(), -3 * n.y(), -3 * n.z());
    text += fmt::format(
        "[[wall]]\nkind = 'plane'\nnormal = [{0}, {1}, {2}]\npoint = [{3}, {4}, {5}]\nload = {6}\nload_mass "
        "= 2000\n"
        "load_damping = 4000\n",
        -n.x(), -n.y(), -n.z(), 3 * n.x(), 3 * n.y(), 3 * n.z(), load[axis]);
  }
  Experiment e(scene("restitution_normal = 0.1\nfriction = 0", text));
  e.begin();
  const WallLoads& loads = e.state.walls.loads;
  for (int k = 0; k < 60; ++k) {
    e.advance(1000);
    double off = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      off = std::max(off, std::abs(loads.force[2 * axis + 1][axis] / load[axis] - 1.0));
    if (off < 1e-7 && e.kinetic_energy() < 1e-12) break;
  }
  for (int axis = 0; axis < 3; ++axis) {
    report::close(
        fmt::format("triaxial compression of tetrahedra, axis {}: force on the fixed wall (N)", axis), "load",
        -loads.force[2 * axis][axis], load[axis], 1e-5);
    report::close(fmt::format("the same, axis {}: force on the wall under load (N)", axis), "load",
                  loads.force[2 * axis + 1][axis], load[axis], 1e-5);
    EXPECT_GT(e.state.walls.driven.place[2 * axis + 1], 0.5);
  }
}

TEST(DrivenWalls, ARestingPistonBearsTheSameInAResumedStage) {
  // The stage begins anew: place, speed and load go on.
  Experiment e(scene("restitution_normal = 0.5\nfriction = 0", piston(5000.0, 300.0, 100.0)));
  e.begin();
  e.advance(500);
  const DrivenWalls before = e.state.walls.driven;
  e.begin();
  EXPECT_EQ(e.state.walls.driven.place, before.place);
  EXPECT_EQ(e.state.walls.driven.speed, before.speed);
}

TEST(DrivenWalls, TheFallOfAPistonIsBorneByTheAutomaticStiffness) {
  // 5000 N over 0.5 m: the spring takes up F (h + x) at its depth x, aimed at without F x.
  std::string text = scene("restitution_normal = 1\nfriction = 0", piston(5000.0, 300.0, 0.0));
  const auto change = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  change(fmt::format("stiffness = {}", kStiffness), "max_overlap = 0.02");
  change("point = [0, 0, 2]", "point = [0, 0, 2.5]");
  Experiment e(text);
  e.begin();
  const double k = e.physics.k_n, aim = 0.02;
  EXPECT_NEAR(k, 2.0 * 2500.0 / (aim * aim), 1e-6 * k);
  e.advance(static_cast<std::uint64_t>(std::sqrt(2.0 * 0.5 * 300.0 / 5000.0) * 1.1 / e.physics.contacts.dt));
  const double x = (5000.0 + std::sqrt(5000.0 * 5000.0 + 2.0 * k * 2500.0)) / k;
  report::close("depth to which a piston falls under its load (m)", "F/k + sqrt((F/k)^2 + 2 F h / k)",
                e.state.ledger.largest_overlap, x, 2e-3);
  EXPECT_TRUE(warnings(e.physics, e.state.bodies, e.state.walls).empty());
  // Where the stiffness is given and too small, that is said.
  change("max_overlap = 0.02", "stiffness = 5e5");
  Experiment soft(text);
  soft.begin();
  const std::vector<std::string> said = warnings(soft.physics, soft.state.bodies, soft.state.walls);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("the load on wall 0 (plane, stage.toml:"), 0u) << said[0];
  EXPECT_NE(said[0].find("as the wall falls 0.5 m on the bodies"), std::string::npos) << said[0];
}

TEST(DrivenWalls, OneSoLightThatItShortensTheTimeStepIsNamed) {
  Experiment heavy(scene("", piston(1.0, 4000.0, 0.0))), light(scene("", piston(1.0, 1e-6, 0.0)));
  heavy.begin();
  light.begin();
  EXPECT_TRUE(lasting_warnings(heavy.physics).empty());
  const std::vector<std::string> said = lasting_warnings(light.physics);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].find("wall 0 (plane, stage.toml:"), 0u) << said[0];
  EXPECT_NE(said[0].find("its load_mass is 1e-06 kg"), std::string::npos) << said[0];
  EXPECT_NEAR(light.physics.contact_time, kPi * std::sqrt(1e-6 / kStiffness),
              1e-4 * light.physics.contact_time);
}

TEST(WallsThatTouch, OnlyThoseNamed) {
  Experiment e(scene("restitution_normal = 0.2", R"(
[[body]]
shape = "sphere"
density = 1000
position = [0, 0, 1]
[[body]]
shape = "sphere"
density = 1000
position = [5, 0, 1]
walls = []
[[body]]
shape = "sphere"
density = 1000
position = [10, 0, 1]
walls = ["shelf"]
[[body]]
shape = "sphere"
density = 1000
position = [15, 0, 1]
walls = ["1"]
[[wall]]
name = "shelf"
kind = "plane"
[[wall]]
kind = "plane"
point = [0, 0, -0.05]
[[wall]]
name = "shaken"
kind = "plane"
point = [0, 0, -9]
oscillation_amplitude = [0, 0, 0.01]
oscillation_frequency = 1
)",
                     "field = [0, 0, -10]"));
  e.begin();
  while (e.state.clock.time() < 4.0) e.advance(1);
  const auto height = [&](std::size_t b) { return e.state.bodies.position[b].z(); };
  const double sinks = e.state.bodies.mass[0] * 10.0 / kStiffness;
  EXPECT_NEAR(height(0), 1.0 - sinks, 1e-6);
  EXPECT_NEAR(height(1), 1.0 - 0.5 * 10.0 * std::pow(e.state.clock.time(), 2), 1e-6);
  EXPECT_NEAR(height(2), 1.0 - sinks, 1e-6);
  EXPECT_NEAR(height(3), 0.95 - sinks, 1e-6);
}

}  // namespace
}  // namespace cairn
