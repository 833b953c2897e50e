// Whatever the user gets wrong: one line, exit code 2, and no file is lost.
#include "cli/program.h"
#include "cli/scenes.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct Mistake {
  const char* name;
  std::string scene;
  std::vector<std::string> words;  ///< of the line
};

/// The scene of two balls with a line added to its first material.
std::string material(const std::string& line) {
  return kTwo + "\n[[material]]\nname = \"rough\"\n" + line + "\n";
}

std::vector<Mistake> mistakes() {
  return {
      {"UnknownKey", with(kTwo, "method", "methud"), {"scene.toml:16:1", "gravity.methud", "'method'"}},
      {"WrongType",
       with(kTwo, "duration = 3", "duration = \"long\""),
       {"scene.toml:20:12", "stage[0].duration"}},
      {"MissingKey", with(kTwo, "density = 2000\n", ""), {"body[0]", "'density' or 'mass'"}},
      {"NotToml", with(kTwo, "[gravity]", "[gravity"), {"scene.toml:15"}},
      {"NegativeSize", with(kTwo, "size = 1", "size = -1"), {"body[0].size", "-1"}},
      {"RestitutionAboveOne",
       material("restitution_normal = 1.1"),
       {"material[0].restitution_normal", "1.1"}},
      {"NanFriction", material("friction = nan"), {"material[0].friction"}},
      {"NegativePeriod",
       with(kTwo, "[output]", "[stage.spin]\npath = [[0, -60]]\n[output]"),
       {"stage[0].spin.path"}},
      {"ZeroPeriod",
       with(kTwo, "[output]", "[stage.spin]\npath = [[0, 0]]\n[output]"),
       {"stage[0].spin.path"}},
      {"UnknownMaterial", with(kTwo, "size = 1", "size = 1\nmaterial = \"ice\""), {"'ice'"}},
      {"NoBodies", "[[stage]]\nname = \"s\"\nduration = 1\n", {"no bodies"}},
      {"UnknownShape", with(kTwo, "\"sphere\"", "\"spere\""), {"spere", "sphere"}},
      {"MissingShapeFile", with(kTwo, "\"sphere\"", "\"gone/rock.toml\""), {"gone/rock.toml"}},
      {"ShapeWithoutSpheres", with(kTwo, "\"sphere\"", "\"empty.toml\""), {"empty.toml", "sphere"}},
      {"ShapeWithNan", with(kTwo, "\"sphere\"", "\"nan.toml\""), {"nan.toml:3", "center"}},
      {"ShapeWithNegativeRadius",
       with(kTwo, "\"sphere\"", "\"negative.toml\""),
       {"negative.toml:4", "radius"}},
      {"DeepOverlap",
       with(kTwo, "[2.01,", "[1.5,"),
       {"spheres 0 and 1 of bodies 0 and 1", "0.5", "overlap_limit"}},
      {"SamePlace", with(kTwo, "[2.01,", "[0,"), {"spheres 0 and 1 of bodies 0 and 1"}},
      {"NoRoomInCloud",
       "[[cloud]]\ncount = 10\nfilling = 0.4\nsize = 1\ndensity = 1\n[[cloud.shape]]\nshape = \"sphere\"\n"
       "[[stage]]\nname = \"s\"\nduration = 1\n",
       {"filling"}},
      {"NothingLoadsTheContacts", with(kTwo, "[-0.01, 0, 0]", "[0, 0, 0]"), {"contact.stiffness"}},
      {"MissingPile", "pile = \"gone.h5\"\n" + kTwo, {"gone.h5"}},
      {"ForeignPile", "pile = \"foreign.h5\"\n" + kTwo, {"foreign.h5", "not a result"}},
      {"TextPile", "pile = \"empty.toml\"\n" + kTwo, {"empty.toml"}},
      {"PlanetInABall",
       kTwo + "\n[[perturber]]\nname = \"Earth\"\nmass = 1\nposition = [2, 0.5, 0]\n",
       {"perturber 'Earth' is 0.5", "sphere 1 of body 1"}},
      {"NoPlaceForThePlanet",
       kTwo + "\n[[perturber]]\nname = \"Earth\"\nmass = 1\n",
       {"perturber[0]", "'orbit'"}},
      {"MissingTrack",
       kTwo + "\n[[perturber]]\nname = \"Earth\"\nmass = 1\ntrack_file = \"gone.txt\"\n",
       {"perturber[0].track_file", "gone.txt"}},
      {"ShortTrack",
       kTwo + "\n[[perturber]]\nname = \"Earth\"\nmass = 1\ntrack_file = \"short.txt\"\n",
       {"perturber[0].track_file", "short.txt:2", "cover the run"}},
      {"TimeStepTooLong",
       with(kTwo, "duration = 3", "duration = 3\ntime_step = 3"),
       {"time_step", "longest safe"}},
      {"TooManySteps", with(kTwo, "duration = 3", "duration = 1e15\ntime_step = 1e-5"), {"steps"}},
  };
}

