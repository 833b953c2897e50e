// A result file holds what was written and nothing else: checksums, damage, ways out of the file, versions.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <sstream>

#include "core/error.h"
#include "core/random.h"
#include "folder.h"
#include "io/checksum.h"
#include "io/results.h"
#include "io/verify.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

std::string slurp(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void spill(const fs::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

std::string message(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no InputError";
}

/// A file like that of a run of several stages: three epochs of bodies, series, snapshots, a checkpoint, a
/// scene too long for a header.
void write_run(const fs::path& path) {
  Random random(5, 5);
  std::string scene(70000, '#'), title = "damage";
  std::vector<std::string> names{"rough", "sticky"};
  ResultFile file = ResultFile::create(path, {{"title", "", "", &title}, {"scene", "", "", &scene}}, false);
  file.write_static("materials", {{"name", "", "", &names}});
  file.declare_series({{"time", "s", "time"}, {"energy", "J", "all of it"}});
  for (std::uint64_t epoch = 0; epoch < 3; ++epoch) {
    const std::size_t n = 700 - 200 * epoch;
    std::vector<Vec3> x(n);
    std::vector<std::uint32_t> touching(n, epoch == 1 ? ~0u : 0u);
    for (Vec3& place : x) place = random.direction();
    file.write_static("bodies", {{"inertia", "kg m^2", "", &x, "body"}});
    for (int k = 0; k < 2; ++k) {
      file.add_series_row(std::vector{1.0 * k, 0.0});
      file.add_snapshot(k, "s", {{"x", "m", "", &x, "body"}, {"t", "", "", &touching, "body"}}, epoch);
    }
    file.write_static("bodies_" + std::to_string(epoch), {{"inertia", "kg m^2", "", &x, "body"}});
    file.commit({{"x", "", "", &x}, {"contacts/i", "", "", &touching}});
  }
}

class WholeFile : public testing::Test {
 protected:
  const Folder scratch;
  const fs::path folder = scratch.path();
  const fs::path path = folder / "run.h5";
};

TEST(Checksum, IsXxh3AndComesInPieces) {
  EXPECT_EQ(checksum(""), "99aa06d3014798d86001c324468d497f");  // as `xxhsum -H2` says
  const std::string text(100000, 'x');
  RunningChecksum pieces;
  for (std::size_t at = 0; at < text.size(); at += 7777)
    pieces.add(std::as_bytes(std::span(text)).subspan(at, std::min<std::size_t>(7777, text.size() - at)));
  EXPECT_EQ(pieces.digest(), checksum(text));
  RunningChecksum copy = pieces;
  copy.add(std::as_bytes(std::span(text)));
  EXPECT_NE(copy.digest(), pieces.digest());
}

TEST_F(WholeFile, EqualContentIsEqualBytes) {
  write_run(path);
  write_run(folder / "again.h5");
  EXPECT_TRUE(slurp(path) == slurp(folder / "again.h5"));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto visit = [](hid_t, const char* name, const H5O_info_t* info, void*) -> herr_t {
    EXPECT_TRUE(info->atime == 0 && info->mtime == 0 && info->ctime == 0 && info->btime == 0) << name;
    return 0;
  };
  EXPECT_EQ(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit, nullptr, H5O_INFO_TIME), 0);
  H5Fclose(file);
  EXPECT_EQ(verify(path).digest, verify(folder / "again.h5").digest);
}

/// Damages `sound` in `rounds` ways and reads it. Exit code of a process: 0 when each was refused or read as
/// before; else what was accepted.
int accept_no_damage(const std::string& sound, const fs::path& path, int rounds) {
  const Verification whole = verify(path);
  if (!whole.damaged.empty()) return 9;
  Random random(7, 7);
  const auto any = [&](std::size_t below) { return static_cast<std::size_t>(random.bits() % below); };
  for (int round = 0; round < rounds; ++round) {
    std::string damaged = sound;
    const int kind = round % 3;
    if (kind == 0) damaged[any(sound.size())] ^= static_cast<char>(1u << any(8));
    if (kind == 1) {  // what Fletcher-32 does not see
      std::size_t at = 2 * any(sound.size() / 2);
      const auto blind = [&] {
        return std::memcmp(&damaged[at], "\0\0", 2) == 0 || std::memcmp(&damaged[at], "\xff\xff", 2) == 0;
      };
      while (!blind()) at = 2 * any(sound.size() / 2);
      damaged[at] = static_cast<char>(~damaged[at]);
      damaged[at + 1] = static_cast<char>(~damaged[at + 1]);
    }
    if (kind == 2) damaged.resize(any(sound.size()));
    spill(path, damaged);
    try {
      const Verification found = verify(path);
      if (found.damaged.empty() && found.digest != whole.digest) return 1 + kind;
    } catch (const InputError&) {
    }
  }
  return 0;
}

TEST_F(WholeFile, NoDamageIsAcceptedInSilence) {
  write_run(path);
  const std::string sound = slurp(path);
  const pid_t child = fork();
  // In a process of its own because HDF5 1.10 leaks a little when it refuses a file, which a sanitizer would
  // report.
  if (child == 0) _exit(accept_no_damage(sound, path, 300));
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

/// Changes the file with HDF5 itself.
void edit(const fs::path& path, const std::function<void(hid_t)>& work) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  work(file);
  H5Fclose(file);
}

TEST_F(WholeFile, NothingOutsideTheFileIsRead) {
  std::vector<double> x(1000, 1.0);
  ResultFile::create(path, {}, false).commit({{"x", "", "", &x}});
  ResultFile::create(folder / "other.h5", {}, false).commit({{"x", "", "", &x}});
  spill(folder / "raw", std::string(8000, 'r'));
  const std::string sound = slurp(path);
  const auto dataset = [](hid_t file, const std::function<void(hid_t)>& set) {
    const hsize_t size = 1000;
    const hid_t space = H5Screate_simple(1, &size, nullptr), list = H5Pcreate(H5P_DATASET_CREATE);
    set(list);
    const hid_t made =
        H5Dcreate2(file, "/checkpoint/x", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
    EXPECT_GE(made, 0);
    H5Dclose(made);
    H5Pclose(list);
    H5Sclose(space);
  };
  struct Case {
    const char* said;
    std::function<void(hid_t)> work;
  };
  const std::string raw = (folder / "raw").string();
  for (const Case& c : {
           Case{"a link to elsewhere",
                [](hid_t file) {
                  H5Lcreate_soft("/snapshots", file, "/checkpoint/x", H5P_DEFAULT, H5P_DEFAULT);
                }},
           Case{"a link to elsewhere",
                [](hid_t file) {
                  H5Lcreate_external("other.h5", "/checkpoint/x", file, "/checkpoint/x", H5P_DEFAULT,
                                     H5P_DEFAULT);
                }},
           Case{"its data are elsewhere",
                [&](hid_t file) {
                  dataset(file, [&](hid_t list) { H5Pset_external(list, raw.c_str(), 0, 8000); });
                }},
           Case{"its data are elsewhere",
                [&](hid_t file) {
                  dataset(file, [&](hid_t list) {
                    const hsize_t size = 1000;
                    const hid_t all = H5Screate_simple(1, &size, nullptr);
                    H5Pset_virtual(list, all, "other.h5", "/checkpoint/x", all);
                    H5Sclose(all);
                  });
                }},
           Case{"behind a filter",
                [&](hid_t file) {
                  dataset(file, [&](hid_t list) {
                    const hsize_t size = 1000;
                    H5Pset_chunk(list, 1, &size);
                    H5Pset_filter(list, 32001, H5Z_FLAG_OPTIONAL, 0, nullptr);
                  });
                }},
       }) {
    spill(path, sound);
    edit(path, [&](hid_t file) {
      H5Ldelete(file, "/checkpoint/x", H5P_DEFAULT);
      c.work(file);
    });
    std::vector<double> found;
    const std::string said = message([&] {
      ResultFile::open(path).read_checkpoint({{"x", "", "", &found}});
    });
    EXPECT_NE(said.find(c.said), std::string::npos) << said;
    EXPECT_EQ(verify(path).damaged.size(), 1u);
  }
}

TEST_F(WholeFile, AnEditedSceneIsSeen) {
  std::string scene = "duration = 1", edited = "duration = 2";
  ResultFile::create(path, {{"scene", "", "", &scene}}, false).commit({});
  EXPECT_TRUE(ResultFile::open(path).scene_is_as_written());
  edit(path, [&](hid_t file) {
    const hid_t attribute = H5Aopen(file, "scene", H5P_DEFAULT), type = H5Aget_type(attribute);
    EXPECT_GE(H5Awrite(attribute, type, edited.data()), 0);
    H5Tclose(type);
    H5Aclose(attribute);
  });
  EXPECT_FALSE(ResultFile::open(path).scene_is_as_written());
  ResultFile file = ResultFile::open_to_continue(path);
  file.write_attributes({{"scene", "", "", &edited}});
  file.commit();
  EXPECT_TRUE(ResultFile::open(path).scene_is_as_written());
}

ino_t inode(const fs::path& path) {
  struct stat info {};
  EXPECT_EQ(stat(path.c_str(), &info), 0);
  return info.st_ino;
}

/// Whether the file system tells who has a file open.
bool has_leases(const fs::path& folder) {
  const int fd = open((folder / "lease").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  const bool granted = fcntl(fd, F_SETLEASE, F_WRLCK) == 0;
  close(fd);
  fs::remove(folder / "lease");
  return granted;
}

TEST_F(WholeFile, TheVersionBeforeTheLastBecomesTheNext) {
  Random random(3, 3);
  const fs::path copied = folder / "copied.h5";
  std::vector<FileDescriptor> readers;
  std::vector<std::string> seen;
  std::vector<ino_t> inodes;
  {
    // Of the one file nobody reads, each version of the other is kept open: it must be copied whole.
    ResultFile mine = ResultFile::create(path, {}, false), read = ResultFile::create(copied, {}, false);
    mine.declare_series({{"time", "s", ""}});
    read.declare_series({{"time", "s", ""}});
    for (int commit = 0; commit < 15; ++commit) {
      std::vector<double> a(random.bits() % 3000, 1.0 * commit), b(random.bits() % 3000, -1.0 * commit);
      for (ResultFile* file : {&mine, &read}) {
        for (int row = 0; row < 100; ++row) file->add_series_row(std::vector{1.0 * row});
        if (commit % 3 != 1) file->add_snapshot(commit, "s", {{"a", "m", "", &a}, {"b", "", "", &b}});
        if (commit % 5 == 4) file->write_static("constants", {{"b", "", "", &b}});
        if (commit % 7 == 6)
          file->commit();
        else
          file->commit({{"b", "", "", &b}, {"a", "", "", &a}});
      }
      readers.push_back(open_for_reading(copied));
      seen.push_back(slurp(copied));
      inodes.push_back(inode(path));
      ASSERT_TRUE(slurp(path) == seen.back()) << commit;
    }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);  // nothing is left
  for (std::size_t k = 0; k < readers.size(); ++k) {  // who reads an old version goes on reading it
    std::string now(seen[k].size() + 1, '\0');
    now.resize(static_cast<std::size_t>(pread(readers[k].get(), now.data(), now.size(), 0)));
    EXPECT_TRUE(now == seen[k]);
  }
  if (!has_leases(folder)) GTEST_SKIP() << "this file system copies";
  for (std::size_t k = 3; k < inodes.size(); ++k) EXPECT_EQ(inodes[k], inodes[k - 2]);
}

}  // namespace
}  // namespace cairn
