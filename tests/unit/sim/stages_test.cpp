// Walls, fields and gravity that act in some stages only, stages that end when quiet, and reports of stages.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/stiffness.h"
#include "core/error.h"
#include "folder.h"
#include "shape/library.h"
#include "sim/make_walls.h"
#include "sim/warnings.h"
#include "whole_run.h"

namespace cairn {
namespace {

Setup balls(const std::vector<Vec3>& places) {
  Setup setup;
  setup.shapes = {"sphere"};
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const Vec3& x : places) add_body(setup.bodies, ball, 0, 1.0, 2000.0, 0, {.position = x});
  return setup;
}

std::vector<StageReport> run(const std::string& text, Setup setup, const std::filesystem::path& path,
                             Operation operation = {}) {
  std::vector<StageReport> reports;
  Run run = new_run(text, std::move(setup), path, std::move(operation));
  EXPECT_EQ(run.advance({.report = [&](const StageReport& r) { reports.push_back(r); }}), RunEnd::finished);
  return reports;
}

constexpr const char* kFloor = R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
stages = ["rest"]
[gravity]
method = "none"
field = [0, 0, -1]
[contact]
stiffness = 1e7
[[stage]]
name = "rest"
duration = 10
[[stage]]
name = "fall"
duration = 2
[[stage]]
name = "float"
duration = 3
field = [0, 0, 0]
)";

TEST(Stages, AFloorThatIsNoLongerThereLetsTheBallFall) {
  const Folder folder;
  run(kFloor, balls({{0.0, 0.0, 1.01}}), folder / "run.h5");
  const ResultFile file = ResultFile::open(folder / "run.h5");
  const std::vector<double> time = file.read_series("time"), stage = file.read_series("stage"),
                            pz = file.read_series("momentum_z"), drift = file.read_series("momentum_drift");
  const double mass = 2000.0 * 4.0 / 3.0 * kPi;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (stage[k] == 0.0) {
      EXPECT_TRUE(std::isnan(drift[k]));
    } else {
      EXPECT_LT(drift[k], 1e-12);
    }
    const double fallen = std::clamp(time[k] - 10.0, 0.0, 2.0);
    if (time[k] > 9.0) {
      EXPECT_NEAR(pz[k], -mass * fallen, 1e-6 * mass) << time[k];
    }
  }
}

TEST(Stages, WithoutContactsBodiesPassThroughEachOtherAndWalls) {
  const Folder folder;
  cairn::Setup setup = balls({{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}});
  setup.bodies.velocity[0] = {10.0, 0.0, 0.0};
  run(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
point = [15, 0, 0]
normal = [-1, 0, 0]
[gravity]
method = "none"
[contact]
stiffness = 1e8
[[stage]]
name = "near"
duration = 1e-3
[[stage]]
name = "pass"
duration = 2
contacts = false
)",
      std::move(setup), folder / "run.h5");
  const ResultFile file = ResultFile::open(folder / "run.h5");
  std::vector<Vec3> x;
  file.read_snapshot(file.snapshots().size() - 1, {{"position", "", "", &x, "body"}});
  EXPECT_NEAR(x[0].x(), 20.01, 1e-9);
  EXPECT_EQ(x[1], Vec3(10.0, 0.0, 0.0));
  for (const double contacts : file.read_series("contacts")) EXPECT_EQ(contacts, 0.0);
}

TEST(Stages, SpringsThatAreForgottenCountAsDissipated) {
  const Folder folder;
  cairn::Setup setup = balls({{0.0, 0.0, 5.0}, {2.0, 0.0, 5.0}, {20.0, 0.0, 1.0}});
  setup.bodies.velocity[0] = {1.0, 0.3, 0.0};
  setup.bodies.velocity[2] = {0.3, 0.0, -0.5};
  run(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
stages = ["blow"]
[gravity]
method = "none"
[contact]
stiffness = 1e8
[[stage]]
name = "blow"
duration = 5e-3
[[stage]]
name = "no wall"
duration = 2e-3
[[stage]]
name = "pass"
duration = 1
contacts = false
)",
      std::move(setup), folder / "run.h5");
  const ResultFile file = ResultFile::open(folder / "run.h5");
  const std::vector<double> stage = file.read_series("stage"), moving = file.read_series("kinetic_energy"),
                            turning = file.read_series("rotational_energy"),
                            elastic = file.read_series("elastic_energy"),
                            dissipated = file.read_series("dissipated_work");
  int forgotten = 0;
  for (std::size_t k = 1; k < stage.size(); ++k) {
    if (stage[k] == stage[k - 1]) continue;
    ++forgotten;
    EXPECT_EQ(moving[k], moving[k - 1]);
    EXPECT_EQ(turning[k], turning[k - 1]);
    EXPECT_GT(elastic[k - 1] - elastic[k], 0.02 * moving[k]) << k;
    EXPECT_NEAR(elastic[k] + dissipated[k], elastic[k - 1] + dissipated[k - 1], 1e-12 * moving[k]) << k;
  }
  EXPECT_EQ(forgotten, 2);
  EXPECT_EQ(elastic.back(), 0.0);
}

