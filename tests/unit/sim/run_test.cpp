// A run on a floor, stopped and resumed again and again, against one that was not.
#include "sim/run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "folder.h"
#include "shape/library.h"
#include "sim/fields.h"
#include "whole_run.h"

namespace cairn {
namespace {

/// The second stage is stiffer, by another factor on the wall than between bodies, and has another material,
/// so that springs and dashpots change in between.
constexpr const char* kScene = R"(
[[body]]
shape = "sphere"
density = 2000
material = "rock"
[[wall]]
kind = "plane"
material = "rock"
[[material]]
name = "rock"
cohesion = 100
stiffness_ratio = 0.4
[[material]]
name = "sand"
friction = 0.3
stiffness = 2e7
[gravity]
method = "none"
field = [0.2, 0, -1]
[[stage]]
name = "fall"
duration = 5
time_step = 1e-4
stiffness = 1e7
[[stage]]
name = "slide"
duration = 4
time_step = 1e-4
stiffness = 3e7
material = "sand"
[output]
series_interval = 0.05
snapshot_interval = 1
)";

/// Runs to the end; with `stops` it is interrupted at every opportunity. @return how often that was.
int fall(const std::filesystem::path& path, bool stops) {
  const OneThread one;
  Setup setup;
  setup.shapes = {"sphere", "cube"};
  for (std::uint32_t shape = 0; shape < 2; ++shape)
    add_body(setup.bodies, make_rigid(load_shape(setup.shapes[shape], "."), MassModel::union_volume), shape,
             1.0, 2000.0, 0,
             {.position = {3.2 * shape, 0.3 * shape, 1.0 + shape},
              .velocity = {0.3, 0.2, 0.0},
              .angular_velocity = {0.2, 0.1, 0.3}});
  return run_to_end(new_run(kScene, std::move(setup), path), {.watch = [&](const Run&) { return !stops; }});
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(Run, StoppedAndResumedOnAFloorGivesTheSameBits) {
  const Folder folder;
  EXPECT_EQ(fall(folder / "whole.h5", false), 0);
  EXPECT_GT(fall(folder / "pieces.h5", true), 0);
  const ResultFile whole = ResultFile::open(folder / "whole.h5"),
                   pieces = ResultFile::open(folder / "pieces.h5");
  EXPECT_GE(whole.series_columns().size(), series_columns().size() + 12u);  // loads of a wall at least
  for (const SeriesColumn& column : whole.series_columns())
    EXPECT_TRUE(same_bits(whole.read_series(column.name), pieces.read_series(column.name))) << column.name;
  State a, b;
  ContactColumns contacts_a, contacts_b;
  WallColumns walls_a, walls_b;
  whole.read_checkpoint(checkpoint_fields(a, contacts_a.table(), walls_a));
  pieces.read_checkpoint(checkpoint_fields(b, contacts_b.table(), walls_b));
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_EQ(a.bodies.spin, b.bodies.spin);
  EXPECT_GE(walls_a.memory.slide.size(), 3u);  // both bodies are on the floor
  EXPECT_EQ(walls_a.memory.slide, walls_b.memory.slide);
  EXPECT_EQ(walls_a.memory.roll, walls_b.memory.roll);
  EXPECT_NE(a.walls.loads.force.at(0), Vec3::Zero());
  EXPECT_EQ(a.walls.loads.force, b.walls.loads.force);
  EXPECT_EQ(whole.snapshots().size(), pieces.snapshots().size());
}

/// A tumbling body past a mass; with `stop` it is interrupted once. @return the steps.
std::uint64_t fly(const std::filesystem::path& path, bool stop) {
  const OneThread one;
  Setup setup;
  setup.shapes = {"l_shape"};
  add_body(setup.bodies, make_rigid(load_shape("l_shape", "."), MassModel::union_volume), 0, 1.0, 2000.0, 0,
           {.position = {0, 1, 0}, .angular_velocity = {0.2, 0.1, 0.3}});
  std::optional<Run> run(new_run(R"(
[[body]]
shape = "l_shape"
density = 2000
[[perturber]]
name = "P"
gm = 1e-3
radius = 1
position = [30, 0, 0]
[gravity]
method = "none"
[[stage]]
name = "fly"
duration = 2000
)",
                                 std::move(setup), path));
  const auto going = [](const Run& r) { return r.state().clock.step < 1000; };
  if (stop) {
    EXPECT_EQ(run->advance({.watch = going}), RunEnd::interrupted);
    run.reset();  // the file takes one writer at a time
    run.emplace(Run::resume(path));
  }
  EXPECT_EQ(run->advance({}), RunEnd::finished);
  EXPECT_FALSE(run->physics().can_touch);
  return run->state().clock.total_steps;
}

// The time step of free flight follows from the spins at the start of the stage, which then change.
TEST(Run, ATumblingBodyStoppedAndResumedKeepsItsTimeStep) {
  const Folder folder;
  EXPECT_EQ(fly(folder / "whole.h5", false), fly(folder / "pieces.h5", true));
  const ResultFile whole = ResultFile::open(folder / "whole.h5"),
                   pieces = ResultFile::open(folder / "pieces.h5");
  for (const SeriesColumn& column : series_columns())
    EXPECT_TRUE(same_bits(whole.read_series(column.name), pieces.read_series(column.name))) << column.name;
}

TEST(Run, WritesRowsAndSnapshotsAtTheirIntervalsAndAtTheEndsOfStages) {
  const Folder folder;
  fall(folder / "run.h5", false);
  const ResultFile file = ResultFile::open(folder / "run.h5");
  EXPECT_TRUE(file.finished());
  const std::vector<double> time = file.read_series("time"), stage = file.read_series("stage");
  ASSERT_EQ(time.size(), 101u + 81u);  // each stage also has a row at its start
  for (std::size_t k = 0; k < time.size(); ++k) {
    EXPECT_NEAR(time[k], k < 101 ? 0.05 * k : 5.0 + 0.05 * (k - 101), 1e-9);
    EXPECT_EQ(stage[k], k < 101 ? 0.0 : 1.0);
  }
  ASSERT_EQ(file.snapshots().size(), 1u + 5u + 4u);
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_NEAR(file.snapshots()[k].time, static_cast<double>(k), 1e-9);
    EXPECT_EQ(file.snapshots()[k].stage, k < 6 ? "fall" : "slide");
  }
  // Energy (J) in: the field's work on the bodies on their way. Energy out: what the contacts have lost.
  const auto kinetic = file.read_series("kinetic_energy"), rotational = file.read_series("rotational_energy"),
             lost = file.read_series("dissipated_work"), elastic = file.read_series("elastic_energy");
  std::vector<Vec3> first, last;
  Bodies bodies;
  std::vector<std::string> shapes;
  read_constants(file, bodies, shapes);
  file.read_snapshot(0, {{"position", "", "", &first, "body"}});
  file.read_snapshot(5, {{"position", "", "", &last, "body"}});
  double work = 0.0;
  for (std::size_t b = 0; b < 2; ++b) work += bodies.mass[b] * (last[b] - first[b]).dot(Vec3(0.2, 0.0, -1.0));
  const auto total = [&](std::size_t k) { return kinetic[k] + rotational[k] + elastic[k] + lost[k]; };
  EXPECT_GT(lost[100], 0.3 * work);
  EXPECT_NEAR(total(100) - total(0), work, 0.01 * work);
}

