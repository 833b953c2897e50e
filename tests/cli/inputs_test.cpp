// A run goes on with the files that it was started with, whatever has become of them.
#include <fmt/format.h>

#include <csignal>

#include "cli/program.h"
#include "core/timer.h"

namespace cairn::cli {
namespace {

/// Grains of a shape of one's own fill a mesh and fall on another while a planet of a table passes; then
/// meshes carve them and give them a denser core.
constexpr const char* kScene = R"(title = "Files of every kind"
[[lattice]]
kind = "sc"
shape = "shapes/grain.toml"
size = 1
density = 2000
spacing = 3.4
region = { kind = "mesh", file = "meshes/fill.off" }
[[wall]]
kind = "mesh"
file = "meshes/floor.off"
point = [0, 0, -9]
[[perturber]]
name = "planet"
gm = 2e6
tidal = false
track_file = "planet.txt"
[contact]
stiffness = 1e7
[gravity]
method = "none"
field = [0, 0, -1]
[[stage]]
name = "fall"
duration = 8
[[stage]]
name = "cut"
carve = { region = { kind = "mesh", file = "meshes/cut.off" } }
[[stage]]
name = "core"
assign = { density = 4000, region = { kind = "mesh", file = "meshes/core.off" } }
[[stage]]
name = "on"
duration = 4
[output]
snapshot_interval = 1
)";

std::string cube(double half) {
  std::string text = "OFF\n8 6 0\n";
  for (int k = 0; k < 8; ++k)
    text += fmt::format("{} {} {}\n", k & 1 ? half : -half, k & 2 ? half : -half, k & 4 ? half : -half);
  return text + "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
}

/// The files; with another `size` every one of them is another.
void write_files(const Folder& folder, double size) {
  folder.write("shapes/grain.toml",
               fmt::format("name = 'grain'\n[[sphere]]\ncenter = [0, 0, 0.5]\nradius = {0}\n"
                           "[[sphere]]\ncenter = [0, 0, -0.5]\nradius = {0}\n",
                           size));
  folder.write("meshes/fill.off", cube(7.0 * size));
  folder.write("meshes/cut.off", cube(6.0 * size));
  folder.write("meshes/core.off", cube(3.0 * size));
  folder.write(
      "meshes/floor.off",
      fmt::format("OFF\n4 1 0\n-{0} -{0} 0\n{0} -{0} 0\n{0} {0} 0\n-{0} {0} 0\n4 0 1 2 3\n", 60.0 * size));
  std::string rows;
  for (int t = 0; t <= 20; t += 2) rows += fmt::format("{} {} {} 500\n", t, 1e3 * size, 10 * t);
  folder.write("planet.txt", rows);
}

TEST(Inputs, ChangedOrGoneWhileARunWasStopped) {
  const Folder folder;
  const std::string scene = folder.write("files.toml", kScene);
  write_files(folder, 1.0);
  const double start = wall_seconds();
  ASSERT_TRUE(succeeded(cairn(folder, {"run", scene, "-o", "whole.h5"})));
  const double seconds = wall_seconds() - start;
  const auto whole = contents(folder / "whole.h5");
  EXPECT_TRUE(whole.contains("/inputs/0005"));  // six files
  for (const bool gone : {false, true}) {
    write_files(folder, 1.0);
    std::filesystem::remove(folder / "stopped.h5");
    const Outcome first = cairn(folder, {"run", scene, "-o", "stopped.h5"},
                                {.stop = Stop{SIGINT, 0.2 * seconds, folder / "stopped.h5"}});
    ASSERT_EQ(first.code, 130) << first.err;
    write_files(folder, 0.8);
    if (gone)
      for (const char* name : {"shapes", "meshes", "planet.txt", "files.toml"})
        std::filesystem::remove_all(folder / name);
    ASSERT_TRUE(succeeded(cairn(folder, {"resume", "stopped.h5"})));
    EXPECT_TRUE(same_bits(whole, contents(folder / "stopped.h5"))) << gone;
    folder.write("files.toml", kScene);
  }
  // They do make a difference.
  write_files(folder, 0.8);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", scene, "-o", "other.h5"})));
  EXPECT_FALSE(same_bits(whole, contents(folder / "other.h5")));
}

}  // namespace
}  // namespace cairn::cli
