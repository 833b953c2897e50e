// Stages that relax: energy is taken out of the motion inside a pile and booked, momenta stay.
#include "sim/relax.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/budget.h"
#include "core/error.h"
#include "core/random.h"
#include "folder.h"
#include "shape/library.h"
#include "sim/fields.h"
#include "stage.h"
#include "whole_run.h"

namespace cairn {
namespace {

std::string scene(const std::string& material, const std::string& relax) {
  return fmt::format(R"(
[[body]]
shape = "sphere"
density = 2000
[[material]]
name = "m"
{}
[gravity]
method = "direct"
[contact]
stiffness = 1e6
overlap_limit = 0.5
[[stage]]
name = "relax"
duration = 100
relax = {{ {} }}
)",
                     material, relax);
}

const std::string kElastic =
    "restitution_normal = 1\nfriction = 0\nfriction_rolling = 0\nfriction_twisting = 0";

void add_balls(Bodies& bodies, const std::vector<Vec3>& places, const Vec3& velocity = Vec3::Zero()) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const Vec3& x : places)
    add_body(bodies, ball, 0, 1.0, 2000.0, 0, {.position = x, .velocity = velocity});
}

/// Kinetic, elastic and gravitational energy, and what has been lost (J).
double whole_energy(Stage& s) {
  return s.kinetic_energy() + s.spring_energy() + gravitational_energy(s.physics, s.state, s.scratch) +
         s.state.ledger.dissipated + s.state.ledger.relaxed;
}

// Two elastic balls pushed into each other: x'' = -w^2 x - g x' for the overlap x while they touch.
TEST(Relax, TwoBallsAreADampedOscillator) {
  Stage s(scene(kElastic, "rate = 10"));
  s.scene.gravity.method = GravityMethod::none;
  s.scene.contact.steps_per_contact = 2000;
  add_balls(s.state.bodies, {{0.0, 0.0, 0.0}, {1.9, 0.0, 0.0}}, {3.0, 0.0, 0.0});
  s.begin();
  const double w = std::sqrt(2.0 * 1e6 / s.state.bodies.mass[0]), g = 10.0, x0 = 0.1;
  const double start = whole_energy(s), decay = 0.5 * g, ring = std::sqrt(w * w - decay * decay);
  s.advance(static_cast<std::uint64_t>(0.4 * kPi / ring / s.physics.contacts.dt));
  const double t = s.state.clock.time(),
               overlap = 2.0 - (s.state.bodies.position[1] - s.state.bodies.position[0]).x();
  const double expected =
      x0 * std::exp(-decay * t) * (std::cos(ring * t) + decay / ring * std::sin(ring * t));
  EXPECT_NEAR(overlap / expected, 1.0, 1e-3);
  EXPECT_GT(s.state.ledger.relaxed, 0.1 * 0.5 * 1e6 * x0 * x0);
  EXPECT_NEAR(whole_energy(s) / start, 1.0, 1e-6);
  EXPECT_NEAR((s.state.bodies.velocity[0] + s.state.bodies.velocity[1]).x(), 6.0, 1e-12);
}

/// Balls and dumbbells of a lattice with overlaps, in motion and spinning.
void add_lattice(Bodies& bodies, double spacing, const Vec3& centre, const Vec3& velocity) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume),
                   bell = make_rigid(load_shape("dumbbell", "."), MassModel::union_volume);
  Random random(5, 0);
  const Vec3 spin(1e-5, 5e-5, -2e-5);  // a fraction of the critical rate
  int count = 0;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k, ++count) {
        const Vec3 x = spacing * Vec3(i, j, k);
        const bool round = count % 5 != 0;
        add_body(bodies, round ? ball : bell, round ? 0 : 1, round ? 1.0 : 0.5, 2000.0, 0,
                 {.position = centre + x,
                  .orientation = random.rotation(),
                  .velocity = velocity + spin.cross(x) + 1e-5 * random.in_ball(),
                  .angular_velocity = spin + 1e-5 * random.in_ball()});
      }
}

