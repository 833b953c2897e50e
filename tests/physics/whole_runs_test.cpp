// Runs with every kind of stage, operation, wall, perturber and box: killed after each commit or stopped at
// any step and resumed they give the same bits, and so they do whatever is written on the way.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>

#include "folder.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "result_bits.h"
#include "whole_run.h"

namespace cairn {
namespace {

constexpr const char* kMaterials = R"(
[[material]]
name = "rock"
friction = 0.6
friction_rolling = 0.5
friction_twisting = 0.5
cohesion = 5
[[material]]
name = "slippery"
restitution_normal = 0.1
)";

/// Grains that settle, are cut, made denser, larger and of two kinds, and spun until they have failed.
const std::string kRecipe = R"(
title = "recipe"
[[lattice]]
kind = "hcp"
size = 10
density = 2500
spacing = 20.0005
material = "rock"
region = { kind = "ball", radius = 45 }
[gravity]
interval = 7
[contact]
stiffness = 1e5
overlap_limit = 1
[[stage]]
name = "fall"
duration = 300
material = "slippery"
quiet_energy = 1e-3
quiet_interval = 40
[[stage]]
name = "cut"
carve = { region = { kind = "ball", radius = 38 } }
[[stage]]
name = "bulk"
scale = { density = 1500, by = "mass" }
[[stage]]
name = "settle"
duration = 60
[[stage]]
name = "larger"
scale = { density = 1400, by = "size", volume = 2e5 }
[[stage]]
name = "core"
assign = { density_factor = 1.5, region = { kind = "ball", radius = 30 } }
[[stage]]
name = "spin"
duration = 3000
[stage.spin]
path = [[0, 20000], [500, 3000]]
ramp = 50
remnant_gap = 1
axis_drop = 0.02
axis_hold = 20
control_interval = 2
after_failure = 60
[[stage]]
name = "free"
duration = 40
)" + std::string(kMaterials);

/// A bed of grains between moving walls of several kinds, some only in some stages.
const std::string kWalls = R"(
title = "walls"
[[lattice]]
kind = "sc"
shape = "tetrahedron"
size = 1
density = 2000
spacing = 4.2
material = "rock"
random_orientation = true
region = { kind = "box", size = [13, 13, 9], position = [0, 0, 6] }
[[wall]]
kind = "plane"
material = "rock"
oscillation_amplitude = [0.2, 0, 0.3]
oscillation_frequency = 0.5
[[wall]]
kind = "cylinder"
material = "slippery"
radius = 12
angular_velocity = [0, 0, 0.3]
stages = ["pour", "shake"]
[[wall]]
kind = "sphere"
material = "rock"
radius = 15
point = [0, 0, 8]
stages = ["shake", "rest"]
[gravity]
method = "none"
field = [0, 0.1, -1]
[contact]
stiffness = 3e6
overlap_limit = 1
[[stage]]
name = "pour"
duration = 4
[[stage]]
name = "shake"
duration = 2
material = "slippery"
[[stage]]
name = "cut"
carve = { region = { kind = "box", size = [11, 30, 30] }, whole = true }
[[stage]]
name = "rest"
duration = 2
)" + std::string(kMaterials);

/// Grains past a planet, heavier at last.
const std::string kFlyby = R"(
title = "flyby"
[[lattice]]
kind = "hcp"
size = 10
density = 2500
material = "rock"
region = { kind = "ball", radius = 35 }
[gravity]
method = "direct"
[contact]
stiffness = 1e7
[[perturber]]
name = "Earth"
gm = 3.986004e14
[perturber.orbit]
periapsis = 1.0e7
eccentricity = 1.5
periapsis_time = 40
[[stage]]
name = "in"
duration = 40
[[stage]]
name = "heavy"
assign = { density_factor = 2, region = { kind = "ball", radius = 15 } }
[[stage]]
name = "out"
duration = 40
)" + std::string(kMaterials);

/// A packing that is pressed together in a periodic box.
const std::string kBox = R"(
title = "box"
box = { size = [20, 21, 22] }
[[lattice]]
kind = "sc"
size = 1
density = 2000
spacing = 2.3
material = "rock"
region = { kind = "box", size = [17, 18, 19] }
[gravity]
method = "none"
[contact]
stiffness = 1e6
overlap_limit = 1
[[stage]]
name = "press"
duration = 1
strain_rate = [-0.3, -0.3, -0.2]
packing = 0.4
[[stage]]
name = "shear"
duration = 1
strain_rate = [0.1, -0.1, 0]
)" + std::string(kMaterials);

const std::vector<std::string>& scenes() {
  static const std::vector<std::string> all{kRecipe, kWalls, kFlyby, kBox};
  return all;
}