/// Four balls in a tetrahedron that nothing holds together, spun until they have flown apart far enough.
void spin_apart(const std::filesystem::path& path, const std::string& on_failure) {
  const OneThread one;
  Setup setup;
  setup.shapes = {"sphere"};
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const Vec3& x :
       {Vec3(1.2, 0.0, 0.0), Vec3(-0.6, 1.05, 0.0), Vec3(-0.6, -1.05, 0.0), Vec3(0.0, 0.0, 1.7)})
    add_body(setup.bodies, ball, 0, 1.0, 2000.0, 0, {.position = x});
  Run run = new_run(fmt::format(R"(
[[body]]
shape = "sphere"
density = 2000
[gravity]
method = "none"
[contact]
stiffness = 1e6
[[stage]]
name = "spin"
duration = 100
time_step = 5e-3
[stage.spin]
path = [[0, 20]]
axis_drop = 0.3
axis_hold = 0
check_interval = 0.1
remnant_gap = 1e6
after_failure = 2
on_failure = "{}"
[output]
series_interval = 0.1
remnant_gap = 1e6
)",
                                on_failure),
                    std::move(setup), path);
  EXPECT_EQ(run.advance({}), RunEnd::finished);
}

TEST(Run, EndsAWhileAfterThePileHasFailed) {
  for (const std::string on_failure : {"release", "keep"}) {
    const Folder folder;
    spin_apart(folder / "spin.h5", on_failure);
    const ResultFile file = ResultFile::open(folder / "spin.h5");
    const auto time = file.read_series("time"), active = file.read_series("control_active"),
               ratio = file.read_series("c_over_a"), period = file.read_series("period");
    std::size_t row = 1;
    while (row < ratio.size() && ratio[row] >= 0.7 * ratio[0]) ++row;
    ASSERT_LT(row, ratio.size());
    EXPECT_GT(row, 10u);
    EXPECT_EQ(active[row - 1], 1.0);
    EXPECT_NEAR(time.back(), time[row] + 2.0, 0.11);
    EXPECT_EQ(active.back(), on_failure == "keep" ? 1.0 : 0.0);
    if (on_failure == "keep") {
      EXPECT_NEAR(period.back(), 20.0, 1e-9);
    } else {
      EXPECT_GT(period.back(), 20.1);
    }
    // At the start, at failure and at the end; the last two tell that the pile has failed.
    ASSERT_EQ(file.snapshots().size(), 3u);
    EXPECT_EQ(file.snapshots()[1].time, time[row]);
    for (std::size_t k = 0; k < 3; ++k) {
      bool failed = false;
      file.read_snapshot(k, {{"failed", "", "", &failed}});
      EXPECT_EQ(failed, k > 0);
    }
    Control control;
    file.read_checkpoint({{"control/failure_time", "", "", &control.failure_time},
                          {"control/failure_period", "", "", &control.failure_period}});
    EXPECT_EQ(control.failure_time, time[row]);
    EXPECT_EQ(control.failure_period, 20.0);
  }
}

