// Held bodies, walls under a load and walls that touch only some bodies, in runs that stop and go on.
#include "sim/restraints.h"

#include <gtest/gtest.h>

#include <cstring>

#include "core/error.h"
#include "folder.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "sim/fields.h"
#include "whole_run.h"

namespace cairn {
namespace {

/// Grains on a floor of held balls that swings and turns, under a lid; a ball that only the lid touches hangs
/// in between, another one falls through all.
constexpr const char* kScene = R"(
[[lattice]]
kind = "sc"
size = 0.5
density = 2000
held = { oscillation_amplitude = [0, 0, 0.02], oscillation_frequency = 2, angular_velocity = [0, 0, 0.5] }
region = { kind = "box", size = [5, 5, 0.5] }
[[body]]
shape = "cube"
density = 2000
size = 0.5
position = [0, 0, 1.6]
orientation = [0.9, 0.2, 0.1, 0.3]
[[body]]
shape = "sphere"
density = 2000
size = 0.5
position = [1.5, 0.3, 1.4]
walls = ["lid"]
[[body]]
shape = "sphere"
density = 2000
position = [30, 0, 1]
walls = []
)";
constexpr const char* kRest = R"(
[[wall]]
name = "lid"
kind = "plane"
normal = [0, 0, -1]
point = [0, 0, 3.4]
load = 3000
load_mass = 900
load_damping = 50
[[wall]]
kind = "plane"
point = [0, 0, -3]
[contact]
stiffness = 1e6
overlap_limit = 0.5
[gravity]
method = "none"
field = [0.2, 0.05, -1.95]
[output]
series_interval = 0.1
)";
/// Dashpots are made anew for a pile: here there are none.
constexpr const char* kElastic =
    "[[material]]\nname = 'elastic'\nrestitution_normal = 1\nrestitution_tangential = 1\n";
constexpr const char* kFirst = "[[stage]]\nname = 'fall'\nduration = 2\n";
constexpr const char* kSecond = "[[stage]]\nname = 'on'\nduration = 1\n";

class Restraints : public testing::Test {
 protected:
  /// Runs to the end; with `stops` it is interrupted every so many steps. Returns how often that was.
  int run_to_end(const std::string& text, const std::string& name, bool stops = false) const {
    const Scene scene = parse_scene(text, "scene.toml", folder_.path());
    const auto watch = [&](const cairn::Run& r) { return !stops || r.state().clock.total_steps % 47 != 46; };
    return cairn::run_to_end(new_run(scene, assemble(scene), folder_ / name, operate),
                             {.watch = watch, .watch_interval = 0.0}, operate);
  }

  State end_of(const std::string& name) const {
    const ResultFile file = ResultFile::open(folder_ / name);
    State state;
    ContactColumns contacts;
    WallColumns walls;
    std::vector<std::string> shapes, sets;
    read_constants(file, state.bodies, shapes);
    read_restraints(file, state.bodies, state.held, sets);
    file.read_checkpoint(checkpoint_fields(state, contacts.table(), walls));
    return state;
  }

  const OneThread one_;
  Folder folder_;
};

TEST_F(Restraints, AStoppedRunGivesTheSameBits) {
  const std::string text = std::string(kScene) + kRest + kFirst + kSecond;
  EXPECT_EQ(run_to_end(text, "whole.h5"), 0);
  EXPECT_GT(run_to_end(text, "pieces.h5", true), 2);
  const ResultFile whole = ResultFile::open(folder_ / "whole.h5"),
                   pieces = ResultFile::open(folder_ / "pieces.h5");
  for (const SeriesColumn& column : whole.series_columns()) {
    const std::vector<double> a = whole.read_series(column.name), b = pieces.read_series(column.name);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0) << column.name;
  }
  const State a = end_of("whole.h5"), b = end_of("pieces.h5");
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_EQ(a.bodies.velocity, b.bodies.velocity);
  EXPECT_EQ(a.walls.driven.place, b.walls.driven.place);
  EXPECT_GT(a.walls.driven.place[0], 0.5);
  EXPECT_EQ(whole.read_series("wall_lid_displacement").back(), a.walls.driven.place[0]);
  EXPECT_GT(std::abs(whole.read_series("wall_work").back()), 10.0);
  // 25 held; the last body has fallen through the floor that carries none.
  EXPECT_EQ(std::count(a.bodies.held.begin(), a.bodies.held.end(), 1), 25);
  const std::size_t last = a.bodies.size() - 1;
  EXPECT_NEAR(a.bodies.position[last].z(), 1.0 - 0.5 * 1.95 * 9.0, 1e-9);
  EXPECT_LE(whole.read_series("fragments").front(), 3.0);  // held ones are of none
}