TEST(Stages, AWallOfSomeStagesMovesFromTheStartOfTheFirst) {
  const Scene scene = parse_scene(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
point = [0, 0, -5]
[[wall]]
kind = "plane"
stages = ["b", "c"]
oscillation_amplitude = [0, 0, 1]
oscillation_frequency = 0.1
[[stage]]
name = "a"
duration = 1
[[stage]]
name = "b"
duration = 1
[[stage]]
name = "c"
duration = 1
)",
                                  "walls.toml", ".");
  const std::vector<Wall> all = make_walls(scene);
  const std::vector<double> starts{0.0, 9.5, 12.0};
  Walls walls;
  set_walls(scene, 0, all, starts, walls);
  EXPECT_EQ(walls.number, (std::vector<std::uint32_t>{0}));
  walls.contacts = {{3, 0, 0, {}}, {4, 1, 0, {}}};
  set_walls(scene, 2, all, starts, walls);
  EXPECT_EQ(walls.number, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(walls.contacts.size(), 2u);
  EXPECT_EQ(walls.walls[0].motion.since, 0.0);
  EXPECT_NEAR(walls.walls[1].motion.pose(12.0).shift.z(), 1.0, 1e-12);
  set_walls(scene, 0, all, starts, walls);
  ASSERT_EQ(walls.contacts.size(), 1u);
  EXPECT_EQ(walls.contacts[0].sphere, 3u);
}

TEST(Stages, NoMotionAboveAWallCountsAsRigid) {
  const Folder folder;
  const std::vector<StageReport> reports = run(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
[gravity]
method = "none"
field = [0, 0, -1]
[[stage]]
name = "fall"
duration = 3
)",
                                               [] {
                                                 cairn::Setup setup = balls({{0.0, 0.0, 50.0}});
                                                 setup.bodies.velocity[0] = {3.0, 0.0, 0.0};
                                                 return setup;
                                               }(),
                                               folder / "run.h5");
  EXPECT_NEAR(reports[0].speed, std::sqrt(3.0 * 3.0 + 3.0 * 3.0), 1e-9);
}

// Two balls press on each other and on the floor, a third one lies apart.
TEST(Stages, ContactsWithWallsCountWhereverContactsAreCounted) {
  const Folder folder;
  const std::vector<StageReport> reports =
      run(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
[gravity]
method = "none"
[contact]
stiffness = 1e7
[[stage]]
name = "look"
duration = 1e-5
)",
          balls({{0.0, 0.0, 0.99}, {1.995, 0.0, 0.99}, {9.0, 0.0, 0.99}}), folder / "run.h5");
  const StageReport& r = reports[0];
  EXPECT_NEAR(r.coordination, 5.0 / 3.0, 1e-15);
  EXPECT_NEAR(r.body_contacts, 5.0 / 3.0, 1e-15);
  EXPECT_NEAR(r.body_neighbours, 2.0 / 3.0, 1e-15);
  EXPECT_EQ(r.free_bodies, 0.0);
  EXPECT_EQ(r.hanging_bodies, 1.0);
  EXPECT_NEAR(r.overlap, 0.01, 1e-6);  // on the floor; of the two balls it is 0.005
  const ResultFile file = ResultFile::open(folder / "run.h5");
  EXPECT_EQ(file.read_series("contacts").back(), 4.0);
  EXPECT_NEAR(file.read_series("coordination").back(), 5.0 / 3.0, 1e-15);
  EXPECT_NEAR(file.read_series("largest_overlap").front(), 0.01, 1e-6);
  std::vector<std::uint16_t> touching;
  file.read_snapshot(1, {{"sphere_contacts", "", "", &touching, "sphere"}});
  EXPECT_EQ(touching, (std::vector<std::uint16_t>{2, 2, 1}));
}