void write_shapes(const Folder& folder) {
  folder.write("empty.toml", "name = \"empty\"\nsphere = []\n");
  folder.write("nan.toml", "name = \"n\"\n[[sphere]]\ncenter = [0, nan, 0]\nradius = 1\n");
  folder.write("negative.toml", "name = \"n\"\n[[sphere]]\ncenter = [0, 0, 0]\nradius = -1\n");
  folder.write("short.txt", "0 1e7 0 0 0 0 0\n2 1e7 0 0 0 0 0\n");
  write_foreign_hdf5(folder / "foreign.h5");
}

TEST(BadScene, IsRefusedInOneLineByCheckAndRun) {
  const Folder folder;
  write_shapes(folder);
  folder.write("good.toml", kTwo);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "good.toml", "-o", "out.h5"})));
  const std::string precious = read_bytes(folder / "out.h5");
  for (const Mistake& mistake : mistakes()) {
    SCOPED_TRACE(mistake.name);
    folder.write("scene.toml", mistake.scene);
    EXPECT_TRUE(refused(cairn(folder, {"check", "scene.toml"}), mistake.words)) << "check";
    EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml", "-o", "out.h5", "--force"}), mistake.words))
        << "run";
    EXPECT_EQ(read_bytes(folder / "out.h5"), precious);
    EXPECT_FALSE(fs::exists(folder / "out.h5.part"));
    EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml", "-o", "new.h5"}), mistake.words)) << "new";
    EXPECT_FALSE(fs::exists(folder / "new.h5"));
  }
}

TEST(BadFile, MissingSceneIsRefused) {
  const Folder folder;
  EXPECT_TRUE(refused(cairn(folder, {"run", "gone.toml"}), {"gone.toml"}));
  EXPECT_TRUE(refused(cairn(folder, {"check", "gone.toml"}), {"gone.toml"}));
  EXPECT_TRUE(refused(cairn(folder, {"check", "."}), {"."}));
}

TEST(BadFile, WhatIsNotAResultIsRefusedByAllWhoReadOne) {
  const Folder folder;
  folder.write("scene.toml", kTwo);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "scene.toml", "-o", "good.h5"})));
  const std::string good = read_bytes(folder / "good.h5");
  std::string damaged = good;
  for (std::size_t k = damaged.size() / 5; k < damaged.size() * 4 / 5; ++k) damaged[k] = '\x5a';
  folder.write("damaged.h5", damaged);
  folder.write("cut.h5", good.substr(0, good.size() / 2));
  folder.write("text.h5", "no HDF5 at all\n");
  folder.write("nothing.h5", "");
  write_foreign_hdf5(folder / "foreign.h5");
  fs::create_directory(folder / "folder.h5");
  for (const std::string file :
       {"cut.h5", "text.h5", "nothing.h5", "foreign.h5", "folder.h5", "missing.h5", "damaged.h5"}) {
    SCOPED_TRACE(file);
    const std::string before = fs::is_regular_file(folder / file) ? read_bytes(folder / file) : "";
    EXPECT_TRUE(refused(cairn(folder, {"resume", file}), {file})) << "resume";
    EXPECT_TRUE(refused(cairn(folder, {"summary", file}), {file})) << "summary";
    if (file != "damaged.h5") {  // what a picture needs may be whole there
      EXPECT_TRUE(refused(cairn(folder, {"render", file, "-o", "x.png"}), {file})) << "render";
      EXPECT_FALSE(fs::exists(folder / "x.png"));
    }
    EXPECT_EQ(fs::is_regular_file(folder / file) ? read_bytes(folder / file) : "", before);
  }
}

