// Runs made longer with --add and --until give the same bits as if they had been so from the start.
#include <fmt/format.h>

#include <csignal>

#include "cli/program.h"
#include "cli/scenes.h"
#include "core/timer.h"

namespace cairn::cli {
namespace {

using Contents = std::map<std::string, std::string>;

/// Without what tells the scenes themselves apart.
Contents without_scene(Contents all) {
  std::erase_if(all, [](const auto& entry) {  // and the checksums of it and of all attributes
    return entry.first == "@scene" || entry.first.ends_with("xxh3_128");
  });
  return all;
}

/// Only what a run goes on from.
Contents checkpoint(Contents all) {
  std::erase_if(all, [](const auto& entry) { return !entry.first.starts_with("/checkpoint/"); });
  return all;
}

/// Grains fall on a shaken floor of another stiffness; later a mesh carves them.
const std::string kFloor = R"(title = "Grains on a shaken floor"
[[material]]
name = "grain"
stiffness = 7e7
stiffness_ratio = 0.5
[[material]]
name = "table"
[[cloud]]
material = "grain"
count = 12
filling = 0.2
size = 0.7
density = 2000
position = [0, 0, 4]
[[cloud.shape]]
shape = "tetrahedron"
[[cloud.shape]]
shape = "sphere"
[[wall]]
kind = "plane"
material = "table"
oscillation_amplitude = [0.1, 0, 0.02]
oscillation_frequency = 0.7
[[wall]]
kind = "plane"
material = "table"
point = [0, 0, -1]
stages = ["fall"]
velocity = [0, 0, 0.01]
[contact]
stiffness = 1e8
overlap_limit = 0.5
[gravity]
method = "none"
field = [0, 0, -5]
[output]
snapshot_interval = 1
[[stage]]
name = "fall"
duration = 4
)";
const std::string kMore = R"([[stage]]
name = "cut"
carve = { region = { kind = "mesh", file = "cut.off" } }
[[stage]]
name = "on"
duration = 2
material = "table"
field = [1, 0, -5]
)";

class Extend : public testing::Test {
 protected:
  Extend() {
    folder_.write("cut.off",
                  "OFF\n8 6 0\n-3 -3 -9\n3 -3 -9\n-3 3 -9\n3 3 -9\n-3 -3 9\n3 -3 9\n-3 3 9\n3 3 9\n"
                  "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n");
  }