TEST(Relax, MomentaStayAndTheLedgerCloses) {
  Stage s(scene("restitution_normal = 0.5", ""));
  s.scene.contact.stiffness = 300.0;  // what the overlaps hold is some ten times the gravitational energy
  add_lattice(s.state.bodies, 1.95, {5.0, -3.0, 2.0}, {0.004, 0.005, -0.006});
  s.begin();
  const Budget before = budget(s.state.bodies);
  const double start = whole_energy(s), elastic = s.spring_energy();
  std::uint64_t steps = 0;
  bool done = false;
  for (; !done && steps < 200'000; ++steps) {
    s.advance(1);
    done = relaxed(s.physics, s.state, s.scratch);
  }
  EXPECT_TRUE(done);
  const Budget after = budget(s.state.bodies);
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * before.momentum_scale);
  EXPECT_LT((after.angular_momentum_about_center - before.angular_momentum_about_center).norm(),
            1e-12 * before.angular_scale_about_center);
  EXPECT_GT(s.state.ledger.relaxed, 0.2 * elastic);
  EXPECT_NEAR(whole_energy(s), start, 5e-3 * elastic);
  EXPECT_LT(s.spring_energy(), 1e-3 * elastic);
}

// Each pile has a rigid motion of its own: two that fly towards each other are not held up.
TEST(Relax, PilesThatDoNotTouchKeepTheirSpeeds) {
  Stage s(scene(kElastic, ""));
  s.scene.gravity.method = GravityMethod::none;
  add_balls(s.state.bodies, {{-50.0, 0.0, 0.0}, {-50.0, 1.9, 0.0}}, {1.0, 0.0, 0.0});
  add_balls(s.state.bodies, {{50.0, 0.0, 0.0}, {50.0, 1.9, 0.0}}, {-1.0, 0.0, 0.0});
  add_balls(s.state.bodies, {{0.0, 40.0, 0.0}}, {0.0, 0.0, 7.0});
  s.begin();
  s.advance(2000);
  const auto& v = s.state.bodies.velocity;
  for (std::size_t b = 0; b < 5; ++b) EXPECT_NEAR(v[b].x(), b < 2 ? 1.0 : b < 4 ? -1.0 : 0.0, 1e-13);
  EXPECT_EQ(v[4], Vec3(0.0, 0.0, 7.0));
  EXPECT_GT(s.state.ledger.relaxed, 1.0);
}

constexpr const char* kRun = R"(
[[body]]
shape = "sphere"
density = 2000
[[material]]
name = "m"
restitution_normal = 0.5
[gravity]
method = "direct"
interval = 10
[contact]
stiffness = 300
[[stage]]
name = "relax"
duration = 30000
relax = {}
[[stage]]
name = "rest"
duration = 20
[output]
series_interval = 20
)";

/// Runs to the end, interrupted in every ten thousandth step if it `stops`. @return how often that was.
int relax(const std::filesystem::path& path, bool stops) {
  Setup setup;
  setup.shapes = {"sphere", "dumbbell"};
  add_lattice(setup.bodies, 1.95, Vec3::Zero(), Vec3::Zero());
  std::vector<std::string> ends;
  const int count =
      run_to_end(new_run(kRun, std::move(setup), path),
                 {.watch = [&](const Run& r) { return !stops || r.state().clock.step % 10000 != 500; },
                  .report = [&](const StageReport& r) { ends.push_back(r.what); },
                  .watch_interval = 0.0});
  EXPECT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends.at(0).find("relaxed after "), 0u) << ends[0];
  return count;
}