TEST(Stages, EndWhenQuietAndSaySo) {
  const Folder folder;
  cairn::Setup setup = balls({{-5.0, 0.0, 0.0}, {5.0, 0.0, 0.0}});
  for (const double side : {0.0, 1.0}) {
    const auto b = static_cast<std::size_t>(side);
    setup.bodies.velocity[b] = {1.0 - 2.0 * side, 3.0, 0.0};
  }
  const std::vector<StageReport> reports = run(R"(
[[body]]
shape = "sphere"
density = 2000
[[material]]
name = "mud"
restitution_normal = 0
[gravity]
method = "direct"
[contact]
stiffness = 4e6
overlap_limit = 0.5
[[stage]]
name = "meet"
duration = 100
quiet_speed = 0.05
quiet_interval = 0.1
[[stage]]
name = "part"
duration = 5
[output]
series_interval = 0.1
)",
                                               std::move(setup), folder / "run.h5");
  // They meet at 1 m/s each after 4 s and hardly part; the common 3 m/s do not count. Not before a tenth of
  // 100 s.
  ASSERT_EQ(reports.size(), 2u);
  EXPECT_NEAR(reports[0].time, 10.0, 0.2);
  EXPECT_EQ(reports[0].what.substr(0, 11), "quiet after");
  EXPECT_LT(reports[0].speed, 0.05);
  EXPECT_EQ(reports[1].what, "the end of its duration");
  EXPECT_EQ(reports[0].bodies, 2.0);
  EXPECT_TRUE(std::isnan(reports[0].eta_inter));
  const ResultFile file = ResultFile::open(folder / "run.h5");
  StageColumns columns;
  file.read_static("stages", columns.table());
  EXPECT_EQ(columns.name, (std::vector<std::string>{"meet", "part"}));
}

TEST(Stages, ContactsThatBearNothingNewStayAsStiffAsTheyAre) {
  const std::string text = R"(
[[body]]
shape = "sphere"
density = 2000
[[stage]]
name = "settle"
duration = 10
impact_speed = 1e-6
[[stage]]
name = "wait"
duration = 10
[[stage]]
name = "blow"
duration = 10
impact_speed = 1e-2
[[stage]]
name = "fall"
duration = 10
field = [0, 0, -1]
)";
  const Scene scene = parse_scene(text, "run.toml", ".");
  Bodies bodies = balls({{0.0, 0.0, 0.0}, {0.0, 0.0, 1.999}}).bodies;
  const auto stiffness = [&](std::size_t stage, double held) {
    return resolve_stiffness(scene, stage, bodies, {}, held).k_n;
  };
  const double settled = stiffness(0, 0.0);
  EXPECT_EQ(stiffness(1, settled), settled);
  EXPECT_GT(stiffness(1, 0.0), 10.0 * settled);  // no contacts so far: they may meet at the escape speed
  EXPECT_GT(stiffness(2, settled), 10.0 * settled);
  EXPECT_GT(stiffness(3, settled), 10.0 * settled);
  bodies.velocity[0].x() = 3.0 * escape_speed(bodies);
  EXPECT_GT(stiffness(1, settled), 10.0 * settled);
}

// Two balls that rest on each other under their own gravity: overlap F / k.
TEST(Stages, TellWhatStifferContactsWillPushApart) {
  const double mass = 2000.0 * 4.0 / 3.0 * kPi, soft = 0.1, stiff = 20.0;
  double distance = 2.0;
  for (int k = 0; k < 20; ++k)
    distance = 2.0 - kGravitationalConstant * mass * mass / (distance * distance * soft);
  const double energy = kGravitationalConstant * mass * mass / distance, overlap = 2.0 - distance;
  const auto pushed = [&](double stiffness) {
    const Folder folder;
    cairn::Run pile = new_run(fmt::format(R"(
[[body]]
shape = "sphere"
density = 2000
[gravity]
method = "direct"
[[stage]]
name = "rest"
duration = 100
stiffness = {}
[[stage]]
name = "stiffen"
duration = 1
stiffness = {}
)",
                                          soft, stiffness),
                              balls({{0.0, 0.0, 0.0}, {0.0, 0.0, distance}}), folder / "run.h5");
    pile.advance({});
    return pile.start_energy().ratio();
  };
  EXPECT_NEAR(pushed(stiff), 0.5 * (stiff - soft) * overlap * overlap / energy, 1e-3 * pushed(stiff));
  EXPECT_LT(pushed(soft), 1e-9);
  EXPECT_EQ(pushed(0.5 * soft), 0.0);
}

