// Results are written whole or not at all when memory runs out at any moment.
#include <gtest/gtest.h>

#include <span>

#include "allocations.h"
#include "core/error.h"
#include "folder.h"
#include "io/results.h"

namespace cairn {
namespace {

#ifndef __SANITIZE_ADDRESS__  // it has operators of its own

/// A file of some groups and a checkpoint, of which allocation `failing` fails; false: none did.
bool write_results(const std::filesystem::path& path, long failing) {
  std::string title = "memory";
  std::vector<double> numbers(3000, 1.0);
  std::vector<std::string> words{"a", "b"};
  const FieldTable table{{"numbers", "m", "some", &numbers, ""}, {"words", "", "two", &words, ""}};
  ResultFile file = ResultFile::create(path, {{"title", "", "", &title}}, true);
  g_failing = g_allocations + failing;
  const long last = g_failing;
  const auto end = [&] {
    g_failing = -1;
    return g_allocations > last;
  };
  try {
    file.write_static("constants", table);
    file.declare_series({{"time", "s", "of the row"}});
    for (int k = 0; k < 2; ++k) {
      const double time = 1.0 * k;
      file.add_series_row(std::span(&time, 1));
      file.add_snapshot(time, "stage", table, 0);
      file.commit(table);
    }
    file.finish(table, "finished");
  } catch (const std::bad_alloc&) {
    return end();
  } catch (const InputError&) {
    return end();
  }
  return end();
}

TEST(Memory, ThatRunsOutBreaksNothing) {
  const Folder folder;
  const std::filesystem::path path = folder / "run.h5";
  ASSERT_FALSE(write_results(path, 1'000'000));
  long tried = 0;
  for (long failing = 0; write_results(path, failing); ++failing) {
    if (++tried % 20 != 0) continue;
    std::vector<double> numbers;  // what is there is whole
    const ResultFile file = ResultFile::open(path);
    file.read_static("constants", {{"numbers", "", "", &numbers, ""}});
    EXPECT_EQ(numbers.size(), 3000u) << failing;
  }
  EXPECT_GT(tried, 500);
}

#endif

}  // namespace
}  // namespace cairn
