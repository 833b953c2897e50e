// What each command does for its user: piles, time steps, pictures, tables, help.
#include <cmath>

#include "cli/program.h"
#include "cli/scenes.h"
#include "core/instruction_set.h"
#include "io/results.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

std::vector<double> series(const fs::path& path, const char* column) {
  return ResultFile::open(path).read_series(column);
}

TEST(TimeStep, TooLongIsRefusedAndForcedEndsWithAReadableFile) {
  const Folder folder;
  const std::string stiff = with(kTwo, "[2.01, 0, 0]", "[1.999, 0, 0]") + "\n[contact]\nstiffness = 1e6\n";
  folder.write("long.toml", stiff + "time_step = 8\n");
  EXPECT_TRUE(refused(cairn(folder, {"run", "long.toml"}),
                      {"long.toml:", "key 'contact.time_step'", "time_step 8 s", "longest safe one is"}));
  EXPECT_FALSE(fs::exists(folder / "long.h5"));
  // The blow throws the balls up; they fall back and through the floor.
  const std::string floor = "\n[[wall]]\nkind = \"plane\"\npoint = [0, 0, -1]\n";
  folder.write("forced.toml", with(with(stiff, "duration = 3", "duration = 3000"), "method = \"none\"",
                                   "method = \"none\"\nfield = [0, 0, -0.01]") +
                                  "time_step = 8\nunsafe_time_step = true\n" + floor);
  const Outcome end = cairn(folder, {"run", "forced.toml"});
  EXPECT_EQ(end.code, 3) << end.err;
  EXPECT_EQ(lines(end.err), 1u) << end.err;
  EXPECT_TRUE(contains(end.err, "time step")) << end.err;
  const Outcome summary = cairn(folder, {"summary", "forced.h5"});
  EXPECT_TRUE(succeeded(summary));
  EXPECT_TRUE(contains(summary.out, "overlap by")) << summary.out;
  const auto number_after = [](const std::string& text, const std::string& word) {
    return std::stod(text.substr(text.find(word) + word.size()));
  };
  EXPECT_GT(number_after(summary.out, "\nsteps"), 0.0) << summary.out;
  for (const double time :
       {8.0 * number_after(summary.out, "\nsteps"), number_after(summary.out, "\nsimulated time")})
    EXPECT_EQ(time, number_after(end.err, "t = ")) << summary.out << end.err;
  EXPECT_TRUE(refused(cairn(folder, {"resume", "forced.h5"}), {"forced.h5", "cannot go on", "overlap by"}));
  EXPECT_TRUE(contents(folder / "forced.h5").contains("/checkpoint/position"));
}

TEST(InstructionSet, IsToldAndCanBeChosen) {
  const Folder folder;
  const auto set = [](const Outcome& version) {
    const std::string word = "\ninstruction set: ";
    const std::size_t at = version.out.find(word) + word.size();
    return version.out.substr(at, version.out.find(" of ", at) - at);
  };
  const Outcome version = cairn(folder, {"--version"});
  EXPECT_TRUE(succeeded(version));
  EXPECT_TRUE(contains(version.out, CAIRN_VERSION));
  const std::string best = set(version), lowest = instruction_sets().back();
  EXPECT_EQ(best, instruction_sets().front());
  EXPECT_EQ(set(cairn(folder, {"--instruction-set", lowest, "--version"})), lowest);
  EXPECT_TRUE(refused(cairn(folder, {"--instruction-set", "MMX", "--version"}), {"MMX", best, lowest}));

  folder.write("two.toml", kTwo);
  const Outcome run = cairn(folder, {"--instruction-set", lowest, "run", "two.toml"});
  EXPECT_TRUE(succeeded(run));
  EXPECT_TRUE(contains(run.out, ", " + lowest + " (")) << run.out;
  const Outcome info = cairn(folder, {"info", "two.h5"});
  EXPECT_TRUE(contains(info.out, lowest == "SSE4" ? "no fused multiply-adds" : "fused multiply-adds"));
}