// The same by a change of material, at one stiffness of the scene.
TEST(Stages, TellWhatAStifferMaterialWillPushApart) {
  const double mass = 2000.0 * 4.0 / 3.0 * kPi, soft = 0.1, stiff = 20.0,
               pair = 2.0 / (1.0 / soft + 1.0 / 0.4);
  double distance = 2.0;
  for (int k = 0; k < 20; ++k)
    distance = 2.0 - kGravitationalConstant * mass * mass / (distance * distance * pair);
  const double energy = kGravitationalConstant * mass * mass / distance, overlap = 2.0 - distance;
  const auto go_on = [&](const std::string& stages) {
    const Folder folder;
    cairn::Setup setup = balls({{0.0, 0.0, 0.0}, {0.0, 0.0, distance}});
    setup.bodies.material = {0, 1};
    cairn::Run pile = new_run(fmt::format(R"(
[[body]]
shape = "sphere"
density = 2000
material = "soft"
[[material]]
name = "soft"
stiffness = {}
[[material]]
name = "firm"
stiffness = 0.4
[[material]]
name = "stiff"
stiffness = {}
stiffness_ratio = 0.9
[gravity]
method = "direct"
[[stage]]
name = "rest"
duration = 100
{}
[[stage]]
name = "on"
duration = 1
)",
                                          soft, stiff, stages.substr(0, stages.find('|'))) +
                                  stages.substr(stages.find('|') + 1),
                              std::move(setup), folder / "run.h5",
                              [](const Scene&, std::size_t, State& state, std::vector<ContactRecord>&) {
                                state.bodies.material = {2, 2};
                                return std::string("assigned");
                              });
    pile.advance({});
    return pile.start_energy();
  };
  EXPECT_LT(go_on("|").ratio(), 1e-9);
  EXPECT_DOUBLE_EQ(go_on("|").stiffer, 1.0);
  const cairn::StartEnergy start = go_on("|material = 'stiff'\n");
  EXPECT_NEAR(start.ratio(), 0.5 * (stiff - pair) * overlap * overlap / energy, 1e-3 * start.ratio());
  EXPECT_NEAR(start.stiffer, stiff / pair, 1e-12 * start.stiffer);
  EXPECT_EQ(go_on("|material = 'soft'\n").ratio(), 0.0);
  // After an operation has assigned it, all that the contacts hold counts.
  const cairn::StartEnergy assigned = go_on(
      "[[stage]]\nname = 'assign'\nassign = { region = { kind = 'ball', radius = 9 }, material = 'stiff' }|");
  EXPECT_NEAR(assigned.ratio(), 0.5 * stiff * overlap * overlap / energy, 1e-3 * assigned.ratio());
}

/// Of a sphere put into a wall, where no bodies touch each other.
TEST(Stages, EnergyHeldOnAWallAtTheStartIsTold) {
  const Folder folder;
  auto pile = new_run(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
point = [0, 0, -5]
[[wall]]
kind = "plane"
[contact]
stiffness = 1e8
[gravity]
method = "direct"
[[stage]]
name = "a"
duration = 0.01
)",
                      balls({{0, 0, 0.94}, {8, 0, 9}}), folder / "run.h5");
  pile.advance({});
  EXPECT_TRUE(pile.start_energy().counts());
  EXPECT_EQ(pile.start_energy().wall, 1u);
  EXPECT_NEAR(pile.start_energy().overlap, 0.06, 1e-12);
}

