// Piles made by stages of every kind: resumed, on two threads, drawn, and taken on by another scene.
#include <fmt/format.h>

#include <csignal>

#include "cli/program.h"
#include "core/timer.h"

namespace cairn::cli {
namespace {

/// Grains poured into a sphere, shaken, carved, scaled, given a denser core, and settled at a period.
constexpr const char* kRecipe = R"(title = "A small recipe"
[[cloud]]
count = {}
filling = 0.2
distribution = "log_normal"
size = 5
size_max = 10
median = 6
sigma = 0.4
density = 3000
material = "slippery"
[[cloud.shape]]
shape = "dumbbell"
[[cloud.shape]]
shape = "sphere"
weight = 3
[[wall]]
kind = "sphere"
radius = {}
material = "slippery"
stages = ["pour", "rest"]
[[wall]]
kind = "sphere"
radius = {}
material = "slippery"
stages = ["shake"]
oscillation_amplitude = [0, 0, 2]
oscillation_frequency = 0.05
[[material]]
name = "rough"
[[material]]
name = "slippery"
restitution_normal = 0.1
friction = 0
friction_rolling = 0
friction_twisting = 0
[contact]
steps_per_contact = 20
overlap_limit = 0.9
[gravity]
method = "direct"
interval = 20
[[stage]]
name = "pour"
duration = {}
material = "slippery"
gravity = "none"
field = [0, 0, -0.05]
impact_speed = 0.5
quiet_speed = 0.02
[[stage]]
name = "shake"
duration = 40
material = "slippery"
gravity = "none"
field = [0, 0, -0.05]
impact_speed = 0.5
[[stage]]
name = "rest"
duration = 60
material = "slippery"
gravity = "none"
field = [0, 0, -0.05]
impact_speed = 0.5
[[stage]]
name = "shape"
[stage.carve.region]
kind = "ellipsoid"
size = [{}, {}, {}]
[[stage]]
name = "core"
[stage.assign]
density_factor = 1.5
[stage.assign.region]
kind = "ball"
radius = 40
[[stage]]
name = "bulk"
[stage.scale]
density = 2000
[[stage]]
name = "settle"
duration = {}
impact_speed = 0.05
quiet_energy = 1e-3
[stage.spin]
path = [[0, 30000]]
[output]
snapshot_interval = 30
checkpoint_interval = 1
)";

std::string recipe(int count, double radius, double pour, double width, double settle) {
  return fmt::format(fmt::runtime(kRecipe), count, radius, radius, pour, width, width, 0.9 * width, settle);
}

TEST(Build, ARecipeStoppedAtRandomMomentsGivesTheSameBits) {
  const Folder folder;
  const std::string scene = folder.write("recipe.toml", recipe(80, 130, 150, 100, 1000));
  ASSERT_TRUE(cairn(folder, {"check", scene}).code == 0);
  const double start = wall_seconds();
  const Outcome whole = cairn(folder, {"build", scene, "-o", "whole.h5"});
  const double seconds = wall_seconds() - start;
  ASSERT_EQ(whole.code, 0) << whole.err;
  for (const char* words : {"stage 'shake': the end of its duration", "stage 'shape': ", " of 80 bodies stay",
                            "stage 'bulk': masses x ", "2000.0 kg/m^3", "contacts "})
    EXPECT_TRUE(contains(whole.out, words)) << words << '\n' << whole.out;
  const auto expected = contents(folder / "whole.h5");
  EXPECT_TRUE(expected.contains("/bodies_0/mass"));
  EXPECT_TRUE(expected.contains("/stages/eta_bulk"));

  std::vector<std::string> arguments{"build", scene, "-o", "pieces.h5"};
  int stops = 0;
  for (const double part : {0.08, 0.15, 0.2, 0.3, 1e3}) {
    const Outcome end =
        cairn(folder, arguments, {.threads = 1, .stop = Stop{SIGTERM, part * seconds, folder / "pieces.h5"}});
    if (end.code == 0) break;
    ASSERT_EQ(end.code, 130) << end.err;
    arguments = {"resume", "pieces.h5"};
    ++stops;
  }
  EXPECT_GE(stops, 1);
  EXPECT_TRUE(same_bits(expected, contents(folder / "pieces.h5")));

  // Snapshots of before and after the carving are drawn with their own bodies.
  EXPECT_EQ(cairn(folder, {"render", "whole.h5", "--at", "first,pour,shape,last", "-o", "a.png"}).code, 0);
  // The settled pile is the start of another scene, with its region's volume.
  folder.write("next.toml",
               "pile = 'whole.h5'\n[[material]]\nname = 'rough'\n[[material]]\nname = 'slippery'\n"
               "[[stage]]\nname = 'b'\n[stage.scale]\ndensity = 1000\nby = 'size'\n");
  const Outcome next = cairn(folder, {"build", "next.toml", "-o", "next.h5"});
  EXPECT_EQ(next.code, 0) << next.err;
  EXPECT_TRUE(contains(next.out, "bulk density 2000 -> 1000 kg/m^3")) << next.out;
}

TEST(Build, IsTheSameOnTwoThreads) {
  const Folder folder;
  const std::string scene = folder.write("recipe.toml", recipe(1500, 350, 10, 420, 60));
  std::map<std::string, std::string> first;
  for (const int threads : {1, 2}) {
    const std::string file = fmt::format("{}.h5", threads);
    const Outcome end = cairn(folder, {"build", scene, "-o", file}, {.threads = threads, .stop = {}});
    ASSERT_EQ(end.code, 0) << end.err;
    if (threads == 1)
      first = contents(folder / file);
    else
      EXPECT_TRUE(same_bits(first, contents(folder / file)));
  }
}

TEST(Build, EveryExampleOfAPileIsValid) {
  const Folder folder;
  int examples = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CAIRN_EXAMPLES "/piles")) {
    const Outcome outcome = cairn(folder, {"check", entry.path().string()});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "operation  carve: bodies in a mesh of 2.4866e+08 m^3")) << outcome.out;
    ++examples;
  }
  EXPECT_EQ(examples, 7);
}