TEST(Pile, ARunContinuesFromItsBodiesAndContacts) {
  const Folder folder;
  // Balls that stick together, slide and roll on each other when the pile ends.
  const std::string pile =
      with(with(kTwo, "[2.01, 0, 0]", "[1.999, 0, 0]"), "[-0.01, 0, 0]", "[-0.001, 0.002, 0]") +
      "\n[contact]\nstiffness = 1e5\n[[material]]\nname = \"rock\"\ncohesion = 800\n";
  folder.write("pile.toml", pile);
  ASSERT_TRUE(succeeded(cairn(folder, {"build", "pile.toml", "-o", "pile.h5"})));
  const std::string more =
      "pile = \"pile.h5\"\n[[body]]\nshape = \"dumbbell\"\ndensity = 1000\nposition = [50, 0, 0]\nmaterial = "
      "\"rock\"\n"
      "[[material]]\nname = \"other\"\n[[material]]\nname = \"rock\"\n[gravity]\nmethod = \"none\"\n"
      "[contact]\nstiffness = 2e5\n[[stage]]\nname = \"go on\"\nduration = 1e-9\n";
  folder.write("more.toml", more);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "more.toml"})));
  auto before = contents(folder / "pile.h5"), after = contents(folder / "more.h5");
  const auto bytes = [](const std::string& value) { return value.substr(value.find('|') + 1); };
  for (const char* field : {"position", "velocity", "orientation", "angular_momentum"}) {
    const std::string first = bytes(after["/snapshots/000000/" + std::string(field)]);
    const std::string last = bytes(before["/checkpoint/" + std::string(field)]);
    EXPECT_EQ(first.substr(0, last.size()), last) << field;
    EXPECT_EQ(first.size(), last.size() / 2 * 3) << field;
  }
  for (const char* field : {"i", "j"})
    EXPECT_EQ(after["/checkpoint/contacts/" + std::string(field)],
              before["/checkpoint/contacts/" + std::string(field)]);
  double spring[2][3];
  for (const int k : {0, 1}) {
    const std::string slide = bytes((k == 0 ? before : after)["/checkpoint/contacts/slide"]);
    ASSERT_EQ(slide.size(), sizeof spring[k]);
    slide.copy(reinterpret_cast<char*>(spring[k]), slide.size());
  }
  EXPECT_GT(std::abs(spring[0][1]), 1e-6);
  EXPECT_NEAR(spring[1][1], 0.5 * spring[0][1], 1e-9);  // the same force at twice the stiffness

  folder.write("lost.toml", with(more, "name = \"rock\"", "name = \"ice\""));
  EXPECT_EQ(cairn(folder, {"run", "lost.toml"}).code, 2);
}

TEST(Commands, HelpCheckAndShapes) {
  const Folder folder;
  for (const char* command : {"check", "build", "run", "resume", "render", "summary", "shape"}) {
    const Outcome help = cairn(folder, {command, "--help"});
    EXPECT_TRUE(succeeded(help));
    EXPECT_TRUE(contains(help.out, "--help")) << command;
  }
  const Outcome keys = cairn(folder, {"check", "--keys"});
  EXPECT_TRUE(succeeded(keys));
  EXPECT_TRUE(contains(keys.out, "restitution_normal"));
  folder.write("scene.toml", kTwo);
  const Outcome check = cairn(folder, {"check", "scene.toml"});
  EXPECT_TRUE(succeeded(check));
  EXPECT_TRUE(contains(check.out, "2 bodies, 2 spheres")) << check.out;
  // What would happen after the end of the run is not of interest: two planes would crush the ball.
  folder.write("press.toml", kPress);
  EXPECT_TRUE(succeeded(cairn(folder, {"check", "press.toml"})));
  EXPECT_FALSE(fs::exists(folder / "scene.h5"));
  const Outcome list = cairn(folder, {"shape", "list"});
  EXPECT_TRUE(succeeded(list));
  for (const char* shape : {"diamond", "sphere", "tetrahedron"}) EXPECT_TRUE(contains(list.out, shape));
  EXPECT_TRUE(contains(cairn(folder, {"shape", "show", "dumbbell"}).out, "0.866025"));
  EXPECT_TRUE(refused(cairn(folder, {"shape", "show", "dumbel"}), {"dumbel", "dumbbell"}));
}

