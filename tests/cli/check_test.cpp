// What `check` and the start of a run say about scenes that can be run, but not as their author thinks.
#include <fmt/format.h>

#include "cli/program.h"
#include "io/results.h"

namespace cairn::cli {
namespace {

std::vector<double> series(const std::filesystem::path& path, const char* column) {
  return ResultFile::open(path).read_series(column);
}

/// A lattice whose spheres overlap by two per cent.
const std::string kOverlap = R"(
[[material]]
name = "m"
restitution_normal = 0.5
friction = 0.5
[gravity]
method = "direct"
interval = 20
[[lattice]]
kind = "hcp"
size = 10
density = 3000
spacing = 19.8
[lattice.region]
kind = "ball"
radius = 40
)";
const std::string kGo = "[[stage]]\nname = \"go\"\nduration = 20\nimpact_speed = 0.02\n";

TEST(Check, TellsTheEnergyOfOverlapsAndOffersToRelax) {
  const Folder folder;
  folder.write("go.toml", kOverlap + kGo);
  const Outcome check = cairn(folder, {"check", "go.toml"});
  EXPECT_TRUE(succeeded(check));
  for (const char* word :
       {"warning", "times the gravitational energy", "deepest: spheres ", "by 0.02 of", "relax = {}"})
    EXPECT_TRUE(contains(check.out, word)) << word << '\n' << check.out;
  const Outcome run = cairn(folder, {"run", "go.toml"});
  EXPECT_TRUE(succeeded(run));
  EXPECT_TRUE(contains(run.err, "times the gravitational energy")) << run.err;

  folder.write("relax.toml", kOverlap +
                                 "[[stage]]\nname = \"relax\"\nduration = 1e4\nimpact_speed = 0.02\n"
                                 "relax = {}\n" +
                                 kGo);
  EXPECT_FALSE(contains(cairn(folder, {"check", "relax.toml"}).out, "warning"));
  const Outcome relaxed = cairn(folder, {"run", "relax.toml"});
  EXPECT_TRUE(succeeded(relaxed));
  EXPECT_FALSE(contains(relaxed.err, "warn")) << relaxed.err;
  EXPECT_TRUE(contains(relaxed.out, "stage 'relax': relaxed after")) << relaxed.out;
  EXPECT_EQ(series(folder / "relax.h5", "shed_bodies").back(), 0.0);
}

TEST(Check, TellsHowMeshesWereRead) {
  const Folder folder;
  folder.write("fill.obj",
               "v -20 -20 -20\nv 30 -20 -20\nv -20 30 -20\nv -20 -20 30\n"
               "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nl 1 2\nl 1 3\n");
  folder.write("floor.obj", "v -90 -90 0\nv 90 -90 0\nv 90 90 0\nv -90 90 0\nf 1 2 3 4\np 1\n");
  folder.write("go.toml", R"(
[[lattice]]
kind = "sc"
size = 1
density = 2000
spacing = 6
region = { kind = "mesh", file = "fill.obj" }
[[wall]]
kind = "mesh"
file = "floor.obj"
point = [0, 0, -30]
[contact]
stiffness = 1e7
[gravity]
method = "none"
field = [0, 0, -1]
[[stage]]
name = "go"
duration = 0.01
)");
  const Outcome check = cairn(folder, {"check", "go.toml"}), run = cairn(folder, {"run", "go.toml"});
  EXPECT_TRUE(succeeded(check));
  EXPECT_TRUE(succeeded(run));
  for (const char* word :
       {"fill.obj: left out 2 lines and points", "floor.obj: left out 1 lines and points"}) {
    EXPECT_TRUE(contains(check.out, word)) << check.out;
    EXPECT_TRUE(contains(run.err, word)) << run.err;
  }
}

TEST(Check, NamesThePairsThatSetStiffnessAndTimeStep) {
  const Folder folder;
  folder.write("fall.toml", R"(
[gravity]
method = "direct"
[[body]]
shape = "sphere"
size = 400.0
density = 2000
[[body]]
shape = "sphere"
size = 0.5
density = 2000
position = [420.5, 0.0, 0.0]
[[stage]]
name = "fall"
duration = 36
)");
  const std::string said = cairn(folder, {"check", "fall.toml"}).out;
  for (const char* word :
       {"stiffness  7.495e+06 N/m", "body 1 (size 0.5 m) and body 0 (size 400 m) at 0.423 m/s",
        "mode of body 1 (size 0.5 m) and body 0 (size 400 m)", "impact_speed"})
    EXPECT_TRUE(contains(said, word)) << word << '\n' << said;
}

/// Grains that fall together and are cut by a cube of `edge` (m), whose file is in units of `unit` (m).
std::string recipe(const std::string& unit) {
  return R"(
[[cloud]]
count = 30
size = 8
density = 3300
shape = [{ shape = "sphere" }]
[contact]
max_overlap = 0.05
steps_per_contact = 10
[[stage]]
name = "collapse"
duration = 50
[[stage]]
name = "shape"
[stage.carve.region]
kind = "mesh"
file = "cube.off"
unit = )" +
         unit + R"(
[[stage]]
name = "bulk"
[stage.scale]
density = 2000
)";
}

