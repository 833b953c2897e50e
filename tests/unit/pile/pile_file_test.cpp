// Runs that start from the end of others, against runs that went on.
#include "pile/pile_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "folder.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "sim/fields.h"
#include "whole_run.h"

namespace cairn {
namespace {

/// A cube and a ball come to rest on a floor that is not level.
constexpr const char* kBodies = R"(
[[body]]
shape = "cube"
density = 2000
material = "rock"
position = [0, 0, 2.2]
orientation = [0.9, 0.2, 0.1, 0.3]
[[body]]
shape = "sphere"
density = 2000
material = "rock"
position = [4, 0.3, 1.1]
)";
constexpr const char* kRest = R"(
[[material]]
name = "rock"
restitution_normal = 0.2
[contact]
stiffness = 1e6
[gravity]
method = "none"
field = [0.2, 0.05, -0.95]
)";
constexpr const char* kFloor = "[[wall]]\nkind = 'plane'\nmaterial = 'rock'\n";
constexpr const char* kFirst = "[[stage]]\nname = 'fall'\nduration = 20\n";
constexpr const char* kSecond = "[[stage]]\nname = 'on'\nduration = 3\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

class PileFile : public testing::Test {
 protected:
  Scene scene(const std::string& text) const { return parse_scene(text, "scene.toml", folder_.path()); }

  /// The setup of a scene, which has also been run into a file.
  cairn::Setup run(const std::string& text, const std::string& name) const {
    const OneThread one;
    const Scene start = scene(text);
    cairn::Setup setup = assemble(start);
    EXPECT_EQ(new_run(start, setup, folder_ / name, operate).advance({}), RunEnd::finished);
    return setup;
  }

  static std::string pile(const std::string& text) { return "pile = 'first.h5'\n" + text; }

  std::vector<double> series(const std::string& name, const std::string& column) const {
    return ResultFile::open(folder_ / name).read_series(column);
  }

  State end_of(const std::string& name) const {
    State state;
    ContactColumns contacts;
    WallColumns walls;
    ResultFile::open(folder_ / name).read_checkpoint(checkpoint_fields(state, contacts.table(), walls));
    return state;
  }

  /// Energy (J) in all springs at the end of the first run and at the start of the second.
  void expect_springs_kept(double tolerance) const {
    const double before = series("first.h5", "elastic_energy").back(),
                 after = series("second.h5", "elastic_energy").front();
    EXPECT_GT(before, 0.0);
    EXPECT_NEAR(after, before, tolerance * before);
  }

  /// How far (m) bodies are apart at the ends of two runs, at most.
  double apart(const std::string& a, const std::string& b) const {
    const State s = end_of(a), t = end_of(b);
    double most = 0.0;
    const auto place_of = [](const State& of, std::size_t k) -> Vec3 {
      return of.bodies.position[k] + of.frame.position + of.clock.time() * of.frame.velocity;
    };
    for (std::size_t k = 0; k < s.bodies.position.size(); ++k)
      most = std::max(most, (place_of(s, k) - place_of(t, k)).norm());
    return most;
  }

  Folder folder_;
};

TEST_F(PileFile, SpringsOnWallsGoOnAsInOneRun) {
  folder_.write("floor.off", "OFF\n4 1 0\n-30 -30 0\n30 -30 0\n30 30 0\n-30 30 0\n4 0 1 2 3\n");
  const std::string mesh = "[[wall]]\nkind = 'mesh'\nfile = 'floor.off'\nmaterial = 'rock'\n";
  for (const std::string& floor : {std::string(kFloor), mesh}) {
    run(kBodies + floor + kRest + kFirst, "first.h5");
    const cairn::Setup setup = run(pile(floor + kRest + kSecond), "second.h5");
    run(kBodies + floor + kRest + kFirst + kSecond, "one.h5");
    EXPECT_GE(setup.wall_contacts.size(), 3u);
    EXPECT_TRUE(setup.warnings.empty()) << setup.warnings[0];
    expect_springs_kept(1e-12);
    EXPECT_LT(apart("second.h5", "one.h5"), 1e-12);
    EXPECT_NEAR(series("second.h5", "elastic_energy").back(), series("one.h5", "elastic_energy").back(),
                1e-9 * series("one.h5", "elastic_energy").back());
    for (const char* name : {"first.h5", "second.h5", "one.h5"}) std::filesystem::remove(folder_ / name);
  }
}

