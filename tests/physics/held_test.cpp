// Held bodies against closed forms, and what they give to others against the energy of these.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "physics/experiment.h"
#include "physics/report.h"

namespace cairn {
namespace {

std::string scene(const std::string& material, const std::string& bodies, const std::string& field = "") {
  return fmt::format(R"(
[gravity]
method = "none"
{}
[contact]
stiffness = 1e8
[[material]]
name = "surface"
{}
[[stage]]
name = "only"
duration = 1e3
{}
)",
                     field, material, bodies);
}

const char* const kSmooth = "friction = 0\nfriction_rolling = 0\nfriction_twisting = 0\n";

TEST(Held, ABlowOnAHeldBodyGivesTheRestitutionAskedForAndItsWork) {
  constexpr double speed = 0.1, asked = 0.55;
  constexpr int phases = 8;
  for (const char* shape : {"sphere", "dumbbell"})
    for (const bool heavy : {false, true}) {
      double worst = 0.0, astray = 0.0;
      for (int phase = 0; phase < phases; ++phase) {
        Experiment e(
            scene(std::string(kSmooth) + "restitution_normal = 0.55\n",
                  fmt::format("[[body]]\nshape = '{}'\ndensity = {}\nheld = {{ velocity = [0, 0, {}] }}\n"
                              "[[body]]\nshape = 'sphere'\ndensity = 1000\nposition = [0, 0, 3]\n",
                              shape, heavy ? 1e6 : 1.0, speed)));
        e.begin();
        // Above one of its spheres, which the ball will meet.
        Bodies& bodies = e.state.bodies;
        const double apart = bodies.spheres.radius[0] + 1.0;
        bodies.position[1] = bodies.spheres.position[0];
        bodies.position[1].z() += apart + speed * e.physics.contacts.dt * (1.0 + (phase + 0.5) / phases);
        e.begin();
        while (!e.touching()) e.advance(1);
        while (e.touching()) e.advance(1);
        const double left = e.state.bodies.velocity[1].z();
        worst = std::max(worst, std::abs(left / (speed * (1.0 + asked)) - 1.0));
        const Ledger& ledger = e.state.ledger;
        astray = std::max(
            astray, std::abs(ledger.wall_work - e.kinetic_energy() - ledger.dissipated) / ledger.wall_work);
        EXPECT_EQ(e.state.bodies.velocity[0], Vec3(0, 0, speed));
        EXPECT_EQ(e.state.bodies.position[0], e.state.clock.time() * Vec3(0, 0, speed));
      }
      const std::string name = fmt::format("ball at rest struck by a held {} of {} density, e = 0.55", shape,
                                           heavy ? "great" : "small");
      report::error(name + ": its speed, worst of 8 phases, relative", "(1 + e) V", worst, 5e-3);
      report::error(name + ": what of the work is neither kinetic energy nor dissipated, relative",
                    "energy gained and lost", astray, 2e-3);
    }
}

/// A slope of held balls, with a kink between each and the next.
const char* const kBumps = R"(
[[lattice]]
kind = "sc"
size = 0.5
density = 7000
spacing = 0.8
held = {}
[lattice.region]
kind = "box"
size = [12, 6, 0.6]
orientation = [0.99, 0, 0.1, 0]
[[body]]
shape = "tetrahedron"
size = 0.7
density = 1000
position = [-4, 0.1, 2.8]
[[body]]
shape = "sphere"
size = 0.6
density = 1000
position = [-4, -2, 2.5]
)";

double field_energy(const Experiment& e) {
  double energy = 0.0;
  for (std::size_t b = 0; b < e.state.bodies.size(); ++b)
    if (!is_held(e.state.bodies, b))
      energy -= e.state.bodies.mass[b] * e.physics.field.dot(e.state.bodies.position[b]);
  return energy;
}

TEST(Held, GrainsGoDownABumpyFloorWithoutLoss) {
  Experiment e(scene("restitution_normal = 1\nfriction = 0\nfriction_rolling = 0\nfriction_twisting = 0\n",
                     kBumps, "field = [0, 0, -10]"));
  e.begin();
  const double start = e.kinetic_energy() + e.spring_energy() + field_energy(e);
  double blows = 0.0, most = 0.0;
  bool before = false;
  while (e.state.clock.time() < 0.9) {
    e.advance(1);
    blows += e.touching() && !before;
    before = e.touching();
    most = std::max(most, e.kinetic_energy());
  }
  EXPECT_GT(blows, 2.0);
  report::error(
      "grains that fall down a slope of held balls, e = 1: energy lost, over the greatest kinetic one",
      "none", std::abs(e.kinetic_energy() + e.spring_energy() + field_energy(e) - start) / most, 2e-3);
  EXPECT_EQ(e.state.ledger.wall_work, 0.0);
}

