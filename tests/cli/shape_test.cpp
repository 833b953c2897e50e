// From a mesh to a shape file and a scene that uses it; what is said of broken meshes.
#include <fmt/format.h>

#include "cli/program.h"

namespace cairn::cli {
namespace {

// A block of 2 x 1 x 0.5, corners and facets as OBJ.
std::string block(const std::string& facets) {
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += fmt::format("v {} {} {}\n", 2.0 * (k & 1), 1.0 * (k >> 1 & 1), 0.5 * (k >> 2 & 1));
  return text + facets;
}
const std::string kFacets =
    "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 "
    "8 6\n";

TEST(ShapeCommand, CheckTellsVolumeMomentsAndRepairs) {
  const Folder folder;
  folder.write("block.obj", block(kFacets));
  const Outcome good = cairn(folder, {"shape", "check", "block.obj", "-o", "aligned.obj"});
  ASSERT_TRUE(succeeded(good));
  for (const char* words :
       {"12 facets, 8 vertices", "volume        1 m^3", "area          7 m^2", "extent        2 1 0.5 m",
        "centroid      1 0.5 0.25 m", "moments/mass  0.104166667 0.354166667 0.416666667 m^2"})
    EXPECT_TRUE(contains(good.out, words)) << words << '\n' << good.out;
  EXPECT_FALSE(contains(good.out, "repaired"));
  const Outcome aligned = cairn(folder, {"shape", "check", "aligned.obj", "--unit", "2"});
  EXPECT_TRUE(contains(aligned.out, "volume        8 m^3")) << aligned.out;
  EXPECT_TRUE(contains(aligned.out, "centroid      0 0 0 m")) << aligned.out;

  folder.write("inside.obj", block("f 1 4 3\n" + kFacets.substr(8)));
  const Outcome turned = cairn(folder, {"shape", "check", "inside.obj"});
  EXPECT_TRUE(contains(
      turned.out, "repaired      turned 1 facets that faced inwards, the first is facet 1 of the file at"))
      << turned.out;
}

TEST(ShapeCommand, BrokenMeshesAreOneLine) {
  const Folder folder;
  folder.write("open.obj", block(kFacets.substr(8)));
  folder.write("crossing.obj", block(kFacets) +
                                   "v 1 0.5 -1\nv 1 0.6 0.2\nv 1.1 0.5 0.2\nv 0.9 0.5 0.2\n"
                                   "f 9 11 10\nf 9 12 11\nf 9 10 12\nf 10 11 12\n");
  folder.write(
      "twice.obj",
      block(kFacets) + "v 5 0 0\nv 6 0 0\nv 5 1 0\nv 5 0 1\nf 9 11 10\nf 9 12 11\nf 9 10 12\nf 10 11 12\n");
  folder.write("bad.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n");
  for (const char* command : {"check", "fit"}) {
    const auto words = [&](const std::string& file) {
      std::vector<std::string> all = {"shape", command, file};
      if (std::string(command) == "fit") all.insert(all.end(), {"--spheres", "2"});
      return cairn(folder, all);
    };
    EXPECT_TRUE(
        refused(words("open.obj"), {"open.obj:9: not closed", "facet 1 of the file at", "3 such edges"}));
    EXPECT_TRUE(refused(words("crossing.obj"), {"crossing.obj:9: crosses itself: facet 1 of the file at",
                                                "and facet 13 of the file"}));
    EXPECT_TRUE(refused(words("twice.obj"),
                        {"twice.obj:25: expected one solid", "begins with facet 13 of the file at"}));
    EXPECT_TRUE(
        refused(words("bad.obj"), {"bad.obj:2: expected a coordinate, found 'nan', which is not finite"}));
    EXPECT_TRUE(refused(words("none.obj"), {"none.obj: no such mesh file"}));
    EXPECT_TRUE(refused(words("."), {"expected a mesh file, found a directory"}));
  }
  folder.write("block.obj", block(kFacets));
  EXPECT_EQ(cairn(folder, {"shape", "fit", "block.obj"}).code, 2);
  EXPECT_EQ(cairn(folder, {"shape", "fit", "block.obj", "--spheres", "0"}).code, 2);
  EXPECT_EQ(cairn(folder, {"shape", "fit", "block.obj", "--spheres", "2", "--error", "0.1"}).code, 2);
  EXPECT_EQ(cairn(folder, {"shape", "fit", "block.obj", "--spheres", "2", "--strategy", "luck"}).code, 2);
  EXPECT_EQ(cairn(folder, {"shape", "check", "block.obj", "--unit", "0"}).code, 2);
}

TEST(ShapeCommand, OptionsAreRefusedInPlainWords) {
  const Folder folder;
  folder.write("block.obj", block(kFacets));
  const auto fit = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"shape", "fit", "block.obj"});
    return cairn(folder, options);
  };
  EXPECT_TRUE(refused(fit({"--error", "nan"}), {"--error: expected a number from 0.0001 to 1, found 'nan'"}));
  EXPECT_TRUE(refused(fit({"--spheres", "2", "--unit", "nan"}),
                      {"--unit: expected a number from 1e-12 to 1e12, found 'nan'"}));
  EXPECT_TRUE(
      refused(fit({"--spheres", "2", "--seed", "-1"}), {"--seed: expected a whole number from 0", "'-1'"}));
  EXPECT_TRUE(refused(fit({"--spheres", "2.5"}), {"--spheres: expected a whole number from 1 to 1024"}));
  EXPECT_TRUE(refused(fit({"--spheres", "2", "--mass", "foo"}),
                      {"--mass: expected 'mesh', 'union' or 'spheres', found 'foo'"}));
  EXPECT_TRUE(refused(fit({"--spheres", "2", "--strategy", "luck"}),
                      {"--strategy: expected 'best' or 'greedy', found 'luck'"}));
  EXPECT_TRUE(refused(cairn(folder, {"shape", "show", "cube", "-o", "cube.jpg"}),
                      {"cube.jpg: expected a name that ends in .png"}));
  EXPECT_TRUE(refused(cairn(folder, {"shape", "list", "--sheet", "all"}), {"ends in .png"}));
  EXPECT_TRUE(refused(cairn(folder, {"shape", "show", "block.obj"}),
                      {"block.obj: expected a shape file, found a mesh: `cairn shape fit`"}));
}