/// Two balls of different materials, one on the other, on a floor of a third that is not level.
constexpr const char* kStack = R"(
[[material]]
name = "soft"
restitution_normal = 0.1
restitution_tangential = 0.1
stiffness = 6e5
stiffness_ratio = 0.6
[[material]]
name = "hard"
restitution_normal = 0.1
restitution_tangential = 0.1
stiffness = 4e6
[[material]]
name = "plank"
restitution_normal = 0.1
restitution_tangential = 0.1
[contact]
stiffness = 1e6
[gravity]
method = "none"
field = [0.05, 0.02, -1]
)";
constexpr const char* kTwo = R"(
[[body]]
shape = "sphere"
density = 2000
material = "soft"
position = [0, 0, 1]
[[body]]
shape = "sphere"
density = 2000
material = "hard"
position = [0, 0, 3]
)";
constexpr const char* kPlank = "[[wall]]\nkind = 'plane'\nmaterial = 'plank'\n";

TEST_F(PileFile, SpringsOfMaterialsOfTheirOwnStiffnessGoOn) {
  run(kTwo + std::string(kPlank) + kStack + kFirst, "first.h5");
  const cairn::Setup setup = run(pile(std::string(kPlank) + kStack + kSecond), "second.h5");
  EXPECT_EQ(setup.contacts.size(), 1u);
  EXPECT_EQ(setup.wall_contacts.size(), 1u);
  EXPECT_TRUE(setup.warnings.empty()) << setup.warnings[0];
  ASSERT_TRUE(setup.former);
  EXPECT_EQ(setup.former->physics.k_n, 1e6);
  expect_springs_kept(1e-12);
  // Whatever the materials are here, and also where an operation comes last.
  const std::string plank = kPlank,
                    carve = "[[stage]]\nname = 'all'\ncarve = { region = { kind = 'ball', radius = 90 } }\n";
  const auto start = [&](const std::string& name, const std::string& tables) {
    return assemble(scene("pile = '" + name + "'\n" + plank + tables + kSecond));
  };
  const auto slide = [](const cairn::Setup& s) { return s.contacts.at(0).memory.slide.x; };
  EXPECT_EQ(slide(start("first.h5", replaced(kStack, "6e5", "3e5"))), slide(setup));
  run(pile(plank + kStack + kSecond + carve), "carved.h5");
  const cairn::Setup carved = start("carved.h5", kStack), second = start("second.h5", kStack);
  EXPECT_EQ(slide(carved), slide(second));
  EXPECT_EQ(carved.wall_contacts.at(0).memory.slide.x, second.wall_contacts.at(0).memory.slide.x);
  run(pile(replaced(kStack, "[contact]\nstiffness = 1e6\n", "") + carve), "cut.h5");
  const cairn::Setup cut = start("cut.h5", kStack);
  EXPECT_FALSE(cut.former);
  EXPECT_EQ(slide(cut), slide(setup));
}

TEST_F(PileFile, AMaterialThatHasBecomeStifferIsSaid) {
  run(kTwo + std::string(kPlank) + kStack + kFirst, "first.h5");
  const double held = series("first.h5", "elastic_energy").back();
  const auto start = [&](const std::string& tables) {
    const Scene again = scene(pile(std::string(kPlank) + tables + kSecond));
    cairn::Run on = new_run(again, assemble(again), folder_ / "on.h5");
    on.advance({});
    return on.start_energy();
  };
  EXPECT_LT(start(kStack).excess, 1e-9 * held);
  EXPECT_DOUBLE_EQ(start(kStack).stiffer, 1.0);
  const StartEnergy stiff = start(replaced(kStack, "6e5", "2.4e6"));
  EXPECT_GT(stiff.excess, 0.5 * held);
  const auto in_series = [](double a, double b) { return 2.0 / (1.0 / a + 1.0 / b); };
  EXPECT_NEAR(stiff.stiffer, in_series(2.4e6, 4e6) / in_series(6e5, 4e6), 1e-12);
}

