// Whatever system call fails, stops half way or is the last one: files are the old ones or the new ones, and
// runs go on from them to the same bits.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "cli/program.h"
#include "cli/scenes.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

const std::string kTriangle = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

class Faults : public testing::Test {
 protected:
  Faults() {
    folder_.write("two.toml", kTwo);
    folder_.write("mesh.off", kTriangle);
    fs::create_directory(out_);
  }

  /// Runs a command again and again, each time from what `prepare` makes of the empty folder out/, and each
  /// time another one of its calls on files there meets another misfortune; about `most` times in all. It
  /// must be killed, be refused in one line, or succeed; `check` looks at what is left, and whether it
  /// succeeded.
  void strike(const std::vector<std::string>& command, std::size_t most, const std::function<void()>& prepare,
              const std::function<void(bool succeeded)>& check) {
    const std::vector<std::string> deeds{"kill_before", "kill_after", "torn", "short", "28", "5", "4"};
    const auto anew = [&] {
      for (const auto& entry : fs::directory_iterator(out_)) fs::remove(entry.path());
      prepare();
    };
    anew();
    const std::size_t all = calls(folder_, command, out_).size();
    ASSERT_GT(all, 5u);
    // All pairs of a call and a deed, or a sample by steps of the golden ratio, which keeps to no deed.
    constexpr double kGolden = 0.61803398874989485;
    const std::size_t pairs = all * deeds.size();
    int killed = 0, refusals = 0;
    for (std::size_t k = 0; k < std::min(pairs, most); ++k) {
      const double place = kGolden * static_cast<double>(k);
      const auto index =
          pairs <= most ? k
                        : static_cast<std::size_t>((place - std::floor(place)) * static_cast<double>(pairs));
      const std::string& deed = deeds[index % deeds.size()];
      const std::size_t call = 1 + index / deeds.size();
      SCOPED_TRACE(deed + " at call " + std::to_string(call) + " of " + std::to_string(all));
      anew();
      const Outcome end = cairn(folder_, command, {.environment = fault(out_, deed, call)});
      if (end.code != 0 && end.signal == 0) {
        EXPECT_TRUE(refused(end, {}));
        ++refusals;
      }
      if (end.signal != 0) {
        EXPECT_EQ(end.signal, 9);
        ++killed;
      }
      check(end.code == 0);
      if (HasFailure()) return;
    }
    EXPECT_GT(killed, 0);
    EXPECT_GT(refusals, 0);
  }

  std::set<std::string> files() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(out_)) all.insert(entry.path().filename().string());
    return all;
  }

  /// For commands that replace a file: it is the old or the new one, and the next time the new one, alone.
  void strike_replacing(const std::vector<std::string>& command, const std::string& file, std::size_t most) {
    ASSERT_TRUE(succeeded(cairn(folder_, command)));
    const std::string fresh = read_bytes(out_ / file), old = "old\n" + std::string(5000, 'x');
    ASSERT_GT(fresh.size(), 100u);
    strike(
        command, most, [&] { folder_.write("out/" + file, old); },
        [&](bool well) {
          const std::string found = read_bytes(out_ / file);
          EXPECT_TRUE(found == fresh || (found == old && !well)) << found.substr(0, 200);
          if (well) return;
          EXPECT_TRUE(succeeded(cairn(folder_, command)));
          EXPECT_TRUE(read_bytes(out_ / file) == fresh);
          EXPECT_EQ(files(), (std::set<std::string>{file}));
        });
  }

  /// Goes on with a run to its end.
  void go_on() {
    if (!fs::exists(out_ / "run.h5")) {
      EXPECT_TRUE(succeeded(cairn(folder_, run_)));
    } else if (const Outcome end = cairn(folder_, {"resume", "out/run.h5"}); end.code != 0) {
      EXPECT_TRUE(refused(end, {"the run has finished"}));
      EXPECT_TRUE(succeeded(cairn(folder_, {"xdmf", "out/run.h5"})));
    }
  }

  void expect_whole() {
    EXPECT_TRUE(same_bits(whole_, contents(out_ / "run.h5")));
    EXPECT_TRUE(read_bytes(out_ / "run.h5.xdmf") == sidecar_);
    EXPECT_EQ(files(), (std::set<std::string>{"run.h5", "run.h5.xdmf"}));
  }

  void make_whole() {
    ASSERT_TRUE(succeeded(cairn(folder_, run_)));
    whole_ = contents(out_ / "run.h5");
    sidecar_ = read_bytes(out_ / "run.h5.xdmf");
  }

  const Folder folder_;
  const fs::path out_ = folder_ / "out";
  const std::vector<std::string> run_{"run", "two.toml", "-o", "out/run.h5"};
  std::map<std::string, std::string> whole_;
  std::string sidecar_;
};

TEST_F(Faults, ARunLosesNothing) {
  make_whole();
  strike(
      run_, 24, [] {},
      [&](bool well) {
        if (!well) go_on();
        expect_whole();
      });
}

TEST_F(Faults, AResumedRunLosesNothing) {
  make_whole();
  const Outcome killed = cairn(folder_, {"run", "two.toml", "-o", "half.h5"},
                               {.environment = fault(folder_ / "half.h5", "kill_after", 1, "rename")});
  ASSERT_EQ(killed.signal, 9);
  strike(
      {"resume", "out/run.h5"}, 18, [&] { fs::copy_file(folder_ / "half.h5", out_ / "run.h5"); },
      [&](bool well) {
        if (!well) go_on();
        expect_whole();
      });
}

TEST_F(Faults, ARunThatReplacesAnotherLeavesOneOfThem) {
  make_whole();
  folder_.write("old.toml", with(kTwo, "Two balls", "An earlier run"));
  ASSERT_TRUE(succeeded(cairn(folder_, {"run", "old.toml"})));
  const auto old = contents(folder_ / "old.h5");
  std::vector<std::string> again = run_;
  again.emplace_back("--force");
  strike(
      again, 16, [&] { fs::copy_file(folder_ / "old.h5", out_ / "run.h5"); },
      [&](bool well) {
        if (!well && contents(out_ / "run.h5") == old) {
          EXPECT_TRUE(succeeded(cairn(folder_, again)));
        } else if (!well) {
          go_on();
        }
        expect_whole();
      });
}

TEST_F(Faults, ShapesMeshesAndPicturesAreTheOldOrTheNewOnes) {
  strike_replacing({"shape", "fit", "mesh.off", "--spheres", "1", "--strategy", "greedy", "--force", "-o",
                    "out/shape.toml"},
                   "shape.toml", 8);
  strike_replacing({"shape", "check", "mesh.off", "--force", "-o", "out/mesh.obj"}, "mesh.obj", 12);
  ASSERT_TRUE(succeeded(cairn(folder_, {"run", "two.toml"})));
  strike_replacing({"render", "two.h5", "-o", "out/p.png", "--width", "32", "--height", "32", "--draft"},
                   "p.png", 12);
}

}  // namespace
}  // namespace cairn::cli