/// Two glued balls that slide on each other while both fly on; two stages of one stiffness.
void glued_flight(const std::filesystem::path& path) {
  const OneThread one;
  Setup setup;
  setup.shapes = {"sphere"};
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const double side : {-1.0, 1.0})
    add_body(setup.bodies, ball, 0, 1.0, 2000.0, 0,
             {.position = {10.0 + 0.999 * side, 0.0, 0.0}, .velocity = {0.0, 0.5 + 1e-3 * side, 0.0}});
  Run run = new_run(R"(
[[body]]
shape = "sphere"
density = 2000
[[material]]
name = "glue"
cohesion = 8e3
[gravity]
method = "none"
[contact]
stiffness = 1e6
[[stage]]
name = "one"
duration = 0.1
[[stage]]
name = "two"
duration = 0.1
[output]
series_interval = 0.1
)",
                    std::move(setup), path);
  EXPECT_EQ(run.advance({}), RunEnd::finished);
}

TEST(Run, SpringsOutliveTheStage) {
  const Folder folder;
  glued_flight(folder / "glue.h5");
  const ResultFile file = ResultFile::open(folder / "glue.h5");
  const std::vector<double> elastic = file.read_series("elastic_energy");
  ASSERT_EQ(elastic.size(), 4u);
  EXPECT_GT(elastic[1], elastic[0] + 1e-6);  // the tangential spring has been drawn
  EXPECT_NEAR(elastic[2], elastic[1], 1e-9 * std::abs(elastic[1]));
  for (double drift : file.read_series("angular_momentum_drift")) EXPECT_LT(drift, 1e-12);
  std::vector<std::uint16_t> touching;
  file.read_snapshot(2, {{"sphere_contacts", "", "", &touching, "sphere"}});
  EXPECT_EQ(touching, (std::vector<std::uint16_t>{1, 1}));
}

TEST(Run, ThatBreaksOffTellsItsSteps) {
  const Folder folder;
  cairn::Setup setup;
  setup.shapes = {"sphere"};
  add_body(setup.bodies, make_rigid(load_shape("sphere", "."), MassModel::union_volume), 0, 1.0, 2000.0, 0,
           {.position = {0, 0, 9}, .velocity = {0, 0, -20}});
  cairn::Run run = new_run(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
[gravity]
method = "none"
[contact]
stiffness = 1e5
[[stage]]
name = "fall"
duration = 10
)",
                           std::move(setup), folder / "run.h5");
  EXPECT_THROW(run.advance({}), UnstableError);
  const ResultFile file = ResultFile::open(folder / "run.h5");
  Clock checkpoint;
  file.read_checkpoint({{"clock/total_steps", "", "", &checkpoint.total_steps}});
  EXPECT_EQ(checkpoint.total_steps, 0u);
  EXPECT_GT(run.state().clock.total_steps, 10u);
  EXPECT_EQ(reached(file, checkpoint).steps, run.state().clock.total_steps);
  EXPECT_EQ(reached(file, checkpoint).time, run.state().clock.time());
}

}  // namespace
}  // namespace cairn