/// Dashpots keep the masses that the bodies had when they first touched, though these have turned since.
TEST_F(PileFile, InMidBlowGoesOnAsInOneRun) {
  const std::string law = R"(
[[material]]
name = "rock"
restitution_normal = 0.2
friction = 0.5
[contact]
stiffness = 2e4
[gravity]
method = "none"
)";
  const std::string bodies = R"(
[[body]]
shape = "dumbbell"
density = 2000
material = "rock"
angular_velocity = [0, 0.1, 0.1]
[[body]]
shape = "dumbbell"
density = 2000
material = "rock"
position = [0, 1.24, 1.72]
velocity = [0, -0.05, -0.05]
orientation = [0.9, 0.3, 0.1, 0.2]
)";
  const std::string first = replaced(kFirst, "20", "0.8"), second = replaced(kSecond, "3", "1");
  // Of another name here, and with others before it.
  const std::string renamed = "[[material]]\nname = 'ice'\nfriction = 0.1\n" + replaced(law, "rock", "stone");
  run(bodies + law + first, "first.h5");
  ASSERT_GT(series("first.h5", "elastic_energy").back(), 0.0);
  run(bodies + law + first + second, "one.h5");
  EXPECT_GT(series("one.h5", "dissipated_work").back(), 1.1 * series("first.h5", "dissipated_work").back());
  for (const std::string& text : {law, renamed}) {
    const cairn::Setup setup = run(pile(text + second), "second.h5");
    EXPECT_TRUE(setup.former);
    EXPECT_TRUE(setup.warnings.empty());
    EXPECT_LT(apart("second.h5", "one.h5"), 1e-12);
    std::filesystem::remove(folder_ / "second.h5");
  }
}

TEST_F(PileFile, WallsAreFoundInAnotherFrameAmongOthersAndByTheValuesOfTheirMaterial) {
  run(kBodies + std::string(kFloor) + kRest + kFirst, "first.h5");
  const std::string other = R"(
[frame]
position = [100, 50, -7]
[[wall]]
kind = "plane"
point = [0, 0, -50]
material = "stone"
[[wall]]
kind = "plane"
point = [3, 4, 7]
normal = [0, 0, 2]
material = "stone"
[[material]]
name = "ice"
friction = 0.1
)";
  const cairn::Setup setup =
      run(pile(other + replaced(kRest, "\"rock\"", "\"stone\"") + kSecond), "second.h5");
  EXPECT_GE(setup.wall_contacts.size(), 3u);
  for (const WallContact& c : setup.wall_contacts) EXPECT_EQ(c.wall, 1u);
  EXPECT_EQ(setup.bodies.material, (std::vector<std::uint16_t>{1, 1}));
  EXPECT_TRUE(setup.warnings.empty());
  ASSERT_EQ(setup.notes.size(), 2u);
  EXPECT_NE(setup.notes[1].find("'rock' is 'stone' here"), std::string::npos);
  expect_springs_kept(1e-9);
}

TEST_F(PileFile, WhatIsLostIsSaidWithItsEnergy) {
  run(kBodies + std::string(kFloor) + kRest + kFirst, "first.h5");
  const double held = series("first.h5", "elastic_energy").back();  // all of it on the floor
  const std::string elsewhere = replaced(kFloor, "'plane'", "'plane'\npoint = [0, 0, 1e-3]"),
                    ball = replaced(kFloor, "'plane'", "'sphere'\nradius = 100"),
                    ice = "[[material]]\nname = 'ice'\n" + replaced(kFloor, "'rock'", "'ice'"),
                    later = std::string(kFloor) + "stages = ['late']\n",
                    late = "[[stage]]\nname = 'late'\nduration = 1\n";
  for (const std::string& text : {elsewhere, ball, ice, later + late, std::string()}) {
    const bool first = text.find("late") == text.npos;
    const cairn::Setup setup = assemble(scene(pile(kRest + (first ? text + kSecond : kSecond + text))));
    EXPECT_TRUE(setup.wall_contacts.empty());
    ASSERT_EQ(setup.warnings.size(), 1u) << text;
    EXPECT_NE(setup.warnings[0].find(fmt::format("dropped with the {:.3g} J in their springs", held)),
              std::string::npos)
        << setup.warnings[0] << ", held " << held;
  }
  EXPECT_THROW(assemble(scene(pile(replaced(kRest, "\"rock\"\n", "\"sand\"\nfriction = 0.3\n") + kSecond))),
               InputError);
}

