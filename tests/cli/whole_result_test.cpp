// `cairn info`, what can be saved from damaged results, and checkpoints that somebody has altered.
#include <hdf5.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>

#include "cli/program.h"
#include "cli/scenes.h"
#include "io/checksum.h"
#include "io/hdf5.h"
#include "io/results.h"
#include "io/verify.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

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

/// Sets the last element of a dataset and makes its checksum fit.
void alter(const fs::path& path, const std::string& name, bool to_nan) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT), type = H5Dget_type(dataset);
  const hid_t space = H5Dget_space(dataset);
  const std::size_t size = H5Tget_size(type);
  std::string bytes(size * static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), '\0');
  H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  if (H5Tget_class(type) == H5T_FLOAT) {
    const double value = to_nan ? std::numeric_limits<double>::quiet_NaN() : -1e300;
    std::memcpy(&bytes[bytes.size() - size], &value, size);
  } else {
    const std::int64_t value = to_nan ? -1 : 2147483647;
    std::memcpy(&bytes[bytes.size() - size], &value, size);
  }
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  h5::write_attribute(dataset, h5::kChecksum, checksum(bytes));
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(dataset);
  H5Fclose(file);
}

/// Every number of a checkpoint, one after the other, is made NaN, -1 or very large. A resume refuses it in
/// one line, or ends, and the series holds nothing that its columns do not say.
TEST(Checkpoint, ResumeOfAnAlteredOneIsRefusedOrEnds) {
  const Folder folder;
  folder.write("stages.toml", with(kStages, "duration = 400", "duration = 4000"));
  const Outcome first =
      cairn(folder, {"run", "stages.toml"}, {.stop = Stop{SIGINT, 0.05, folder / "stages.h5"}});
  ASSERT_EQ(first.code, 130) << first.err;
  const std::string sound = read_bytes(folder / "stages.h5");
  const auto all = contents(folder / "stages.h5");
  int refusals = 0, tried = 0;
  for (const auto& [path, value] : all) {
    const bool text = value.starts_with("3:") || value == "group" || path.find('@') != std::string::npos;
    if (!path.starts_with("/checkpoint/") || text || value.ends_with('|')) continue;
    for (const bool to_nan : {true, false}) {
      SCOPED_TRACE(path + (to_nan ? " NaN or -1" : " large"));
      folder.write("altered.h5", sound);
      alter(folder / "altered.h5", path, to_nan);
      const Outcome resumed = cairn(folder, {"resume", "altered.h5"}, {.seconds = 20});
      ++tried;
      EXPECT_EQ(resumed.signal, 0);
      if (resumed.code == 2) {
        ++refusals;
        EXPECT_EQ(lines(resumed.err), 1u) << resumed.err;
        continue;
      }
      EXPECT_TRUE(resumed.code == 0 || resumed.code == 3) << resumed.err;
      const ResultFile file = ResultFile::open(folder / "altered.h5");
      for (const char* column : {"kinetic_energy", "axis_a", "dissipated_work", "largest_overlap"})
        for (const double v : file.read_series(column)) EXPECT_TRUE(std::isfinite(v)) << column;
    }
  }
  EXPECT_GT(tried, 80);
  EXPECT_GT(refusals, tried / 2);
}

TEST(EditedScene, IsWarnedOfAtResume) {
  const Folder folder;
  folder.write("stages.toml", kStages);
  const Outcome first =
      cairn(folder, {"run", "stages.toml"}, {.stop = Stop{SIGINT, 0.01, folder / "stages.h5"}});
  ASSERT_EQ(first.code, 130) << first.err;
  const hid_t file = H5Fopen((folder / "stages.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  h5::write_attribute(file, "scene", with(kStages, "density = 2000", "density = 2500"));
  H5Fclose(file);
  const Outcome resumed = cairn(folder, {"resume", "stages.h5"});
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