TEST(Commands, CheckTellsThatNothingCanTouch) {
  const Folder folder;
  const std::string scene = with(kTwo, "method = \"none\"", "method = \"direct\"");
  folder.write("through.toml", scene + "\n[contact]\nenabled = false\n");
  const Outcome check = cairn(folder, {"check", "through.toml"});
  ASSERT_TRUE(succeeded(check));
  EXPECT_TRUE(
      contains(check.out, "loose spheres; no contacts: bodies pass through each other; direct gravity"))
      << check.out;
  EXPECT_FALSE(contains(check.out, "stiffness")) << check.out;
  EXPECT_TRUE(succeeded(cairn(folder, {"run", "through.toml"})));
  folder.write(
      "alone.toml",
      "[[body]]\nshape = \"sphere\"\ndensity = 1000\n[gravity]\nmethod = \"none\"\n[[stage]]\nname = "
      "\"s\"\nduration = 1\n");
  EXPECT_TRUE(contains(cairn(folder, {"check", "alone.toml"}).out, "no contacts: nothing can touch"));
}

TEST(Commands, PicturesAndTables) {
  const Folder folder;
  folder.write("scene.toml", kTwo);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "scene.toml", "-o", "first.h5"})));
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "scene.toml", "-o", "second.h5"})));
  const std::vector<std::string> draw{"render", "first.h5", "-o", "p.png",  "--width",
                                      "120",    "--height", "80", "--draft"};
  ASSERT_TRUE(succeeded(cairn(folder, draw)));
  const std::string png = read_bytes(folder / "p.png");
  ASSERT_GT(png.size(), 24u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x78\0\0\0\x50", 8));  // 120 x 80
  EXPECT_TRUE(refused(cairn(folder, {"render", "first.h5", "-o", "q.png", "--at", "lunch"}), {"'lunch'"}));
  EXPECT_FALSE(fs::exists(folder / "q.png"));
  const Outcome table = cairn(folder, {"summary", "first.h5", "second.h5"});
  EXPECT_TRUE(succeeded(table));
  for (const char* word : {"first", "second", "largest overlap", "finished"})
    EXPECT_TRUE(contains(table.out, word));
}

TEST(MainJob, ConservesFollowsTheSpinPathAndFails) {
  const Folder folder;
  // The first example with 60 grains and a quicker path.
  std::string scene = with(read_bytes(CAIRN_EXAMPLES "/diamonds.toml"), "count = 300", "count = 60");
  scene.replace(scene.find("path = ["), scene.find("on_failure") - scene.find("path = ["),
                "path = [[0, 18000], [6000, 6000]]\n");
  scene =
      with(with(scene, "after_failure = 1200", "after_failure = 300"), "duration = 24000", "duration = 6000");
  folder.write("job.toml", with(scene, "duration = 6000\nimpact_speed = 0.02\n\n[output]",
                                "duration = 500\nimpact_speed = 0.02\n\n[output]"));
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "job.toml"})));
  const fs::path file = folder / "job.h5";
  const auto target = series(file, "spin_target"), period = series(file, "period"),
             active = series(file, "control_active"), apart = series(file, "shed_bodies");
  int controlled = 0;
  for (std::size_t k = 1; k < active.size(); ++k)
    if (active[k] > 0.0 && active[k - 1] > 0.0 && apart[k] == apart[k - 1]) {  // the same grains spin
      EXPECT_NEAR(period[k] / target[k], 1.0, 1e-12) << k;
      ++controlled;
    }
  EXPECT_GT(controlled, 20);
  EXPECT_TRUE(succeeded(cairn(folder, {"render", "job.h5", "--at", "failure", "-o", "f.png", "--draft"})));
  for (double drift : series(file, "angular_momentum_drift")) EXPECT_LE(drift, 1e-10);
  for (double overlap : series(file, "largest_overlap")) EXPECT_LT(overlap, 0.1);
  for (const char* energy : {"kinetic_energy", "rotational_energy", "gravitational_energy", "elastic_energy",
                             "dissipated_work", "control_work"})
    for (double value : series(file, energy)) EXPECT_TRUE(std::isfinite(value)) << energy;
}

}  // namespace
}  // namespace cairn::cli