TEST_F(PileFile, MovingWallsGoOnMoving) {
  folder_.write("table.off", "OFF\n4 1 0\n-30 -30 0\n30 -30 0\n30 30 0\n-30 30 0\n4 0 1 2 3\n");
  const std::string level = replaced(kRest, "[0.2, 0.05, -0.95]", "[0, 0, -1]");
  for (const char* motion :
       {"kind = 'plane'\noscillation_amplitude = [0.03, 0, 0.01]\noscillation_frequency = 0.31\n",
        "kind = 'plane'\nvelocity = [0.1, 0, 0.2]\n",
        "kind = 'mesh'\nfile = 'table.off'\nangular_velocity = [0, 0, 0.1]\n"}) {
    const std::string floor = std::string("[[wall]]\nmaterial = 'rock'\n") + motion;
    run(kBodies + floor + level + kFirst, "first.h5");
    const cairn::Setup setup = run(pile(floor + level + kSecond), "second.h5");
    run(kBodies + floor + level + kFirst + kSecond, "one.h5");
    EXPECT_GE(setup.wall_contacts.size(), 3u);
    EXPECT_TRUE(setup.warnings.empty()) << setup.warnings[0];
    ASSERT_EQ(setup.wall_lead.size(), 1u);
    EXPECT_NEAR(setup.wall_lead[0], 20.0, 1e-9);
    expect_springs_kept(1e-6);
    EXPECT_LT(apart("second.h5", "one.h5"), 1e-9) << motion;
    EXPECT_GT((end_of("second.h5").bodies.position[1] - end_of("first.h5").bodies.position[1]).norm(), 1e-3);
    // A third run goes on from there; one that says so begins anew, and one that says how far goes on too.
    std::filesystem::rename(folder_ / "second.h5", folder_ / "third.h5");
    const auto start = [&](const std::string& key) {
      return assemble(scene("pile = 'third.h5'\n" + floor + key + level + kSecond));
    };
    EXPECT_NEAR(start("").wall_lead.at(0), 23.0, 1e-9);
    EXPECT_EQ(start("motion_time = 23\n").wall_lead, (std::vector<double>{0.0}));
    EXPECT_EQ(start("motion_time = 23\n").wall_contacts.size(), start("").wall_contacts.size());
    EXPECT_TRUE(start("motion_time = 0\n").wall_contacts.empty());
    for (const char* name : {"first.h5", "third.h5", "one.h5"}) std::filesystem::remove(folder_ / name);
  }
}

TEST_F(PileFile, AWallThatStopsKeepsItsSprings) {
  const std::string level = replaced(kRest, "[0.2, 0.05, -0.95]", "[0, 0, -1]");
  run(kBodies + std::string("[[wall]]\nkind = 'plane'\nmaterial = 'rock'\nvelocity = [1e-4, 0, 2e-4]\n") +
          level + kFirst,
      "first.h5");
  const cairn::Setup setup =
      run(pile("[[wall]]\nkind = 'plane'\nmaterial = 'rock'\npoint = [0, 0, 4e-3]\n" + level + kSecond),
          "second.h5");
  EXPECT_GE(setup.wall_contacts.size(), 3u);
  EXPECT_TRUE(setup.warnings.empty());
  expect_springs_kept(0.02);  // it stops at once: dashpots feel that
}

}  // namespace
}  // namespace cairn
