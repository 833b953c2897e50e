// Runs with every kind of stage, operation, wall, perturber and box: killed after each commit or stopped at
// any step and resumed they give the same bits, and so they do whatever is written on the way.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>

#include "folder.h"
#include "physics/whole_scenes.h"
#include "pile/operate.h"
#include "result_bits.h"
#include "whole_run.h"

namespace cairn {
namespace {

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
