// A run that was stopped or killed and resumed gives the same bits as one that was not.
#include <fmt/format.h>

#include <csignal>
#include <random>

#include "cli/program.h"
#include "cli/scenes.h"
#include "core/timer.h"

namespace cairn::cli {
namespace {

using Contents = std::map<std::string, std::string>;

/// The forty grains, run once without a stop to compare with.
class Resume : public testing::Test {
 protected:
  void SetUp() override {
    const double start = wall_seconds();
    ASSERT_TRUE(succeeded(cairn(folder_, {"run", scene_, "-o", "whole.h5"})));
    seconds_ = wall_seconds() - start;
    whole_ = contents(folder_ / "whole.h5");
  }

  /// Runs and resumes; each of the first `most` sessions is ended by one of the signals after a random while,
  /// between `shortest` and `longest` times what the whole run takes.
  /// @return the number of sessions that were ended so.
  int run_in_pieces(const std::string& output, const std::vector<int>& signals, double shortest,
                    double longest, int most) {
    std::mt19937 random(std::random_device{}());
    std::uniform_real_distribution<double> moment(shortest, longest);
    int stops = 0;
    for (std::vector<std::string> arguments{"run", scene_, "-o", output};; arguments = {"resume", output}) {
      Circumstances how;
      const int signal = signals[static_cast<std::size_t>(stops) % signals.size()];
      const double after = seconds_ * moment(random);
      if (stops < most) how.stop = Stop{signal, after, folder_ / output};
      const Outcome end = cairn(folder_, arguments, how);
      if (end.code == 0) return stops;
      // A kill can come when all is written and only the program is left to end.
      if (stops > 0 && end.code == 2 && contains(end.err, "the run has finished")) return stops;
      // A session may be so young that it does not yet catch the signal; the file is then as before.
      const bool stopped = end.signal == signal || (signal != SIGKILL && end.code == 130 &&
                                                    contains(end.err, "cairn resume " + output));
      if (!stopped) {
        ADD_FAILURE() << "after " << after << " s: " << end.code << ' ' << end.signal << '\n' << end.err;
        return -1;
      }
      ++stops;
    }
  }

