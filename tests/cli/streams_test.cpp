// What the user sees never goes into his files, never stops a run, and is not lost in silence; nothing that
// goes wrong is more than one line.
#include "cli/program.h"
#include "cli/scenes.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

const std::string kTriangle = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

TEST(Streams, ClosedOnesNeitherDestroyNorStopARun) {
  const Folder folder;
  folder.write("two.toml", kTwo);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "two.toml", "-o", "whole.h5"})));
  const auto whole = contents(folder / "whole.h5");
  // Killed by its first commit: something to resume.
  const Outcome killed = cairn(folder, {"run", "two.toml", "-o", "half.h5"},
                               {.environment = fault(folder / "half.h5", "kill_after", 1, "rename")});
  ASSERT_EQ(killed.signal, 9);
  for (const std::vector<int>& closed : {std::vector{0}, {1}, {2}, {0, 1}, {0, 1, 2}})
    for (const bool resume : {false, true}) {
      if (resume) fs::copy_file(folder / "half.h5", folder / "run.h5", fs::copy_options::overwrite_existing);
      const std::vector<std::string> words =
          resume ? std::vector<std::string>{"resume", "run.h5"}
                 : std::vector<std::string>{"run", "two.toml", "-o", "run.h5", "--force"};
      const Outcome end = cairn(folder, words, {.closed = closed});
      EXPECT_EQ(end.code, 0) << end.err;
      EXPECT_TRUE(same_bits(whole, contents(folder / "run.h5")));
      if (closed == std::vector{1}) {
        EXPECT_TRUE(contains(end.err, "standard output is closed")) << end.err;
      }
    }
}

TEST(Streams, OutputThatDoesNotArriveIsAnError) {
  const Folder folder;
  folder.write("two.toml", kTwo);
  folder.write("mesh.off", kTriangle);
  const Outcome run = cairn(folder, {"run", "two.toml"}, {.out = "/dev/full"});
  EXPECT_TRUE(refused(run, {"standard output: No space left on device"}));
  EXPECT_TRUE(contains(cairn(folder, {"summary", "two.h5"}).out, "finished"));  // it was not stopped
  const std::vector<std::vector<std::string>> commands{
      {"--help"},        {"check", "--keys"},       {"check", "two.toml"},         {"summary", "two.h5"},
      {"shape", "list"}, {"shape", "show", "cube"}, {"shape", "check", "mesh.off"}};
  for (const std::vector<std::string>& words : commands) {
    EXPECT_TRUE(refused(cairn(folder, words, {.out = "/dev/full"}), {"standard output: No space left"}))
        << words.front();
    EXPECT_TRUE(refused(cairn(folder, words, {.closed = {1}}), {"standard output: is closed"}))
        << words.front();
  }
}

TEST(Streams, WhateverGoesWrongIsOneLine) {
  const Folder folder;
  folder.write("two.toml", kTwo);
  folder.write("mesh.off", kTriangle);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "two.toml"})));
  const std::string longest(300, 'n'), lines = "a\nb";
  for (const std::string& name : {longest, lines, "no/" + longest}) {
    const std::vector<std::vector<std::string>> commands{{name},
                                                         {"check", name},
                                                         {"run", name},
                                                         {"build", name},
                                                         {"resume", name},
                                                         {"summary", name},
                                                         {"xdmf", name},
                                                         {"render", name, "-o", "p.png"},
                                                         {"render", "two.h5", "-o", name},
                                                         {"shape", "show", name},
                                                         {"shape", "check", name},
                                                         {"shape", "fit", name, "--spheres", "1"},
                                                         {"shape", "fit", name, "--spheres", name}};
    for (const auto& words : commands) EXPECT_TRUE(refused(cairn(folder, words), {})) << words.front();
  }
  const std::vector<std::vector<std::string>> outputs{
      {"run", "two.toml", "-o", longest},
      {"render", "two.h5", "-o", longest + ".png"},
      {"render", "two.h5", "-o", longest + ".mp4"},
      {"shape", "list", "--sheet", longest + ".png"},
      {"shape", "show", "cube", "-o", longest + ".png"},
      {"shape", "check", "mesh.off", "-o", longest},
      {"shape", "fit", "mesh.off", "--spheres", "1", "-o", longest}};
  for (const auto& words : outputs)
    EXPECT_TRUE(refused(cairn(folder, words), {"File name too long"})) << words.front();
}

TEST(Streams, NoTemporaryFolderIsNeeded) {
  const Folder folder;
  folder.write("two.toml", kTwo);
  const Circumstances lost{.environment = {{"TMPDIR", "/no/such/folder"}}};
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "two.toml"}, lost)));
  for (const char* picture : {"p.png", "p.mp4"}) {
    const Outcome drawn = cairn(
        folder, {"render", "two.h5", "-o", picture, "--width", "64", "--height", "64", "--draft"}, lost);
    if (contains(drawn.err, "ffmpeg is not installed")) GTEST_SKIP() << drawn.err;
    EXPECT_TRUE(succeeded(drawn)) << picture;
    EXPECT_GT(read_bytes(folder / picture).size(), 200u);
  }
}

}  // namespace
}  // namespace cairn::cli