TEST(Check, TellsRegionsInAWrongUnit) {
  const Folder folder;
  folder.write("cube.off",  // with an edge of 0.048
               "OFF\n8 6 0\n-.024 -.024 -.024\n.024 -.024 -.024\n-.024 .024 -.024\n.024 .024 -.024\n"
               "-.024 -.024 .024\n.024 -.024 .024\n-.024 .024 .024\n.024 .024 .024\n4 0 2 3 1\n4 4 5 7 6\n"
               "4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n");
  folder.write("metres.toml", recipe("1"));
  folder.write("kilometres.toml", recipe("1000"));
  folder.write("more.toml", recipe("1e6"));
  const std::string metres = cairn(folder, {"check", "metres.toml"}).out,
                    right = cairn(folder, {"check", "kilometres.toml"}).out,
                    more = cairn(folder, {"check", "more.toml"}).out;
  EXPECT_TRUE(contains(metres, "is smaller than a body, 2.14e+03 m^3; is the file in metres?")) << metres;
  EXPECT_TRUE(contains(metres, "masses will be multiplied by about")) << metres;
  EXPECT_FALSE(contains(right, "warning")) << right;
  EXPECT_TRUE(contains(more, "times larger than the pile")) << more;
  EXPECT_TRUE(contains(more, "masses will be multiplied by about")) << more;
  EXPECT_TRUE(contains(cairn(folder, {"run", "metres.toml"}).err, "stage 'shape': the region, 0.000111 m^3"));
}

TEST(Check, TellsAPeriapsisInsideThePerturber) {
  const Folder folder;
  const auto scene = [](const char* periapsis) {
    return fmt::format(R"(
[[body]]
shape = "sphere"
density = 2000
[contact]
stiffness = 1e6
[[perturber]]
name = "Earth"
gm = 3.986004e14
radius = 6.371e6
[perturber.orbit]
periapsis = {}
eccentricity = 1.8
periapsis_time = 14000
[[stage]]
name = "go"
duration = 1
)",
                       periapsis);
  };
  folder.write("inside.toml", scene("20000"));
  folder.write("outside.toml", scene("2e7"));
  const std::string said = cairn(folder, {"check", "inside.toml"}).out;
  EXPECT_TRUE(contains(said, "perturber 'Earth' comes within 20000 m")) << said;
  EXPECT_FALSE(contains(cairn(folder, {"check", "outside.toml"}).out, "warning"));
}

TEST(Check, TellsElasticContactsWithCohesion) {
  const Folder folder;
  const auto said = [&](const std::string& material) {
    folder.write(
        "scene.toml",
        "[[body]]\nshape = \"sphere\"\ndensity = 2000\n[[body]]\nshape = \"sphere\"\ndensity = 2000\n"
        "position = [5, 0, 0]\n[contact]\nstiffness = 1e6\n"
        "[[stage]]\nname = \"go\"\nduration = 1\n[[material]]\nname = \"m\"\n" +
            material);
    return contains(cairn(folder, {"check", "scene.toml"}).out, "cohesive and nearly elastic");
  };
  EXPECT_TRUE(said("cohesion = 10\nrestitution_normal = 0.995\n"));
  EXPECT_FALSE(said("cohesion = 10\nrestitution_normal = 0.98\n"));
  EXPECT_FALSE(said("cohesion = 0\nrestitution_normal = 1\n"));
}

}  // namespace
}  // namespace cairn::cli