TEST(Stages, MaterialsThatAllHaveTheirStiffnessNeedNoOther) {
  const std::string text = R"(
[[material]]
name = "a"
stiffness = 3e6
[[material]]
name = "b"
stiffness = 2e6
[[material]]
name = "idle"
[[body]]
shape = "sphere"
density = 2000
material = "a"
[[stage]]
name = "one"
duration = 10
[[stage]]
name = "two"
duration = 10
material = "idle"
[gravity]
method = "none"
)";
  Bodies bodies = balls({{0.0, 0.0, 0.0}, {0.0, 0.0, 3.0}}).bodies;
  const Scene scene = parse_scene(text, "run.toml", ".");
  EXPECT_EQ(resolve_stiffness(scene, 0, bodies, {}, 0.0).k_n, 3e6);
  bodies.material[1] = 1;
  EXPECT_EQ(resolve_stiffness(scene, 0, bodies, {}, 0.0).k_n, 2e6);
  EXPECT_THROW(resolve_stiffness(scene, 1, bodies, {}, 0.0), InputError);  // nothing loads the contacts
  bodies.material[1] = 2;
  EXPECT_THROW(resolve_stiffness(scene, 0, bodies, {}, 0.0), InputError);
  // The floor is of none of its own.
  const Scene floor = parse_scene(text + "[[wall]]\nkind = 'plane'\nmaterial = 'idle'\n", "run.toml", ".");
  bodies.material = {0, 0};
  EXPECT_THROW(resolve_stiffness(floor, 0, bodies, walls_of_stage(floor, 0, make_walls(floor), {}), 0.0),
               InputError);
}

TEST(Stages, WarnOfOverlapsOfTheSoftestPairThatThereIs) {
  const auto said = [](const std::string& partner, std::vector<std::uint16_t> materials) {
    const Scene scene = parse_scene(fmt::format(R"(
[[material]]
name = "hard"
stiffness = 1e8
[[material]]
name = "soft"
stiffness = 1e2
[[body]]
shape = "sphere"
density = 2000
material = "hard"
[[stage]]
name = "blow"
duration = 10
[gravity]
method = "none"
{})",
                                                partner),
                                    "run.toml", ".");
    Bodies bodies = balls({{0.0, 0.0, 2.0}, {0.0, 0.0, 5.0}}).bodies;
    bodies.material = std::move(materials);
    bodies.velocity[0].x() = 0.1;
    const Walls walls = walls_of_stage(scene, 0, make_walls(scene), {});
    const Physics physics =
        resolve_physics(scene, 0, bodies, resolve_stiffness(scene, 0, bodies, walls, 0.0).k_n);
    for (const std::string& line : warnings(physics, bodies, walls))
      if (line.find("would overlap") != line.npos) return true;
    return false;
  };
  EXPECT_FALSE(said("", {0, 0}));
  EXPECT_TRUE(said("", {0, 1}));
  EXPECT_TRUE(said("[[wall]]\nkind = 'plane'\nmaterial = 'soft'\n", {0, 0}));
}

TEST(Stages, CohesionIsComparedWithTheStiffnessOfItsPair) {
  const auto error = [](const std::string& glue, double shared) {
    const Scene scene = parse_scene(fmt::format(R"(
[[material]]
name = "glue"
cohesion = 1e4
{}
[[material]]
name = "dry"
[[body]]
shape = "sphere"
density = 2000
material = "glue"
[[stage]]
name = "hang"
duration = 10
[gravity]
method = "none"
)",
                                                glue),
                                    "run.toml", ".");
    try {
      resolve_physics(scene, 0, balls({{0.0, 0.0, 0.0}, {0.0, 0.0, 2.0}}).bodies, shared);
    } catch (const InputError& caught) {
      return std::string(caught.what());
    }
    return std::string();
  };
  // 1e4 Pa times (2 beta R)^2 = 0.25 m^2 is 2500 N: 1e4 N/m give 0.25 m.
  EXPECT_EQ(error("", 1e4),
            "run.toml:12:1: key 'stage[0]': stage 'hang': cohesion presses spheres together by 0.25 of their "
            "radius, overlap_limit is 0.1; a "
            "contact.stiffness of at least 2.5e+04 N/m is needed");
  EXPECT_EQ(
      error("stiffness = 1e4", 1e6),
      "run.toml:12:1: key 'stage[0]': stage 'hang': cohesion presses spheres together by 0.25 of their "
      "radius, overlap_limit is 0.1; a "
      "stiffness of the contacts, contact.stiffness or material.stiffness, of at least 2.5 times what they "
      "have is needed");
  EXPECT_EQ(error("stiffness = 1e6", 1e4), "");
}