TEST(ShapeCommand, FitsThatWillNotDoAreRefusedOrWarnedOf) {
  const Folder folder;
  const std::string thin = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.3 0.3 {}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const auto fit = [&](const std::string& height) {
    std::string text = thin;
    folder.write("thin.obj", text.replace(text.find("{}"), 2, height));
    return cairn(folder, {"shape", "fit", "thin.obj", "--spheres", "6", "-o", "thin.toml"});
  };
  const Outcome hopeless = fit("1e-9");
  EXPECT_TRUE(refused(hopeless, {"thin.obj: thin.toml (not written):", "key 'inertia'"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "thin.toml"));
  const Outcome poor = fit("1e-5");
  EXPECT_EQ(poor.code, 0);
  EXPECT_TRUE(contains(poor.err, "times the volume of the mesh, which they hardly stand for")) << poor.err;

  // Facets counted from 0, and a name that TOML must escape.
  std::string zero = kFacets;
  for (char& c : zero)
    if (c > '0' && c <= '9') --c;
  folder.write("zero.obj", block(zero));
  const Outcome check = cairn(folder, {"shape", "check", "zero.obj"});
  EXPECT_TRUE(contains(check.out, "note          facets count their vertices from 0")) << check.out;
  const Outcome named = cairn(folder, {"shape", "fit", "zero.obj", "--spheres", "2", "-o", "a\"\nb.toml"});
  EXPECT_EQ(named.code, 0) << named.err;
  EXPECT_TRUE(contains(named.err, "zero.obj: facets count their vertices from 0")) << named.err;
  EXPECT_TRUE(contains(cairn(folder, {"shape", "show", "a\"\nb.toml"}).out, "a\"_b: 2 spheres for zero.obj"));
}

// What a file ends before is missed wherever it is used: also as a wall, which may have holes.
TEST(ShapeCommand, FilesCutShortAreNeitherWallsNorRegions) {
  const Folder folder;
  const std::string points = "0 0 0\n9 0 0\n0 9 0\n0 0 9\n", facets = "3 0 2 1\n3 0 1 3\n3 0 3 2\n";
  folder.write("cut.off", "OFF\n4 4 6\n" + points + facets);
  folder.write(
      "cut.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n" +
          points + facets);
  folder.write("cut.tab", "4 4\n" + points + "1 3 2\n1 2 4\n1 4 3\n");
  folder.write("cut.obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2");
  folder.write("cut.stl",
               "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\n"
               "endfacet\n");
  folder.write("binary.stl", std::string(80, ' ') + std::string("\2\0\0\0", 4) + std::string(50, '\0'));
  const std::string start =
      "[[lattice]]\nsize = 1\ndensity = 1\nregion = { kind = 'ball', radius = 5 }\n"
      "[[stage]]\nname = 'a'\nduration = 1\n";
  for (const auto& [file, line] : {std::pair{"cut.off", 9},
                                   {"cut.ply", 16},
                                   {"cut.tab", 8},
                                   {"cut.obj", 6},
                                   {"cut.stl", 8},
                                   {"binary.stl", 1}}) {
    const std::string place = fmt::format("{}:{}: ", file, line);
    folder.write("wall.toml", start + "[[wall]]\nkind = 'mesh'\nfile = '" + file + "'\n");
    folder.write(
        "region.toml",
        start + "[[stage]]\nname = 'b'\ncarve = { region = { kind = 'mesh', file = '" + file + "' } }\n");
    EXPECT_TRUE(refused(cairn(folder, {"shape", "check", file}), {place}));
    EXPECT_TRUE(refused(cairn(folder, {"check", "wall.toml"}), {"wall[0].file", place}));
    EXPECT_TRUE(refused(cairn(folder, {"run", "wall.toml"}), {"wall[0].file", place}));
    EXPECT_TRUE(refused(cairn(folder, {"check", "region.toml"}), {place}));
  }
}

TEST(ShapeCommand, AFitCanBeRepeatedFromItsFile) {
  const Folder folder;
  folder.write("block.obj", block(kFacets));
  const auto fit = [&](const std::string& output) {
    return cairn(folder, {"shape", "fit", "block.obj", "--spheres", "3", "--strategy", "greedy", "--seed",
                          "7", "--mass", "union", "-o", output});
  };
  ASSERT_TRUE(succeeded(fit("shape.toml")));
  const std::string text = read_bytes(folder / "shape.toml");
  EXPECT_TRUE(contains(text, "strategy = \"greedy\"\nmass = \"union\"\nseed = 7\n")) << text;
  std::filesystem::create_directory(folder / "other");
  EXPECT_TRUE(succeeded(fit("other/shape.toml")));
  std::filesystem::remove(folder / "block.obj");
  for (const bool draw : {false, true}) {
    std::vector<std::string> words = {"shape", "show", "shape.toml"};
    if (draw) words.insert(words.end(), {"-o", "shape.png"});
    const Outcome show = cairn(folder, words);
    EXPECT_EQ(show.code, 0);
    EXPECT_TRUE(contains(show.err, "block.obj: no such mesh file")) << show.err;
    EXPECT_TRUE(contains(show.out, "gravity off"));
  }
}

TEST(ShapeCommand, AMeshBecomesAShapeInAScene) {
  const Folder folder;
  folder.write("meshes/block.obj", block(kFacets));
  const Outcome fit = cairn(folder, {"shape", "fit", "meshes/block.obj", "--spheres", "8", "--unit", "10",
                                     "-o", "shapes/block.toml"});
  EXPECT_TRUE(refused(fit, {"shapes/block.toml: there is no folder shapes"}));
  std::filesystem::create_directory(folder / "shapes");
  const Outcome again = cairn(folder, {"shape", "fit", "meshes/block.obj", "--spheres", "8", "--unit", "10",
                                       "-o", "shapes/block.toml"});
  ASSERT_TRUE(succeeded(again));
  EXPECT_TRUE(contains(again.out, "8 spheres"));
  EXPECT_TRUE(refused(
      cairn(folder, {"shape", "fit", "meshes/block.obj", "--spheres", "4", "-o", "shapes/block.toml"}),
      {"shapes/block.toml: exists already"}));
  EXPECT_TRUE(contains(read_bytes(folder / "shapes/block.toml"), "file = \"../meshes/block.obj\""));
  const Outcome show = cairn(folder, {"shape", "show", "shapes/block.toml", "-o", "block.png"});
  ASSERT_TRUE(succeeded(show));
  EXPECT_TRUE(contains(show.out, "stands for ../meshes/block.obj, as large at size = 6.2035 m")) << show.out;
  EXPECT_TRUE(std::filesystem::exists(folder / "block.png"));

  // One body as large as the mesh, of 1000 m^3 and 2000 kg/m^3, by the mesh's mass and by the spheres' own.
  const std::string scene =
      "[[body]]\nshape = \"shapes/block.toml\"\nsize = 6.203504908994\ndensity = 2000\nposition = [0, 0, "
      "0]\n[[material]]\nname = "
      "\"rock\"\n"
      "[contact]\nstiffness = 1e6\n[gravity]\nmethod = \"none\"\n[[stage]]\nname = \"s\"\nduration = 1e-3\n";
  folder.write("mesh.toml", scene);
  folder.write("spheres.toml", "mass_model = \"spheres\"\n" + scene);
  EXPECT_TRUE(succeeded(cairn(folder, {"run", "mesh.toml"})));
  const Outcome check = cairn(folder, {"check", "mesh.toml"});
  EXPECT_TRUE(contains(check.out, "2e+06 kg")) << check.out;
  EXPECT_FALSE(contains(cairn(folder, {"check", "spheres.toml"}).out, "2e+06 kg"));
}

}  // namespace
}  // namespace cairn::cli
