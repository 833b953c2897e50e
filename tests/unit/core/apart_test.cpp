#include "core/apart.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "core/error.h"

namespace cairn {
namespace {

std::string complaint(const std::function<std::string()>& work) {
  try {
    return "no error: " + run_apart(work, 1);
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(RunApart, GivesBackWhatTheWorkReturns) {
  EXPECT_EQ(run_apart([] { return std::string(); }), "");
  std::string large(10'000'000, 'x');
  large[5'000'000] = '\0';
  EXPECT_EQ(run_apart([&] { return large; }), large);
}

TEST(RunApart, SaysWhatWentWrong) {
  EXPECT_EQ(complaint([]() -> std::string { throw InputError("line {}: bad", 7); }), "line 7: bad");
  EXPECT_EQ(complaint([]() -> std::string { throw std::bad_alloc(); }),
            "cannot be read: it takes more memory than there is");
  EXPECT_EQ(complaint([]() -> std::string { std::_Exit(3); }),
            "cannot be read: the reader broke down over it");
  EXPECT_EQ(complaint([]() -> std::string { std::abort(); }),
            "cannot be read: the reader broke down over it");
  EXPECT_EQ(complaint([]() -> std::string {
              for (std::atomic<int> k = 0;; ++k) continue;
            }),
            "cannot be read: it takes more than 1 s");
}

}  // namespace
}  // namespace cairn
