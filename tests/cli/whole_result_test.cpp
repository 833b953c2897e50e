// `cairn info`, and what can be saved from damaged results.
#include <hdf5.h>

#include <cstring>

#include "cli/program.h"
#include "cli/scenes.h"
#include "io/hdf5.h"
#include "io/results.h"

namespace cairn::cli {
namespace {

/// Twelve grains fall together, are cut and scaled, and go on.
const std::string kStages = R"(title = "Stages"
seed = 3
[[cloud]]
count = 12
filling = 0.3
size = 10
density = 3000
[[cloud.shape]]
shape = "tetrahedron"
[[cloud.shape]]
shape = "sphere"
[[material]]
name = "n"
cohesion = 0.1
[gravity]
method = "direct"
interval = 5
[[stage]]
name = "fall"
duration = 800
[[stage]]
name = "cut"
[stage.carve.region]
kind = "ball"
radius = 60
[[stage]]
name = "bulk"
[stage.scale]
density = 2000
by = "mass"
[[stage]]
name = "rest"
duration = 400
[output]
snapshot_interval = 100
series_interval = 20
)";

std::string after(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  return at == std::string::npos ? "" : text.substr(at + word.size(), text.find('\n', at) - at - word.size());
}

TEST(Info, TellsWhatAFileIsAndWhetherItIsWhole) {
  const Folder folder;
  folder.write("stages.toml", kStages);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "stages.toml"})));
  const Outcome info = cairn(folder, {"info", "stages.h5", "--verify"});
  ASSERT_TRUE(succeeded(info));
  for (const char* word : {"Stages", "cairn 0.1.0", "finished", "'fall'", "'cut'", "'bulk'", "'rest'",
                           "snapshots", "series", "whole", "digest"})
    EXPECT_TRUE(contains(info.out, word)) << word << '\n' << info.out;

  // The same run again, and in pieces: equal bytes, equal digests.
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "stages.toml", "-o", "again.h5"})));
  EXPECT_TRUE(read_bytes(folder / "stages.h5") == read_bytes(folder / "again.h5"));
  EXPECT_EQ(after(cairn(folder, {"info", "again.h5", "--verify"}).out, "digest"), after(info.out, "digest"));
  folder.write("other.toml", with(kStages, "seed = 3", "seed = 4"));
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "other.toml"})));
  EXPECT_NE(after(cairn(folder, {"info", "other.h5", "--verify"}).out, "digest"), after(info.out, "digest"));
}

TEST(Info, SavesTheLastWholeSnapshotOfADamagedFileAsAPile) {
  const Folder folder;
  folder.write("stages.toml", kStages);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "stages.toml"})));
  const std::string sound = read_bytes(folder / "stages.h5");
  const std::size_t snapshots = ResultFile::open(folder / "stages.h5").snapshots().size();
  std::vector<Vec3> last;
  ResultFile::open(folder / "stages.h5").read_snapshot(snapshots - 2, {{"velocity", "", "", &last, "body"}});

  // A byte of the last snapshot's velocities is another, and the file ends too early.
  std::vector<Vec3> velocity;
  ResultFile::open(folder / "stages.h5")
      .read_snapshot(snapshots - 1, {{"velocity", "", "", &velocity, "body"}});
  std::string needle(sizeof(Vec3), '\0');
  std::memcpy(needle.data(), &velocity[0], sizeof(Vec3));
  std::string damaged = sound;
  std::size_t found = 0;
  for (std::size_t at = damaged.find(needle); at != std::string::npos;
       at = damaged.find(needle, at + 1), ++found)
    damaged[at] ^= 1;
  ASSERT_GE(found, 1u);
  folder.write("damaged.h5", damaged.substr(0, damaged.size() - 100));
  EXPECT_TRUE(refused(cairn(folder, {"info", "damaged.h5", "--verify"}), {"damaged.h5"}));
  const Outcome saved = cairn(folder, {"info", "damaged.h5", "--salvage", "pile.h5"});
  EXPECT_EQ(saved.code, 0) << saved.err;
  EXPECT_TRUE(contains(saved.out, "snapshot " + std::to_string(snapshots - 2))) << saved.out << saved.err;
  EXPECT_TRUE(succeeded(cairn(folder, {"info", "pile.h5", "--verify"})));
  EXPECT_TRUE(succeeded(cairn(folder, {"summary", "pile.h5"})));

  folder.write("more.toml",
               "pile = \"pile.h5\"\n[[material]]\nname = \"n\"\n[[stage]]\nname = \"on\"\nduration = 1e-6\n");
  ASSERT_EQ(cairn(folder, {"run", "more.toml"}).code, 0);
  std::vector<Vec3> first;
  ResultFile::open(folder / "more.h5").read_snapshot(0, {{"velocity", "", "", &first, "body"}});
  EXPECT_EQ(first, last);
}

TEST(EditedScene, IsWarnedOf) {
  const Folder folder;
  const std::string scene = with(kStages, "duration = 800", "duration = 80");
  folder.write("stages.toml", scene);
  ASSERT_TRUE(succeeded(cairn(folder, {"run", "stages.toml"})));
  const hid_t file = H5Fopen((folder / "stages.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  h5::write_attribute(file, "scene", with(scene, "density = 2000", "density = 2500"));
  H5Fclose(file);
  const Outcome resumed = cairn(folder, {"resume", "stages.h5", "--until", "500"});
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_TRUE(contains(resumed.err, "scene has been edited")) << resumed.err;
}

TEST(Scale, BeyondReasonIsRefused) {
  const Folder folder;
  for (const char* key :
       {"density = 1e-300\nvolume = 1e30", "density = 1\nvolume = 1e30", "density = 1e9\nvolume = 1e-30"}) {
    folder.write("tiny.toml",
                 with(kStages, "density = 2000\nby = \"mass\"", std::string(key) + "\nby = \"size\""));
    const Outcome end = cairn(folder, {"run", "tiny.toml", "--force"});
    EXPECT_EQ(end.code, 2) << key;
    EXPECT_TRUE(contains(end.err, "key 'stage[2].scale")) << end.err;
    EXPECT_TRUE(contains(end.err, "expected")) << end.err;
  }
}

}  // namespace
}  // namespace cairn::cli