  /// Runs a scene to its end. @return how long that took (s).
  double run(const std::string& text, const std::string& output) const {
    const std::string scene = folder_.write(output + ".toml", text);
    const double start = wall_seconds();
    const Outcome end = cairn(folder_, {"run", scene, "-o", output});
    EXPECT_EQ(end.code, 0) << end.err;
    return wall_seconds() - start;
  }
  Contents of(const std::string& output) const { return contents(folder_ / output); }
  Outcome resume(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all{"resume"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return cairn(folder_, all);
  }

  Folder folder_;
};

TEST_F(Extend, StagesAddedToAFinishedRun) {
  run(kFloor + kMore, "whole.h5");
  const Contents whole = of("whole.h5");
  run(kFloor, "parts.h5");
  folder_.write("more.toml", kMore);
  EXPECT_EQ(resume({"parts.h5", "--add", "more.toml"}).code, 0);
  EXPECT_TRUE(same_bits(whole, of("parts.h5")));
  // One by one, the file of the mesh only there when its stage is added.
  run(kFloor, "single.h5");
  const std::size_t second = kMore.rfind("[[stage]]");
  folder_.write("cut.toml", kMore.substr(0, second));
  folder_.write("on.toml", kMore.substr(second));
  EXPECT_EQ(resume({"single.h5", "--add", "cut.toml"}).code, 0);
  std::filesystem::remove(folder_ / "cut.off");
  EXPECT_EQ(resume({"single.h5", "--add", "on.toml"}).code, 0);
  EXPECT_TRUE(same_bits(whole, of("single.h5")));
  EXPECT_TRUE(refused(resume({"single.h5"}), {"single.h5", "has finished"}));
  EXPECT_TRUE(refused(resume({"single.h5", "--add", "on.toml"}),
                      {"on.toml:2:8: key 'stage[3].name'", "'on' for a second time"}));
  EXPECT_TRUE(same_bits(whole, of("single.h5")));
}

TEST_F(Extend, StagesAddedToARunThatWasStopped) {
  run(kFloor + kMore, "whole.h5");
  const std::string scene = folder_.write("part.toml", kFloor);
  const Outcome first =
      cairn(folder_, {"run", scene, "-o", "part.h5"}, {.stop = Stop{SIGINT, 0.0, folder_ / "part.h5"}});
  ASSERT_EQ(first.code, 130) << first.err;
  folder_.write("more.toml", kMore);
  EXPECT_EQ(resume({"part.h5", "--add", "more.toml"}).code, 0);
  EXPECT_TRUE(same_bits(of("whole.h5"), of("part.h5")));
}

TEST_F(Extend, ALaterEndIsThatOfALongerStageWhereTheTimeStepIsTheSame) {
  const std::string step = "time_step = 1e-3\n", intervals = "[output]\nseries_interval = 0.1\n";
  const auto scene = [&](const char* duration) {
    return with(with(kFloor, "duration = 4\n", std::string("duration = ") + duration + "\n" + step),
                "[output]\n", intervals);
  };
  run(scene("7"), "whole.h5");
  run(scene("4"), "part.h5");
  EXPECT_EQ(resume({"part.h5", "--until", "6"}).code, 0);
  EXPECT_EQ(resume({"part.h5", "--until", "7"}).code, 0);
  EXPECT_TRUE(same_bits(without_scene(of("whole.h5")), without_scene(of("part.h5"))));
  EXPECT_TRUE(
      refused(resume({"part.h5", "--until", "7"}), {"has finished at t = 7 s; expected a later time"}));
  EXPECT_TRUE(refused(resume({"part.h5", "--until", "5"}), {"expected a later time"}));
}

TEST_F(Extend, ALaterEndIsThatOfTheSceneInTheFile) {  // with gravity that is held, and spin control
  const auto scene = [](double extension) {
    return with(kForty, "duration = 3000", fmt::format("duration = 1500\nextension = {}", extension));
  };
  const double seconds = run(scene(800.0), "whole.h5");
  run(with(kForty, "duration = 3000", "duration = 1500"), "part.h5");
  EXPECT_EQ(resume({"part.h5", "--until", "7300"}).code, 0);
  EXPECT_EQ(resume({"part.h5", "--until", "7800"}).code, 0);
  const Contents whole = checkpoint(of("whole.h5")), part = checkpoint(of("part.h5"));
  const auto same_but_outputs = [](Contents a) {
    a.erase("/checkpoint/ledger/recent_overlap");  // since the last row, and a former end had one
    return a;
  };
  EXPECT_TRUE(same_bits(same_but_outputs(whole), same_but_outputs(part)));
  // A run that was stopped before its last stage takes a later end as well, twice the same; and more stages.
  const std::string text = folder_.write("stopped.toml", with(kForty, "duration = 3000", "duration = 1500"));
  const Outcome first = cairn(folder_, {"run", text, "-o", "stopped.h5"},
                              {.stop = Stop{SIGINT, 0.1 * seconds, folder_ / "stopped.h5"}});
  ASSERT_EQ(first.code, 130) << first.err;
  EXPECT_TRUE(refused(resume({"stopped.h5", "--until", "6000"}), {"expected a later time"}));
  EXPECT_EQ(resume({"stopped.h5", "--until", "7800"}).code, 0);
  EXPECT_TRUE(same_bits(whole, checkpoint(of("stopped.h5"))));
  const std::string more = "[[stage]]\nname = 'wait'\nduration = 50\n";
  folder_.write("more.toml", more);
  EXPECT_EQ(resume({"part.h5", "--add", "more.toml"}).code, 0);
  run(scene(800.0) + more, "longer.h5");
  EXPECT_TRUE(
      same_bits(same_but_outputs(checkpoint(of("longer.h5"))), same_but_outputs(checkpoint(of("part.h5")))));
}

TEST_F(Extend, SaysWhyNot) {
  run(kFloor + kMore.substr(0, kMore.rfind("[[stage]]")), "run.h5");
  EXPECT_TRUE(
      refused(resume({"run.h5", "--until", "10"}), {"--until: the last stage, 'cut', takes no time"}));
  run(with(kFloor, "duration = 4", "duration = 4\nquiet_speed = 100"), "quiet.h5");
  EXPECT_TRUE(refused(resume({"quiet.h5", "--until", "10"}), {"has ended at t = ", "before its time"}));
  folder_.write("more.toml", "[[stage]]\nname = 'on'\nduration = 1\nmaterial = 'mud'\n");
  EXPECT_TRUE(refused(resume({"quiet.h5", "--add", "more.toml"}),
                      {"more.toml:4:12: key 'stage[1].material': no [[material]] is called 'mud'"}));
  folder_.write("more.toml", "[[stage]]\nname = 'on'\nduration = 1\ntime_step = 5\n");
  EXPECT_TRUE(refused(resume({"quiet.h5", "--add", "more.toml"}),
                      {"more.toml:4:13: key 'stage[1].time_step'", "stage 'on': time_step 5 s is too long"}));
  folder_.write("more.toml", "[output]\nseries_interval = 1\n");
  EXPECT_TRUE(refused(resume({"quiet.h5", "--add", "more.toml"}), {"more.toml:1:2: key 'output'"}));
  folder_.write("more.toml",
                "[[stage]]\nname = 'on'\ncarve = { region = { kind = 'mesh', file = 'no.off' } }\n");
  EXPECT_TRUE(refused(resume({"quiet.h5", "--add", "more.toml"}),
                      {"stage[1].carve.region.file", "no.off: no such file"}));
  EXPECT_TRUE(refused(resume({"quiet.h5", "--add", "none.toml"}), {"none.toml: no such file"}));
  EXPECT_EQ(resume({"quiet.h5", "--until", "-1"}).code, 2);
  folder_.write("more.toml", "[[stage]]\nname = 'on'\nduration = 1\n");
  EXPECT_EQ(resume({"quiet.h5", "--add", "more.toml"}).code, 0);  // nothing of all that has harmed it
}

}  // namespace
}  // namespace cairn::cli