TEST(Stages, RigidRotationIsNoAgitation) {
  const Folder folder;
  cairn::Setup setup = balls({{-5.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {0.0, 7.0, 1.0}});
  const Vec3 spin(0.1, 0.2, -0.3), drift(4.0, 5.0, 6.0);
  for (std::size_t b = 0; b < 3; ++b) {
    setup.bodies.velocity[b] = drift + spin.cross(setup.bodies.position[b]);
    setup.bodies.spin[b] = setup.bodies.inertia[b].cwiseProduct(spin);
  }
  run("[[body]]\nshape = 'sphere'\ndensity = 2000\n[gravity]\nmethod = 'none'\n[contact]\nstiffness = 1e6\n"
      "[[stage]]\nname = 's'\nduration = 0.01\ntime_step = 0.01\n",
      std::move(setup), folder / "run.h5");
  const ResultFile file = ResultFile::open(folder / "run.h5");
  const double kinetic = file.read_series("kinetic_energy")[0];
  EXPECT_GT(kinetic, 1e5);
  EXPECT_LT(std::abs(file.read_series("agitation")[0]), 1e-9 * kinetic);
}

TEST(Stages, AnOperationChangesTheBodiesOfLaterSnapshots) {
  const Folder folder;
  const Operation heavier = [](const Scene&, std::size_t, State& state, std::vector<ContactRecord>&) {
    state.bodies.mass[0] *= 2.0;
    return std::string("doubled");
  };
  const auto reports = run(R"(
[[body]]
shape = "sphere"
density = 2000
[gravity]
method = "none"
[contact]
stiffness = 4e6
overlap_limit = 0.5
[[stage]]
name = "fly"
duration = 0.1
[[stage]]
name = "change"
scale = { density = 1, volume = 1 }
[[stage]]
name = "on"
duration = 0.1
)",
                           balls({{0.0, 0.0, 0.0}, {9.0, 0.0, 0.0}}), folder / "run.h5", heavier);
  ASSERT_EQ(reports.size(), 3u);
  EXPECT_EQ(reports[1].what, "doubled");
  EXPECT_NEAR(reports[1].mass / reports[0].mass, 1.5, 1e-12);
  const ResultFile file = ResultFile::open(folder / "run.h5");
  std::vector<std::uint64_t> epochs;
  for (const SnapshotInfo& s : file.snapshots()) epochs.push_back(s.epoch);
  EXPECT_EQ(epochs, (std::vector<std::uint64_t>{0, 0, 1, 1}));
  EXPECT_EQ(file.constants("bodies", 0), "bodies_0");
  EXPECT_EQ(file.constants("bodies", 1), "bodies");
  std::vector<double> before, after;
  file.read_static("bodies_0", {{"mass", "", "", &before}});
  file.read_static("bodies", {{"mass", "", "", &after}});
  EXPECT_EQ(after[0], 2.0 * before[0]);
  EXPECT_EQ(after[1], before[1]);
}

/// Velocity of a rod that has struck the floor and turned under the blow: its effective mass at the contact
/// is soon another than at first touch.
Vec3 after_the_blow(const std::string& stages, const std::filesystem::path& path) {
  const std::string text = R"(
[[body]]
shape = "rod4"
density = 2000
[[wall]]
kind = "plane"
[gravity]
method = "none"
[contact]
stiffness = 4e6
overlap_limit = 0.5
time_step = 0.0005
unsafe_time_step = true
)" + stages;
  Setup setup;
  setup.shapes = {"rod4"};
  const RigidShape rod = make_rigid(load_shape("rod4", "."), MassModel::union_volume);
  add_body(setup.bodies, rod, 0, 1.0, 2000.0, 0,
           {.position = {0.0, 0.0, 3.5},
            .orientation = Quat(Eigen::AngleAxisd(0.9, Vec3::UnitY())),
            .velocity = {0.0, 0.0, -2.0}});
  Run run = new_run(text, std::move(setup), path);
  EXPECT_EQ(run.advance({}), RunEnd::finished);
  EXPECT_TRUE(run.state().walls.contacts.empty());
  return run.state().bodies.velocity[0];
}

TEST(Stages, ABlowThatSpansTwoOfTheSameSettingsIsOneBlow) {
  const Folder folder;
  const Vec3 one = after_the_blow("[[stage]]\nname = 'one'\nduration = 1\n", folder / "one.h5");
  EXPECT_GT(one.z(), -1.5);
  for (const double first : {0.2, 0.25, 0.3, 0.35, 0.4}) {
    const Vec3 two =
        after_the_blow(fmt::format("[[stage]]\nname = 'one'\nduration = {}\n[[stage]]\nname = 'two'\n"
                                   "duration = {:.17g}\n",
                                   first, 1.0 - first),
                       folder / fmt::format("{}.h5", first));
    // With masses of the time of the change 6e-3 m/s; what is left: its dashpots see the velocities of then.
    EXPECT_LT((two - one).norm(), 1e-7 * one.norm()) << first;
  }
}

