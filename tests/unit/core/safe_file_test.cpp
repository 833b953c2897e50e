// Files are replaced whole or not at all, and what belongs to others is left alone.
#include "core/safe_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <set>

#include "core/error.h"
#include "folder.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The message of the InputError that `work` must throw.
std::string message(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

class SafeFile : public testing::Test {
 protected:
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder.path()))
      all.insert(entry.path().filename().string());
    return all;
  }

  const Folder folder;
  const fs::path path = folder / "file.txt";
};

TEST_F(SafeFile, IsWrittenWholeAndReplacedOnlyWhenAsked) {
  write_file(path, "one", false);
  EXPECT_EQ(content(path), "one");
  EXPECT_NE(message([&] { write_file(path, "two", false); }).find("exists already"), std::string::npos);
  EXPECT_EQ(content(path), "one");
  fs::permissions(path, fs::perms(0640));
  write_file(path, "three", true);
  EXPECT_EQ(content(path), "three");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms(0640));
  EXPECT_EQ(names(), (std::set<std::string>{"file.txt"}));
}

TEST_F(SafeFile, OnlyRegularFilesAreReplaced) {
  folder.write("precious", "precious");
  fs::create_symlink("precious", folder / "link");
  fs::create_symlink("nowhere", folder / "dangling");
  fs::create_directory(folder / "folder");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::set<std::string> before = names();
  for (const auto& [name, words] : {std::pair("link", "is a symbolic link"),
                                    {"dangling", "is a symbolic link"},
                                    {"folder", "is a folder, not a file"},
                                    {"pipe", "is not a regular file"},
                                    {"none/file", "there is no folder"},
                                    {"precious/file", "there is no folder"},
                                    {"", "is not the name of a file"}}) {
    const fs::path target = folder / name;
    EXPECT_NE(message([&] { write_file(target, "new", true); }).find(words), std::string::npos) << name;
    EXPECT_NE(message([&] { claim(target, true); }).find(words), std::string::npos) << name;
  }
  const fs::path longer = folder / std::string(300, 'n');
  EXPECT_EQ(message([&] { write_file(longer, "new", true); }), longer.string() + ": File name too long");
  EXPECT_EQ(content(folder / "precious"), "precious");
  EXPECT_EQ(names(), before);
  write_file(folder / std::string(255, 'n'), "new", false);  // as long as names can be
  EXPECT_EQ(content(folder / std::string(255, 'n')), "new");
}

TEST_F(SafeFile, LeavesAreRemovedWhereTheyAreCertainlyOursAndDead) {
  const TemporaryFile dead_link = TemporaryFile::create(path, 0600),
                      dead_pipe = TemporaryFile::create(path, 0600);
  const TemporaryFile alive = TemporaryFile::create(path, 0600),
                      other = TemporaryFile::create(folder / "other", 0600);
  std::string left;
  {
    const TemporaryFile dead = TemporaryFile::create(path, 0600);
    left = dead.name.filename().string();
    EXPECT_TRUE(names().contains(left));
  }
  EXPECT_TRUE(left.starts_with("file.txt.") && left.ends_with(".part")) << left;
  folder.write("precious", "precious");
  for (const TemporaryFile* file : {&dead_link, &dead_pipe}) fs::remove(file->name);
  fs::create_symlink("precious", dead_link.name);
  ASSERT_EQ(mkfifo(dead_pipe.name.c_str(), 0600), 0);
  std::string near = left;  // one digit is another
  near[10] = near[10] == '0' ? '1' : '0';
  for (const std::string& name :
       {near, std::string("file.txt.part"), std::string("file.txt.0123456789abcdef.part")})
    folder.write(name, "precious");
  const std::set<std::string> before = names();
  write_file(path, "new", false);
  std::set<std::string> expected = before;
  expected.erase(left);
  expected.insert("file.txt");
  EXPECT_EQ(names(), expected);
  EXPECT_EQ(content(folder / "precious"), "precious");
  EXPECT_EQ(content(folder / near), "precious");
}

TEST_F(SafeFile, AKilledReplacementIsClearedAwayByTheNextWriter) {
  write_file(path, "old", false);
  const pid_t child = fork();
  if (child == 0) {
    Replacement next(path, open_locked(path));
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(names().size(), 2u);
  EXPECT_EQ(content(path), "old");
  open_locked(path);
  EXPECT_EQ(names().size(), 1u);
}

TEST_F(SafeFile, WritersAtOnceLeaveOneWholeFile) {
  constexpr std::size_t size = 100000;
  write_file(path, std::string(size, 'a'), false);
  std::vector<pid_t> writers;
  for (const char letter : {'b', 'c', 'd'}) {
    writers.push_back(fork());
    if (writers.back() == 0) {
      try {
        for (int k = 0; k < 15; ++k) write_file(path, std::string(size, letter), true);
      } catch (const InputError&) {
        _exit(1);
      }
      _exit(0);
    }
  }
  const auto whole = [&] {
    const std::string found = content(path);
    return found.size() == size && found == std::string(size, found[0]);
  };
  for (const pid_t writer : writers) {
    int status = 0;
    while (waitpid(writer, &status, WNOHANG) == 0) ASSERT_TRUE(whole());
    EXPECT_EQ(status, 0);
  }
  EXPECT_TRUE(whole());
  EXPECT_EQ(names().size(), 1u);
}

TEST_F(SafeFile, AtAFileSizeLimitTheOldOneStays) {
  write_file(path, "old", false);
  rlimit saved{};
  getrlimit(RLIMIT_FSIZE, &saved);
  const rlimit lower{1000, saved.rlim_max};
  setrlimit(RLIMIT_FSIZE, &lower);
  const std::string words = message([&] { write_file(path, std::string(5000, 'n'), true); });
  setrlimit(RLIMIT_FSIZE, &saved);
  EXPECT_EQ(words, path.string() + ": File too large");
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(names().size(), 1u);
}

}  // namespace
}  // namespace cairn