TEST(Held, WhatMovingBodiesGiveIsInTheLedger) {
  // A mixer: a bar that turns about its end and swings, among rough balls, above a shaken floor of balls.
  Experiment e(scene("friction = 0.5\nrestitution_normal = 0.5\n", R"(
[[lattice]]
kind = "sc"
size = 0.5
density = 1000
held = { oscillation_amplitude = [0, 0, 0.05], oscillation_frequency = 3 }
[lattice.region]
kind = "box"
size = [7, 7, 0.5]
[[body]]
shape = "rod4"
size = 0.4
density = 1000
position = [0, 0, 1.6]
held = { angular_velocity = [0, 0, 3], rotation_point = [-0.6, 0, 1.6], velocity = [0.1, 0, 0] }
[[lattice]]
kind = "sc"
size = 0.3
density = 1000
spacing = 1.2
region = { kind = "box", size = [5, 5, 3], position = [0, 0, 3.5] }
)",
                     "field = [0, 0, -10]"));
  e.begin();
  const double start = e.kinetic_energy() + e.spring_energy() + field_energy(e);
  double work = 0.0, last = 0.0;
  while (e.state.clock.time() < 1.2) {
    e.advance(1);
    work += std::abs(e.state.ledger.wall_work - last);
    last = e.state.ledger.wall_work;
  }
  const double now = e.kinetic_energy() + e.spring_energy() + field_energy(e);
  report::error(
      "rough balls stirred by a held bar over a shaken held floor: energy not in the ledger, over all work",
      "none", std::abs(now - start - e.state.ledger.wall_work + e.state.ledger.dissipated) / work, 5e-3);
  EXPECT_GT(work, 10.0);
}

TEST(Held, TheirPosesAreExactFunctionsOfTime) {
  Experiment e(scene("", R"(
[[body]]
shape = "rod4"
density = 1000
position = [1, 2, 3]
orientation = [1, 0.2, 0, 0]
held = { angular_velocity = [0, 2, 1], rotation_point = [0, 1, 0], velocity = [0.3, 0, -0.2], oscillation_amplitude = [0.1, 0, 0], oscillation_frequency = 2, oscillation_phase = 0.4 }
[[body]]
shape = "sphere"
density = 1000
position = [50, 0, 0]
)"));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  const Quat q0 = bodies.orientation[0];
  e.advance(20000);
  const double t = e.state.clock.time(), angle = 4.0 * kPi * t + 0.4;
  const Vec3 w(0, 2, 1), pivot = Vec3(0, 1, 0) + t * Vec3(0.3, 0, -0.2) + std::sin(angle) * Vec3(0.1, 0, 0);
  const Mat3 turn = Eigen::AngleAxisd(w.norm() * t, w.normalized()).toRotationMatrix();
  const Vec3 x = pivot + turn * (Vec3(1, 2, 3) - Vec3(0, 1, 0));
  EXPECT_LT((bodies.position[0] - x).norm(), 1e-12);
  EXPECT_LT((bodies.orientation[0].toRotationMatrix() - turn * q0.toRotationMatrix()).norm(), 1e-12);
  EXPECT_LT((angular_velocity(bodies, 0) - w).norm(), 1e-12);
  const Vec3 v = Vec3(0.3, 0, -0.2) + 4.0 * kPi * std::cos(angle) * Vec3(0.1, 0, 0) + w.cross(x - pivot);
  EXPECT_LT((bodies.velocity[0] - v).norm(), 1e-11);
  EXPECT_EQ(bodies.position[1], Vec3(50, 0, 0));
}

TEST(Held, GravityOfAHeldBodyPullsAndNothingPullsIt) {
  Experiment e(R"(
[[body]]
shape = "sphere"
size = 50
density = 3000
held = {}
[[body]]
shape = "sphere"
density = 3000
position = [200, 0, 0]
velocity = [0, 0.02, 0]
[gravity]
method = "direct"
[[stage]]
name = "orbit"
duration = 1e5
)");
  const double gm = kGravitationalConstant * e.state.bodies.mass[0];
  e.state.bodies.velocity[1].y() = std::sqrt(gm / 200.0);
  e.scene.contact.time_step = 10.0;
  e.scene.contact.unsafe_time_step = true;
  e.scene.contact.stiffness = 1e6;
  e.begin();
  double away = 0.0;
  while (e.state.clock.time() < 4e4) {
    e.advance(1);
    away = std::max(away, std::abs(e.state.bodies.position[1].norm() / 200.0 - 1.0));
  }
  EXPECT_EQ(e.state.bodies.position[0], Vec3::Zero());
  report::error("circular orbit about a held ball: radius, greatest error, relative", "circle", away, 1e-4);
}

TEST(Held, AreTheSameForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  std::vector<Vec3> places[2];
  double work[2];
  for (const int k : {0, 1}) {
    omp_set_num_threads(1 + 2 * k);
    Experiment e(scene("friction = 0.5\n", R"(
[[lattice]]
kind = "sc"
size = 0.5
density = 1000
held = { oscillation_amplitude = [0, 0, 0.05], oscillation_frequency = 3, velocity = [0.1, 0, 0] }
region = { kind = "box", size = [22, 22, 0.5] }
[[lattice]]
kind = "sc"
size = 0.5
density = 1000
spacing = 1.001
random_orientation = true
region = { kind = "box", size = [20, 20, 1.5], position = [0.3, 0.2, 0.95] }
)",
                       "field = [0, 0, -10]"));
    e.begin();
    e.advance(1500);
    places[k] = e.state.bodies.position;
    work[k] = e.state.ledger.wall_work;
  }
  omp_set_num_threads(threads);
  EXPECT_EQ(places[0], places[1]);
  EXPECT_EQ(work[0], work[1]);
  EXPECT_NE(work[0], 0.0);
}

}  // namespace
}  // namespace cairn
