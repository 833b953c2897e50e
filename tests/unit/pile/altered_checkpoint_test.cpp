// Checkpoints that somebody has altered are refused, or the run goes on to an end: no file leads beyond an
// array, and nothing that is not finite is written.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "folder.h"
#include "io/checksum.h"
#include "io/hdf5.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "sim/fields.h"
#include "whole_run.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

const std::string kScene = R"(title = "altered"
[[lattice]]
kind = "hcp"
shape = "dumbbell"
size = 10
density = 2500
spacing = 41
region = { kind = "ball", radius = 60 }
[[body]]
shape = "dumbbell"
size = 10
density = 2500
position = [0, 0, 200]
[[body]]
shape = "dumbbell"
size = 10
density = 2500
position = [0, 19.95, 200]
velocity = [0, -0.05, 0]
[[material]]
name = "n"
friction = 0.5
friction_rolling = 0.5
[gravity]
method = "direct"
interval = 5
[[stage]]
name = "fall"
duration = 300
impact_speed = 0.05
)";

/// A run that was stopped after some steps.
void stop_within(const fs::path& path) {
  const Scene scene = parse_scene(kScene, "altered.toml", ".");
  Run run = new_run(scene, assemble(scene), path, operate);
  EXPECT_EQ(
      run.advance({.watch = [](const Run& r) { return r.state().clock.step < 20; }, .watch_interval = 0.0}),
      RunEnd::interrupted);
}

/// How many contacts of bodies a checkpoint holds.
std::size_t contacts(const fs::path& path) {
  State state;
  ContactColumns between;
  WallColumns walls;
  ResultFile::open(path).read_checkpoint(checkpoint_fields(state, between.table(), walls));
  return between.i.size();
}

/// What became of a resume: the error, or nothing.
std::string go_on(const fs::path& path) {
  try {
    Run run = Run::resume(path, operate);
    int steps = 0;
    run.advance({.watch = [&](const Run&) { return ++steps < 30; }, .watch_interval = 0.0});
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

/// Sets the last element of a dataset and makes its checksum fit.
void alter(const fs::path& path, const std::string& name, bool to_nan) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT), type = H5Dget_type(dataset);
  const hid_t space = H5Dget_space(dataset);
  const std::size_t size = H5Tget_size(type);
  std::string bytes(size * static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), '\0');
  H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  const double real = to_nan ? std::numeric_limits<double>::quiet_NaN() : -1e300;
  const std::int64_t whole = to_nan ? -1 : 2147483647;
  if (!bytes.empty())
    std::memcpy(&bytes[bytes.size() - size],
                H5Tget_class(type) == H5T_FLOAT ? static_cast<const void*>(&real) : &whole, size);
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  h5::write_attribute(dataset, h5::kChecksum, checksum(bytes));
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(dataset);
  H5Fclose(file);
}

TEST(AlteredCheckpoint, IsRefusedOrGoesOn) {
  const Folder folder;
  const fs::path sound = folder / "sound.h5", altered = folder / "altered.h5";
  stop_within(sound);
  EXPECT_GT(contacts(sound), 1u);
  std::vector<std::string> names;
  const hid_t file = H5Fopen(sound.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t checkpoint = H5Gopen2(file, "checkpoint", H5P_DEFAULT);
  const auto visit = [](hid_t, const char* name, const H5O_info_t* info, void* list) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Ovisit2(checkpoint, H5_INDEX_NAME, H5_ITER_INC, visit, &names, H5O_INFO_BASIC);
  H5Gclose(checkpoint);
  H5Fclose(file);
  EXPECT_GT(names.size(), 60u);
  int refused = 0;
  for (const std::string& name : names)
    for (const bool to_nan : {true, false}) {
      SCOPED_TRACE(name + (to_nan ? ": NaN or -1" : ": large"));
      fs::copy_file(sound, altered, fs::copy_options::overwrite_existing);
      alter(altered, "/checkpoint/" + name, to_nan);
      const std::string said = go_on(altered);
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
      refused += !said.empty();
      const ResultFile result = ResultFile::open(altered);
      for (const char* column : {"kinetic_energy", "axis_a", "dissipated_work", "largest_overlap"})
        for (const double v : result.read_series(column)) EXPECT_TRUE(std::isfinite(v)) << column;
    }
  EXPECT_GT(refused, static_cast<int>(names.size()) / 2);
  fs::copy_file(sound, altered, fs::copy_options::overwrite_existing);
  alter(altered, "/checkpoint/contacts/j", false);
  const std::string said = go_on(altered);
  EXPECT_NE(said.find("and 2147483647 cannot touch"), std::string::npos) << said;
}

TEST(AlteredScene, IsToldAtResume) {
  const Folder folder;
  const fs::path path = folder / "run.h5";
  stop_within(path);
  EXPECT_TRUE(Run::resume(path, operate).differences().empty());
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  h5::write_attribute(file, "scene", "# edited\n" + kScene);
  H5Fclose(file);
  const std::vector<std::string> told = Run::resume(path, operate).differences();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("its scene has been edited"), std::string::npos) << told[0];
}

}  // namespace
}  // namespace cairn