  Folder folder_;
  std::string scene_ = folder_.write("forty.toml", kForty);
  Contents whole_;
  double seconds_ = 0.0;  ///< that the whole run took
};

TEST_F(Resume, AFinishedRunIsRefusedAndUntouched) {
  int snapshots = 0;
  for (const auto& [path, bytes] : whole_) snapshots += path.ends_with("/sphere_position");
  EXPECT_GT(snapshots, 45);
  for (const char* path :
       {"/series/dissipated_work", "/checkpoint/contacts/slide", "/checkpoint/contacts/roll",
        "/checkpoint/contacts/twist", "/checkpoint/gravity/to/force", "@title", "/series/time@unit"})
    EXPECT_TRUE(whole_.contains(path)) << path;
  const std::string& twist = whole_["/checkpoint/contacts/twist"];
  EXPECT_GT(twist.size(), 10 * sizeof(double));  // there are contacts to lose
  EXPECT_NE(twist.find_first_not_of('\0', twist.find('|') + 1), std::string::npos);

  const std::string before = read_bytes(folder_ / "whole.h5");
  EXPECT_TRUE(refused(cairn(folder_, {"resume", "whole.h5"}), {"whole.h5", "finished"}));
  EXPECT_EQ(read_bytes(folder_ / "whole.h5"), before);
}

TEST_F(Resume, AfterInterruptsAndTerminationsAtRandomMoments) {
  EXPECT_GE(run_in_pieces("stopped.h5", {SIGINT, SIGTERM, SIGHUP}, 0.1, 0.3, 8), 2);
  EXPECT_TRUE(same_bits(whole_, contents(folder_ / "stopped.h5")));
}

TEST_F(Resume, AfterKillsAtRandomMoments) {
  EXPECT_GE(run_in_pieces("killed.h5", {SIGKILL}, 0.3, 0.8, 3), 1);
  EXPECT_TRUE(same_bits(whole_, contents(folder_ / "killed.h5")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "killed.h5.part"));
}

/// Grains in a box of triangles that is shaken and turned.
class ResumeInABox : public Resume {
 protected:
  ResumeInABox() {
    folder_.write(
        "box.off",
        "OFF\n8 6 0\n-6 -6 -6\n6 -6 -6\n-6 6 -6\n6 6 -6\n-6 -6 6\n6 -6 6\n-6 6 6\n6 6 6\n4 0 1 3 2\n"
        "4 4 5 7 6\n4 0 1 5 4\n4 2 3 7 6\n4 0 2 6 4\n4 1 3 7 5\n");
    scene_ = folder_.write("box.toml", kBox);
  }
};

TEST_F(ResumeInABox, WithoutTheFileOfTheMesh) {
  const Outcome first = cairn(folder_, {"run", scene_, "-o", "stopped.h5"},
                              {.stop = Stop{SIGINT, 0.4 * seconds_, folder_ / "stopped.h5"}});
  ASSERT_EQ(first.code, 130) << first.err;
  EXPECT_TRUE(contents(folder_ / "stopped.h5").contains("/checkpoint/walls/feature"));
  std::filesystem::remove(folder_ / "box.off");
  ASSERT_TRUE(succeeded(cairn(folder_, {"resume", "stopped.h5"})));
  EXPECT_TRUE(same_bits(whole_, contents(folder_ / "stopped.h5")));
  EXPECT_TRUE(
      refused(cairn(folder_, {"run", scene_, "-o", "again.h5"}), {"wall[0].file", "box.off: no such file"}));
}

/// The grains pass a planet from a table while a second one circles them.
class ResumeAtAPlanet : public Resume {
 protected:
  ResumeAtAPlanet() {
    std::string rows = "# t x y z\n";
    for (int t = 0; t <= 9000; t += 500)
      rows += fmt::format("{} {} 6e6 {}\n", t, 5e3 * (t - 5000), 1e-3 * t * t);
    folder_.write("planet.txt", rows);
    scene_ = folder_.write(
        "planets.toml", with(with(kForty, "duration = 5500", "duration = 1000"), "[gravity]", R"([[perturber]]
name = "planet"
gm = 2e14
track_file = "planet.txt"
[[perturber]]
name = "moon"
gm = 1e10
[perturber.orbit]
eccentricity = 0.3
periapsis = 2e6
[gravity])"));
  }
};

TEST_F(ResumeAtAPlanet, WithoutTheFileOfTheTrack) {
  EXPECT_TRUE(
      contains(cairn(folder_, {"check", scene_}).out, "perturber 'planet' (tide); perturber 'moon' (tide)"));
  const Outcome first = cairn(folder_, {"run", scene_, "-o", "stopped.h5"},
                              {.stop = Stop{SIGINT, 0.4 * seconds_, folder_ / "stopped.h5"}});
  ASSERT_EQ(first.code, 130) << first.err;
  EXPECT_TRUE(contents(folder_ / "stopped.h5").contains("/checkpoint/ledger/perturbers/torque"));
  std::filesystem::remove(folder_ / "planet.txt");
  ASSERT_TRUE(succeeded(cairn(folder_, {"resume", "stopped.h5"})));
  EXPECT_TRUE(same_bits(whole_, contents(folder_ / "stopped.h5")));
  const std::string& work = whole_["/series/perturber_work"];
  EXPECT_NE(work.find_first_not_of('\0', work.find('|') + 1), std::string::npos);
}

TEST(Threads, OneAndTwoGiveTheSameBits) {
  const Folder folder;
  const std::string scene = folder.write("clouds.toml", kClouds);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", scene, "-o", "one.h5"}, {.threads = 1})));
  ASSERT_TRUE(succeeded(cairn(folder, {"run", scene, "-o", "two.h5"}, {.threads = 2})));
  EXPECT_TRUE(same_bits(contents(folder / "one.h5"), contents(folder / "two.h5")));
}

}  // namespace
}  // namespace cairn::cli