/// The error or, if there is none, the warnings of a scene with balls at these places.
std::string said_of(const std::string& text, const std::vector<Vec3>& places) {
  const Folder folder;
  try {
    Run run = new_run(text, balls(places), folder / "run.h5");
    std::string all;
    for (const std::string& line : run.warnings()) all += line + "\n";
    run.advance({});
    return all;
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

constexpr const char* kTwoWalls = R"([[body]]
shape = "sphere"
density = 2000
[[wall]]
kind = "plane"
stages = ["later"]
point = [0, 0, -9]
[[wall]]
name = "drum"
kind = "cylinder"
radius = 4
angular_velocity = [0, 0, {}]
[gravity]
method = "none"
[contact]
stiffness = 1e6
[[stage]]
name = "now"
duration = {}
[[stage]]
name = "later"
duration = 0.1
)";

TEST(Stages, MessagesNameWallsAndWhereTheyStand) {
  const auto scene = [](double spin, double duration) {
    return fmt::format(fmt::runtime(kTwoWalls), spin, duration);
  };
  EXPECT_NE(said_of(scene(1e4, 0.1), {{0, 0, 0}}).find("wall 'drum' (cylinder, run.toml:8) turns by"),
            std::string::npos);
  EXPECT_EQ(
      said_of(scene(0.0, 0.1), {{3.2, 0, 0}}),
      "run.toml:17:1: key 'stage[0]': sphere 0 of body 0 and wall 'drum' (cylinder, run.toml:8) overlap at "
      "the start by 0.2 of the smaller radius; contact.overlap_limit is 0.1");
}

TEST(Stages, ErrorsTellTheStageAndItsKey) {
  const std::string text = R"([[body]]
shape = "sphere"
density = 2000
[gravity]
method = "none"
[[stage]]
name = "a"
duration = 1
)";
  EXPECT_EQ(
      said_of(text, {{0, 0, 0}, {9, 0, 0}}),
      "run.toml:6:1: key 'stage[0]': stage 'a': nothing loads the contacts, so no stiffness can be chosen; "
      "expected contact.stiffness or an impact_speed");
  EXPECT_EQ(
      said_of(text + "stiffness = 1e3\ntime_step = 1e-16\n", {{0, 0, 0}, {9, 0, 0}}),
      "run.toml:8:12: key 'stage[0].duration': stage 'a': 1e+16 steps of 1e-16 s are more than a run can "
      "make");
}

TEST(Stages, AWallUnderALoadThatIsLeftOutStaysAndComesBackAtRest) {
  const Folder folder;
  run(R"(
[[body]]
shape = "sphere"
density = 2000
[[wall]]
name = "lid"
kind = "plane"
normal = [0, 0, -1]
point = [0, 0, 90]
load = 30
load_mass = 10
stages = ["press", "again"]
[gravity]
method = "none"
[contact]
stiffness = 1e4
[[stage]]
name = "press"
duration = 2
[[stage]]
name = "wait"
duration = 5
[[stage]]
name = "again"
duration = 1
)",
      balls({{0, 0, 0}, {9, 0, 0}}), folder / "run.h5");
  const ResultFile file = ResultFile::open(folder / "run.h5");
  const std::vector<double> stage = file.read_series("stage"),
                            place = file.read_series("wall_lid_displacement"),
                            speed = file.read_series("wall_lid_speed");
  for (std::size_t k = 1; k < stage.size(); ++k) {
    if (stage[k] == 1.0) {
      EXPECT_EQ(speed[k], 0.0);
    }
    if (stage[k] != stage[k - 1]) {
      EXPECT_EQ(speed[k], 0.0);
    }
    if (stage[k] == 1.0) {
      EXPECT_NEAR(place[k], 0.5 * 3.0 * 4.0, 1e-9);
    }
  }
  EXPECT_NEAR(place.back(), 0.5 * 3.0 * (4.0 + 1.0), 1e-9);
  EXPECT_NEAR(speed.back(), 3.0, 1e-9);
}

}  // namespace
}  // namespace cairn
