#include "io/inputs.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <functional>

#include "core/error.h"
#include "folder.h"
#include "io/results.h"

namespace cairn {
namespace {

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

ResultFile keep(const InputFiles& files, const std::filesystem::path& path) {
  std::uint64_t seed = 1;
  ResultFile result = ResultFile::create(path, {{"seed", "", "", &seed}}, true);
  files.write(result);
  result.commit({{"seed", "", "", &seed}});
  return result;
}

TEST(Inputs, AFileIsReadOnceAndGoesOnAsItWas) {
  const Folder folder;
  const std::string text("bytes \0 of\n any kind\xff", 20), large(16'000'001, 'x');
  folder.write("a.txt", text);
  folder.write("empty.txt", "");
  folder.write("large.obj", large);
  const InputFiles files(folder.path());
  EXPECT_EQ(files.read("a.txt"), text);
  EXPECT_EQ(files.read("empty.txt"), "");
  EXPECT_EQ(files.read("large.obj"), large);
  folder.write("a.txt", "other");
  EXPECT_EQ(files.read("a.txt"), text);
  { keep(files, folder / "run.h5"); }

  const InputFiles later(folder.path());
  later.restore(ResultFile::open(folder / "run.h5"));
  std::filesystem::remove(folder / "empty.txt");
  EXPECT_EQ(later.read("a.txt"), text);
  EXPECT_EQ(later.read("empty.txt"), "");
  EXPECT_EQ(later.read("large.obj"), large);  // its checksum is as it was
  folder.write("large.obj", large + "y");
  EXPECT_NE(
      error_of([&] { later.read("large.obj"); }).find("large.obj: has changed since the run was started"),
      std::string::npos);
  std::filesystem::remove(folder / "large.obj");
  EXPECT_NE(error_of([&] { later.read("large.obj"); }).find("large.obj: no such file"), std::string::npos);
  folder.write("new.txt", "new");
  EXPECT_NE(
      error_of([&] { later.read("new.txt"); }).find("not among the files that the run was started with"),
      std::string::npos);
  later.reopen();
  EXPECT_EQ(later.read("new.txt"), "new");
  EXPECT_EQ(later.read("a.txt"), text);
}

TEST(Inputs, WhatIsNoFileIsRefused) {
  const Folder folder;
  const InputFiles files(folder.path());
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  folder.write("long", "1234567");
  EXPECT_NE(error_of([&] { files.read("pipe"); }).find("pipe: expected a file, found a pipe"),
            std::string::npos);
  EXPECT_NE(error_of([&] { files.read("."); }).find("expected a file, found a directory"), std::string::npos);
  EXPECT_NE(error_of([&] { files.read("none"); }).find("none: no such file"), std::string::npos);
  EXPECT_NE(error_of([&] { files.read("long", 6); }).find("long: larger than 0 MB"), std::string::npos);
}

TEST(Inputs, ARunWithoutFilesKeepsNone) {
  const Folder folder;
  { keep(InputFiles(folder.path()), folder / "run.h5"); }
  const ResultFile file = ResultFile::open(folder / "run.h5");
  EXPECT_FALSE(file.has_group("inputs"));
  const InputFiles files(folder.path());
  files.restore(file);
  folder.write("a.txt", "a");
  EXPECT_NE(error_of([&] { files.read("a.txt"); }), "");
}

}  // namespace
}  // namespace cairn
