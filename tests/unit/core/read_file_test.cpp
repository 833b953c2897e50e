#include "core/read_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "core/error.h"
#include "folder.h"

namespace cairn {
namespace {

TEST(ReadFile, GivesAllOfARegularFileOrSaysWhyNot) {
  const Folder folder;
  std::string content(3'000'000, 'x');
  content += std::string("\0\r\n\xff", 4);
  folder.write("long", content);
  folder.write("empty", "");
  std::filesystem::create_directory(folder / "folder");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const auto error = [&](const std::string& name, const FileKind& kind) -> std::string {
    try {
      read_file(folder / name, name, kind);
      return "";
    } catch (const InputError& failure) {
      return failure.what();
    }
  };
  EXPECT_TRUE(read_file(folder / "long", "long", {.most = content.size()}) == content);
  EXPECT_EQ(read_file(folder / "empty", "empty", {.most = 0}), "");
  EXPECT_EQ(error("long", {.most = content.size() - 1}), "long: larger than 3 MB");
  EXPECT_EQ(error("none", {}), "none: no such file");
  EXPECT_EQ(error("long/none", {.what = "shape file"}), "long/none: no such shape file");
  EXPECT_EQ(error("folder", {.what = "shape file"}), "folder: expected a shape file, found a directory");
  EXPECT_EQ(error("pipe", {}), "pipe: expected a file, found a pipe");
  EXPECT_NE(error(std::string(5000, 'a'), {}), "");
}

}  // namespace
}  // namespace cairn