TEST_F(Restraints, APileKeepsThem) {
  const std::string rest = std::string(kElastic) + kRest;
  run_to_end(kScene + rest + kFirst, "first.h5");
  run_to_end("pile = 'first.h5'\n" + rest + kSecond, "second.h5");
  run_to_end(kScene + rest + kFirst + kSecond, "one.h5");
  const State part = end_of("second.h5"), whole = end_of("one.h5");
  ASSERT_EQ(part.bodies.size(), whole.bodies.size());
  EXPECT_EQ(part.bodies.held, whole.bodies.held);
  EXPECT_EQ(part.bodies.wall_set, whole.bodies.wall_set);
  for (std::size_t b = 0; b < whole.bodies.size(); ++b)
    EXPECT_LT((part.bodies.position[b] - whole.bodies.position[b]).norm(), 1e-9) << b;
  EXPECT_NEAR(part.walls.driven.place[0], whole.walls.driven.place[0], 1e-9);
  EXPECT_NEAR(part.walls.driven.speed[0], whole.walls.driven.speed[0], 1e-7);
}

TEST_F(Restraints, HeldBodiesCanBeCarved) {
  const std::string carve =  // the ball that falls, from the mass centre of what moves
      "[[stage]]\nname = 'cut'\n"
      "carve = { region = { kind = 'ball', radius = 6, position = [15.7, 0, -2] }, outside = true }\n";
  run_to_end(std::string(kScene) + kRest + kFirst + carve + kSecond, "cut.h5");
  const State end = end_of("cut.h5");
  EXPECT_EQ(end.bodies.size(), 27u);
  EXPECT_EQ(end.bodies.held.size(), end.bodies.size());
}

/// A ball between a held one and a floor, pressed into both.
constexpr const char* kPressed = R"(
[[body]]
shape = "sphere"
density = 2000
held = {}
[[body]]
shape = "sphere"
density = 2000
position = [0, 0, -1.94]
[[wall]]
kind = "plane"
point = [0, 0, -2.9]
[contact]
stiffness = 1e6
[gravity]
method = "none"
[[stage]]
name = "relax"
duration = 20
relax = {}
)";

TEST_F(Restraints, WhatIsPressedIntoHeldBodiesAndWallsRelaxes) {
  EXPECT_EQ(run_to_end(kPressed, "whole.h5"), 0);
  EXPECT_GE(run_to_end(kPressed, "pieces.h5", true), 2);
  const State a = end_of("whole.h5"), b = end_of("pieces.h5");
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_NEAR(a.bodies.position[1].z(), -1.95, 1e-3);  // where both press alike
  EXPECT_EQ(a.bodies.position[0], Vec3::Zero());
  const ResultFile file = ResultFile::open(folder_ / "whole.h5");
  const double held = file.read_series("elastic_energy").front();
  EXPECT_NEAR(held, 0.5e6 * (0.06 * 0.06 + 0.04 * 0.04), 1e-6 * held);
  const auto last = [&](const char* column) { return file.read_series(column).back(); };
  EXPECT_NEAR(
      last("elastic_energy") + last("kinetic_energy") + last("dissipated_work") + last("relaxed_work"), held,
      5e-3 * held);
  EXPECT_LT(last("kinetic_energy"), 1e-3 * held);
}

TEST_F(Restraints, AStageIsNotQuietWhileAWallFalls) {
  run_to_end(R"(
[[body]]
shape = "sphere"
density = 2000
position = [0, 0, 0.99]
[[wall]]
kind = "plane"
[[wall]]
kind = "plane"
normal = [0, 0, -1]
point = [0, 0, 4]
load = 1000
load_mass = 1000
load_damping = 2000
[contact]
stiffness = 1e6
[gravity]
method = "none"
[[stage]]
name = "press"
duration = 30
quiet_speed = 1e-3
)",
             "press.h5");
  const State end = end_of("press.h5");
  EXPECT_GT(end.walls.driven.place[1], 2.0);  // it has come down
  EXPECT_LT(end.clock.time(), 29.0);
}