TEST(Relax, StoppedAndResumedGivesTheSameBits) {
  const Folder folder;
  EXPECT_EQ(relax(folder / "whole.h5", false), 0);
  EXPECT_GT(relax(folder / "pieces.h5", true), 1);
  const ResultFile whole = ResultFile::open(folder / "whole.h5"),
                   pieces = ResultFile::open(folder / "pieces.h5");
  for (const char* column : {"relaxed_work", "kinetic_energy", "elastic_energy", "time"})
    EXPECT_EQ(whole.read_series(column), pieces.read_series(column)) << column;
  State a, b;
  ContactColumns contacts_a, contacts_b;
  WallColumns walls_a, walls_b;
  whole.read_checkpoint(checkpoint_fields(a, contacts_a.table(), walls_a));
  pieces.read_checkpoint(checkpoint_fields(b, contacts_b.table(), walls_b));
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_EQ(a.bodies.velocity, b.bodies.velocity);
  EXPECT_EQ(a.bodies.spin, b.bodies.spin);
  EXPECT_EQ(a.ledger.relaxed, b.ledger.relaxed);
  EXPECT_GT(a.ledger.relaxed, 0.0);
}

/// The ratio that the second stage of two balls begins with.
StartEnergy energy_of_second_stage(const std::string& stages, double distance, const Operation& operation) {
  const Folder folder;
  Setup setup;
  setup.shapes = {"sphere"};
  add_balls(setup.bodies, {{0.0, 0.0, 0.0}, {distance, 0.0, 0.0}});
  Run run = new_run(R"(
[[body]]
shape = "sphere"
density = 2000
[gravity]
method = "direct"
[contact]
stiffness = 0.1
)" + stages,
                    std::move(setup), folder / "run.h5", operation);
  run.advance({});
  return run.start_energy();
}

/// Distance at which two balls rest on each other at a stiffness of 0.1 N/m.
double resting_distance() {
  const double mass = 2000.0 * 4.0 / 3.0 * kPi;
  double distance = 2.0;
  for (int k = 0; k < 20; ++k)
    distance = 2.0 - kGravitationalConstant * mass * mass / (distance * distance * 0.1);
  return distance;
}

TEST(StartEnergy, IsAllOfItForBodiesPutTogetherAnew) {
  const double distance = 1.99, mass = 2000.0 * 4.0 / 3.0 * kPi;
  const StartEnergy start = energy_of_second_stage("[[stage]]\nname = 'only'\nduration = 1\n", distance, {});
  EXPECT_NEAR(start.ratio(), 0.5 * 0.1 * 1e-4 / (kGravitationalConstant * mass * mass / distance),
              1e-9 * start.ratio());
  EXPECT_EQ(start.deepest.i, 0u);
  EXPECT_EQ(start.deepest.j, 1u);
  EXPECT_NEAR(start.overlap, 0.01, 1e-12);
}

TEST(StartEnergy, OfAPileThatGoesOnIsNothingUntilItIsScaled) {
  const std::string rest = "[[stage]]\nname = 'rest'\nduration = 100\n",
                    on = "[[stage]]\nname = 'on'\nduration = 1\n";
  EXPECT_LT(energy_of_second_stage(rest + on, resting_distance(), {}).ratio(), 1e-9);
  // A hundredth of the masses: a ten thousandth of the gravitational energy.
  const Operation lighter = [](const Scene&, std::size_t, State& state, std::vector<ContactRecord>&) {
    for (std::size_t b = 0; b < 2; ++b) {
      state.bodies.mass[b] *= 0.01;
      state.bodies.inertia[b] *= 0.01;
      state.bodies.spheres.mass[b] *= 0.01;
    }
    return std::string("lighter");
  };
  const StartEnergy start =
      energy_of_second_stage(rest + "[[stage]]\nname = 'scale'\nscale = { density = 20, volume = 8 }\n" + on,
                             resting_distance(), lighter);
  const double mass = 20.0 * 4.0 / 3.0 * kPi, overlap = 2.0 - resting_distance();
  EXPECT_NEAR(start.ratio(),
              0.5 * 0.1 * overlap * overlap / (kGravitationalConstant * mass * mass / resting_distance()),
              1e-3 * start.ratio());
  EXPECT_TRUE(start.counts());
}

}  // namespace
}  // namespace cairn