TEST(Build, SaysWhatIsWrongWithAStage) {
  const Folder folder;
  const std::string start = "[[lattice]]\nsize = 1\ndensity = 1\nregion = { kind = 'ball', radius = 5 }\n";
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words) {
    const std::string scene = folder.write("bad.toml", start + text);
    EXPECT_TRUE(refused(cairn(folder, {"build", scene, "-o", "bad.h5"}), words)) << text;
  };
  refuse("[[stage]]\nname = 'a'\n", {"bad.toml:5:1: key 'stage[0].duration': missing key"});
  refuse("[[stage]]\nname = 'a'\nscale = { density = 1 }\n",
         {"no region has been carved whose volume is known; expected 'volume'"});
  refuse("[[stage]]\nname = 'a'\ncarve = { region = { kind = 'mesh', file = 'no.obj' } }\n", {"no.obj"});
  refuse("[[stage]]\nname = 'a'\nduration = 1\n[[wall]]\nkind = 'plane'\nstages = ['b']\n",
         {"key 'wall[0].stages': no [[stage]] is called 'b'; expected some of 'a'"});
  refuse("[[stage]]\nname = 'a'\nduration = 1\nquiet_energy = 0.1\ngravity = 'none'\n",
         {"key 'stage[0].quiet_energy': has no meaning without self-gravity"});
  refuse(
      "[[stage]]\nname = 'a'\nduration = 1e9\n[[stage]]\nname = 'b'\ncarve = { region = { kind = 'mesh', "
      "file = "
      "'no.obj' } }\n",
      {"no.obj"});  // at once, not at the end of stage 'a'
  refuse("[[stage]]\nname = 'a'\ncarve = { region = { kind = 'box', radius = 3 } }\n",
         {"key 'stage[0].carve.region.radius': has no effect unless the kind is 'ball'"});
}

}  // namespace
}  // namespace cairn::cli