TEST_F(Restraints, WorkOfAChangeOfStiffnessIsTold) {
  const std::string scene = R"(
[[body]]
shape = "sphere"
density = 2000
position = [0, 0, 0.97]
[[body]]
shape = "sphere"
density = 2000
position = [0, 0, 2.95]
[[wall]]
kind = "plane"
[[material]]
name = "elastic"
restitution_normal = 1
restitution_tangential = 1
[contact]
stiffness = 1e6
steps_per_contact = 400
[gravity]
method = "none"
field = [0, 0, -1]
[output]
series_interval = 0.002
[[stage]]
name = "soft"
duration = 0.2
[[stage]]
name = "hard"
duration = 0.2
stiffness = 3e6
)";
  run_to_end(scene, "two.h5");
  const ResultFile file = ResultFile::open(folder_ / "two.h5");
  std::vector<double> sum(file.read_series("time").size(), 0.0);
  for (const char* column : {"kinetic_energy", "elastic_energy", "field_energy", "dissipated_work"}) {
    const std::vector<double> values = file.read_series(column);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[k];
  }
  const std::vector<double> given = file.read_series("stage_work"),
                            elastic = file.read_series("elastic_energy");
  EXPECT_EQ(given.front(), 0.0);
  EXPECT_GT(given.back(), 0.1 * elastic.front());
  for (std::size_t k = 0; k < sum.size(); ++k)
    EXPECT_NEAR(sum[k] - given[k], sum[0], 2e-3 * elastic.front()) << k;
}

TEST_F(Restraints, APileWhoseBodiesNameAWallThatIsNotHereIsSaid) {
  const std::string rest = std::string(kElastic) + kRest;
  run_to_end(kScene + rest + kFirst, "first.h5");
  std::string renamed = rest;
  renamed.replace(renamed.find("\"lid\""), 5, "\"top\"");
  Scene scene = parse_scene("pile = 'first.h5'\n" + renamed + kSecond, "s.toml", folder_.path());
  const std::vector<std::string> warnings = assemble(scene).warnings;
  EXPECT_TRUE(std::ranges::any_of(
      warnings, [](const std::string& w) { return w.find("touch a wall 'lid'") != w.npos; }));
}

TEST_F(Restraints, ReportsTellTheMassOfHeldBodiesAndScalingLeavesIt) {
  const std::string text = R"(
[[body]]
shape = "sphere"
density = 3000
held = {}
[[body]]
shape = "sphere"
density = 1000
position = [0, 0, 9]
[[body]]
shape = "sphere"
density = 1000
position = [0, 0, 11]
[gravity]
method = "none"
[[stage]]
name = "cut"
carve = { region = { kind = "ball", radius = 20 } }
[[stage]]
name = "denser"
)";
  const Scene scene = parse_scene(text + "scale = { density = 1 }\n", "scene.toml", folder_.path());
  std::vector<StageReport> reports;
  new_run(scene, assemble(scene), folder_ / "run.h5", operate).advance({.report = [&](const StageReport& r) {
    reports.push_back(r);
  }});
  ASSERT_EQ(reports.size(), 2u);
  const double ball = 4.0 / 3.0 * kPi, region = 8000.0 * ball;
  EXPECT_NEAR(reports[0].mass, 5000.0 * ball, 1e-9 * reports[0].mass);
  EXPECT_NEAR(reports[0].bulk_density, 5.0 / 8.0, 1e-12);
  EXPECT_NE(describe(reports[0]).find("3 of 3 spheres, 20944 kg, 1 of them held, 12566 kg"),
            std::string::npos)
      << describe(reports[0]);
  EXPECT_NEAR(reports[1].bulk_density, 1.0, 1e-12);  // of all; the held one is as it was
  const State end = end_of("run.h5");
  EXPECT_NEAR(end.bodies.mass[0], 3000.0 * ball, 1e-9);
  EXPECT_NEAR(end.bodies.mass[1], 0.5 * (region - 3000.0 * ball), 1e-9 * region);
  try {
    const Scene less = parse_scene(text + "scale = { density = 0.3 }\n", "scene.toml", folder_.path());
    new_run(less, assemble(less), folder_ / "run.h5", operate).advance({});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("scene.toml:21:9: key 'stage[1].scale': held bodies alone have"),
              0u)
        << error.what();
  }
}

TEST_F(Restraints, ScenesThatCannotBeAreRefused) {
  const auto error_of = [&](const std::string& text) -> std::string {
    try {
      assemble(parse_scene(text, "s.toml", "."));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string one = "[[body]]\nshape = 'sphere'\ndensity = 1000\nheld = {}\n",
                    two = one + "[[body]]\nshape = 'sphere'\ndensity = 1000\nposition = [9, 0, 0]\n",
                    stage = "[[stage]]\nname = 'a'\nduration = 1\n";
  EXPECT_EQ(error_of(two + stage), "no error");
  EXPECT_EQ(error_of(one + stage),
            "s.toml:4:8: key 'body[0].held': all bodies are held; expected one that moves");
  EXPECT_NE(error_of(two + stage + "spin.path = [[0, 100]]\n").find("a pile with held bodies cannot be spun"),
            std::string::npos);
}

}  // namespace
}  // namespace cairn