Run new_run(const std::string& text, const std::filesystem::path& path) {
  const Scene scene = parse_scene(text, "run.toml", ".");
  return new_run(scene, assemble(scene), path, operate);
}

void go_on(const std::filesystem::path& path) {
  EXPECT_EQ(Run::resume(path, operate).advance({}), RunEnd::finished);
}

/// What tells one version of a file from another.
std::string version(const std::filesystem::path& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return {};
  return fmt::format("{} {} {}.{}", info.st_ino, info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec);
}

/// Steps done in all stages at which a stage began or ended.
using Steps = std::vector<std::uint64_t>;

/// Runs without a stop. With `copies` every version of the file is kept, as a kill would leave it.
Steps run_whole(const std::string& text, const Folder& folder, int* copies) {
  Run run = new_run(text, folder / "whole.h5");
  Steps borders;
  std::string last;
  std::uint64_t stage = 0;
  EXPECT_EQ(run.advance({.watch =
                             [&](const Run& r) {
                               if (const std::string now = version(folder / "whole.h5");
                                   copies && now != last) {
                                 last = now;
                                 std::filesystem::copy_file(folder / "whole.h5",
                                                            folder / fmt::format("kill{}.h5", (*copies)++));
                               }
                               const std::uint64_t steps = r.state().clock.total_steps;
                               if (borders.empty() || stage != r.state().clock.stage)
                                 borders.push_back(steps);
                               stage = r.state().clock.stage;
                               return true;
                             },
                         .watch_interval = 0.0}),
            RunEnd::finished);
  borders.push_back(run.state().clock.total_steps);
  return borders;
}

TEST(WholeRuns, KilledAfterAnyCommitTheyGiveTheSameBits) {
  const OneThread one;
  for (const std::string& text : scenes()) {
    const Folder folder;
    int copies = 0;
    run_whole(text, folder, &copies);
    EXPECT_GT(copies, 1);
    const ResultBits whole = result_bits(folder / "whole.h5");
    for (int k = 0; k < copies; ++k) {
      const auto path = folder / fmt::format("kill{}.h5", k);
      go_on(path);
      EXPECT_EQ(difference(whole, result_bits(path)), "") << text.substr(0, 300) << "commit " << k;
    }
  }
}

TEST(WholeRuns, StoppedAtAnyStepTheyGiveTheSameBits) {
  const OneThread one;
  for (const std::string& text : scenes()) {
    const Folder folder;
    const Steps borders = run_whole(text, folder, nullptr);
    const ResultBits whole = result_bits(folder / "whole.h5");
    Steps stops;
    for (const std::uint64_t border : borders)  // the last and first steps of stages
      for (const int offset : {-2, -1, 0, 1}) stops.push_back(border + static_cast<std::uint64_t>(offset));
    std::mt19937_64 random(7);
    for (int k = 0; k < 6; ++k) stops.push_back(1 + random() % borders.back());
    for (const std::uint64_t stop : stops) {
      const auto path = folder / "stopped.h5";
      const RunEnd end =
          new_run(text, path)
              .advance({.watch = [&](const auto& r) { return r.state().clock.total_steps < stop; },
                        .watch_interval = 0.0});
      if (end == RunEnd::interrupted) go_on(path);
      EXPECT_EQ(difference(whole, result_bits(path)), "") << text.substr(0, 300) << "step " << stop;
    }
  }
}

TEST(WholeRuns, NoOutputKeyChangesABit) {
  const OneThread one;
  std::mt19937_64 random(11);
  const auto pick = [&](std::initializer_list<double> values) {
    return values.begin()[random() % values.size()];
  };
  for (const std::string& text : scenes()) {
    const Folder folder;
    run_whole(text, folder, nullptr);
    const ResultBits plain = result_bits(folder / "whole.h5", false);
    for (int k = 0; k < 4; ++k) {
      const std::string keys = fmt::format(
          "[output]\nseries_interval = {}\nsnapshot_interval = {}\nremnant_gap = {}\ninterior = {}\n"
          "checkpoint_interval = {}\n",
          pick({0.0, 0.7, 13.0, 1e4}), pick({0.0, 0.31, 17.0, 1e4}), pick({0.0, 0.02, 0.5, 2.0}),
          pick({0.0, 5.0, 40.0}), pick({1.0, 300.0}));
      new_run(text + keys, folder / "run.h5").advance({});
      EXPECT_EQ(difference(plain, result_bits(folder / "run.h5", false)), "") << text.substr(0, 300) << keys;
    }
  }
}

}  // namespace
}  // namespace cairn