TEST(BadOutput, WhereNothingCanBeWrittenIsRefused) {
  const Folder folder;
  folder.write("scene.toml", kTwo);
  fs::create_directory(folder / "folder.h5");
  EXPECT_TRUE(
      refused(cairn(folder, {"run", "scene.toml", "-o", "gone/out.h5"}), {"gone/out.h5", "no folder gone"}));
  EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml", "-o", "folder.h5"}), {"folder.h5"}));
  EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml", "-o", "folder.h5", "--force"}), {"folder.h5"}));
  EXPECT_TRUE(fs::is_directory(folder / "folder.h5"));
  EXPECT_FALSE(fs::exists(folder / "gone"));
}

TEST(BadOutput, OnlyResultsAreEverReplaced) {
  const Folder folder;
  folder.write("scene.toml", kTwo);
  folder.write("scene.h5", "precious");
  EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml"}), {"scene.h5", "exists"}));
  EXPECT_TRUE(refused(cairn(folder, {"build", "scene.toml"}), {"scene.h5", "exists"}));
  EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml", "--force"}), {"scene.h5", "only a result"}));
  EXPECT_EQ(read_bytes(folder / "scene.h5"), "precious");
  EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml", "-f", "-o", "scene.toml"}),
                      {"scene.toml", "only a result"}));
  EXPECT_EQ(read_bytes(folder / "scene.toml"), kTwo);

  ASSERT_TRUE(succeeded(cairn(folder, {"run", "scene.toml", "-o", "old.h5"})));
  folder.write("scene.toml", with(kTwo, "Two balls", "Two more balls"));
  EXPECT_TRUE(refused(cairn(folder, {"run", "scene.toml", "-o", "old.h5"}), {"old.h5", "exists"}));
  EXPECT_TRUE(succeeded(cairn(folder, {"run", "scene.toml", "-o", "old.h5", "--force"})));
  EXPECT_NE(contents(folder / "old.h5").at("@title").find("Two more balls"), std::string::npos);
  folder.write("scene.toml", "pile = \"old.h5\"\n" + kTwo);
  EXPECT_TRUE(
      refused(cairn(folder, {"run", "scene.toml", "-f", "-o", "old.h5"}), {"old.h5", "another name"}));
}

TEST(BadOutput, AFullDiskLeavesTheLastGoodFile) {
  const Folder folder;
  folder.write("scene.toml", kTwo);
  const Circumstances tiny{.file_size_limit = 4096};
  EXPECT_TRUE(
      refused(cairn(folder, {"run", "scene.toml", "-o", "new.h5"}, tiny), {"new.h5", "File too large"}));
  EXPECT_FALSE(fs::exists(folder / "new.h5"));
  EXPECT_FALSE(fs::exists(folder / "new.h5.part"));

  // Room for the first commit but not for the rows of the whole run.
  folder.write("long.toml", with(kTwo, "series_interval = 0.05", "series_interval = 1e-4") +
                                "\n[contact]\nsteps_per_contact = 5000\n");
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "long.toml", "-o", "whole.h5"})));
  const auto size = fs::file_size(folder / "whole.h5");
  const Circumstances full{.file_size_limit = size / 2};
  EXPECT_TRUE(
      refused(cairn(folder, {"run", "long.toml", "-o", "half.h5"}, full), {"half.h5", "File too large"}));
  ASSERT_TRUE(fs::exists(folder / "half.h5"));
  ASSERT_TRUE(succeeded(cairn(folder, {"summary", "half.h5"})));
  ASSERT_TRUE(succeeded(cairn(folder, {"resume", "half.h5"})));
  EXPECT_TRUE(same_bits(contents(folder / "whole.h5"), contents(folder / "half.h5")));
}

TEST(CommandLine, UnknownThingsEndWithTwo) {
  const Folder folder;
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{},
                                             {"fly"},
                                             {"run"},
                                             {"run", "scene.toml", "--wings"},
                                             {"resume"},
                                             {"check"},
                                             {"shape"},
                                             {"shape", "eat"}}) {
    const Outcome outcome = cairn(folder, arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_TRUE(outcome.out.empty()) << outcome.out;
    EXPECT_EQ(lines(outcome.err), 1u) << outcome.err;
  }
}

}  // namespace
}  // namespace cairn::cli
