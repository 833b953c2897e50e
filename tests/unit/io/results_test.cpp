#include "io/results.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "core/error.h"
#include "core/random.h"
#include "folder.h"

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

/// The message of the InputError that `work` must throw: one line.
std::string message(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

#define EXPECT_MESSAGE(work, part) \
  EXPECT_NE(message([&] { work; }).find(part), std::string::npos) << message([&] { work; })

class Results : public testing::Test {
 protected:
  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }

  const Folder scratch;
  const fs::path folder = scratch.path();
  fs::path path = folder / "run.h5";
};

/// One of every type a field can have.
struct Everything {
  std::vector<double> doubles;
  std::vector<float> floats;
  std::vector<Vec3> vectors;
  std::vector<Vec3f> small_vectors;
  std::vector<Quat> quaternions;
  std::vector<std::uint32_t> u32;
  std::vector<std::uint16_t> u16;
  std::vector<std::uint8_t> u8;
  std::vector<std::string> strings;
  double number = 0.0;
  std::uint64_t unsigned_number = 0;
  std::int64_t signed_number = 0;
  bool flag = false;
  Vec3 vector = Vec3::Zero();
  std::string text;

  FieldTable table() {
    return {{"doubles", "m", "help of it", &doubles},
            {"floats", "", "", &floats},
            {"group/vectors", "m/s", "", &vectors},
            {"group/small_vectors", "m/s", "", &small_vectors},
            {"group/deeper/quaternions", "", "", &quaternions},
            {"u32", "", "", &u32},
            {"u16", "", "", &u16},
            {"u8", "", "", &u8},
            {"strings", "", "", &strings},
            {"number", "J", "", &number},
            {"unsigned_number", "", "", &unsigned_number},
            {"signed_number", "", "", &signed_number},
            {"flag", "", "", &flag},
            {"vector", "", "", &vector},
            {"text", "", "", &text}};
  }

  void fill(std::size_t n) {
    Random random(n, 1);
    const double odd[] = {
        std::numeric_limits<double>::infinity(), -0.0, std::numeric_limits<double>::denorm_min(),
        std::bit_cast<double>(0x7ff8000000001234u), std::bit_cast<double>(0xfff0000000000001u)};
    for (std::size_t i = 0; i < n; ++i) {
      doubles.push_back(i < 5 ? odd[i] : std::bit_cast<double>(random.bits()));
      floats.push_back(static_cast<float>(random.uniform()));
      vectors.push_back(random.direction());
      small_vectors.push_back(random.direction().cast<float>());
      quaternions.push_back(random.rotation());
      u32.push_back(static_cast<std::uint32_t>(random.bits()));
      u16.push_back(static_cast<std::uint16_t>(random.bits()));
      u8.push_back(static_cast<std::uint8_t>(random.bits()));
      strings.push_back(std::string(i % 7, 'x') + (i % 2 ? "\xc3\xa9" : ""));
    }
    number = odd[3];
    unsigned_number = ~std::uint64_t{0};
    signed_number = std::numeric_limits<std::int64_t>::min();
    flag = true;
    vector = {1.0, odd[0], -0.0};
    text = "a \"scene\"\nwith lines and \xc3\xa9";
  }
};

void expect_same_bits(Everything& a, Everything& b) {
  const auto left = encode(a.table()), right = encode(b.table());
  ASSERT_EQ(left.size(), right.size());
  for (std::size_t f = 0; f < left.size(); ++f) {
    EXPECT_EQ(left[f].value.shape, right[f].value.shape) << left[f].name;
    EXPECT_EQ(left[f].value.bytes, right[f].value.bytes) << left[f].name;
  }
}

TEST_F(Results, EveryTypeReturnsBitwise) {
  // None, few (kept in headers), many (in chunks).
  for (const std::size_t n : {0, 1, 10, 50000}) {
    Everything in, out;
    in.fill(n);
    out.fill(3);
    ResultFile file = ResultFile::create(path, {}, true);
    file.write_static("constants", in.table());
    file.add_snapshot(1.5, "settle", in.table());
    file.commit(in.table());
    const ResultFile read = ResultFile::open(path);
    read.read_checkpoint(out.table());
    expect_same_bits(in, out);
    Everything constants, snapshot;
    read.read_static("constants", constants.table());
    expect_same_bits(in, constants);
    read.read_snapshot(0, snapshot.table());
    expect_same_bits(in, snapshot);
  }
}

TEST_F(Results, QuaternionsAreStoredScalarFirst) {
  std::vector<Quat> quaternions{Quat(1.0, 2.0, 3.0, 4.0)};
  ResultFile file = ResultFile::create(path, {}, false);
  file.commit({{"q", "", "", &quaternions}});
  const hid_t raw = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);  // as any other program would read it
  ASSERT_GE(raw, 0);
  const hid_t dataset = H5Dopen2(raw, "/checkpoint/q", H5P_DEFAULT);
  double q[4] = {};
  EXPECT_GE(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, q), 0);
  H5Dclose(dataset);
  H5Fclose(raw);
  EXPECT_EQ(q[0], 1.0);
  EXPECT_EQ(q[1], 2.0);
  EXPECT_EQ(q[3], 4.0);
}

TEST_F(Results, AttributesKeepALongScene) {
  std::string scene(300000, 's'), title = "two \"piles\"";
  std::uint64_t seed = ~std::uint64_t{0};
  ResultFile file = ResultFile::create(
      path, {{"scene", "", "", &scene}, {"title", "", "", &title}, {"seed", "", "", &seed}}, false);
  file.commit({});
  std::string scene_read, title_read;
  std::uint64_t seed_read = 0;
  ResultFile::open(path).read_attributes(
      {{"scene", "", "", &scene_read}, {"title", "", "", &title_read}, {"seed", "", "", &seed_read}});
  EXPECT_EQ(scene_read, scene);
  EXPECT_EQ(title_read, title);
  EXPECT_EQ(seed_read, seed);
}

TEST_F(Results, ContinuesWhereItStopped) {
  const std::vector<SeriesColumn> columns{{"time", "s", "time"}, {"energy", "J", "all of it"}};
  std::vector<double> x{1.0, 2.0};
  {
    ResultFile file = ResultFile::create(path, {}, false);
    EXPECT_FALSE(fs::exists(path));
    file.declare_series(columns);
    for (double t = 0.0; t < 3.0; ++t) file.add_series_row(std::vector{t, 10.0 * t});
    file.add_snapshot(0.0, "settle", {{"x", "m", "", &x}});
    file.commit({{"x", "", "", &x}});
    file.add_snapshot(99.0, "never committed", {{"x", "m", "", &x}});
  }
  x = {3.0, 4.0, 5.0};
  {
    ResultFile file = ResultFile::open_to_continue(path);
    ASSERT_EQ(file.snapshots().size(), 1u);
    file.declare_series(columns);
    EXPECT_MESSAGE(file.declare_series({{"time", "s", ""}}), "series");
    for (double t = 3.0; t < 2000.0; ++t) file.add_series_row(std::vector{t, 10.0 * t});
    file.add_snapshot(7.5, "spin", {{"x", "m", "", &x}});
    file.finish({{"x", "", "", &x}}, "failed at 7.5 s");
  }
  const ResultFile file = ResultFile::open(path);
  EXPECT_TRUE(file.finished());
  EXPECT_EQ(file.outcome(), "failed at 7.5 s");
  ASSERT_EQ(file.snapshots().size(), 2u);
  EXPECT_EQ(file.snapshots()[1].time, 7.5);
  EXPECT_EQ(file.snapshots()[1].stage, "spin");
  ASSERT_EQ(file.series_columns().size(), 2u);
  EXPECT_EQ(file.series_columns()[0].name, "time");  // in the order in which they were declared
  EXPECT_EQ(file.series_columns()[1].unit, "J");
  const std::vector<double> energy = file.read_series("energy");
  ASSERT_EQ(energy.size(), 2000u);
  for (std::size_t i = 0; i < energy.size(); ++i) ASSERT_EQ(energy[i], 10.0 * static_cast<double>(i));
  std::vector<double> first, last, checkpoint;
  file.read_snapshot(0, {{"x", "", "", &first}});
  file.read_snapshot(1, {{"x", "", "", &last}});
  file.read_checkpoint({{"x", "", "", &checkpoint}});
  EXPECT_EQ(first, (std::vector{1.0, 2.0}));
  EXPECT_EQ(last, x);
  EXPECT_EQ(checkpoint, x);
}

TEST_F(Results, EachCommitWritesWhatIsNewAndOnlyOnce) {
  std::vector<double> x{1.0};
  ResultFile file = ResultFile::create(path, {}, false);
  file.declare_series({{"time", "s", "time"}});
  for (double t = 0.0; t < 4.0; ++t) {
    file.add_series_row(std::vector{t});
    file.add_snapshot(t, "s", {{"x", "m", "", &x}});
    file.commit({{"x", "", "", &x}});
  }
  file.commit({{"x", "", "", &x}});
  EXPECT_EQ(file.read_series("time"), (std::vector{0.0, 1.0, 2.0, 3.0}));
  EXPECT_EQ(file.snapshots().size(), 4u);
  EXPECT_EQ(ResultFile::open(path).snapshots().size(), 4u);
}

TEST_F(Results, AddingWithoutACheckpointKeepsTheOldOne) {
  std::vector<double> x{1.0}, y{2.0}, found;
  {
    ResultFile file = ResultFile::create(path, {}, false);
    file.finish({{"x", "", "", &x}}, "done");
    file.write_static("analysis", {{"y", "", "", &x}});
    file.commit();
  }
  ResultFile file = ResultFile::open_to_continue(path);
  file.write_static("analysis", {{"y", "", "", &y}});
  file.commit();
  EXPECT_TRUE(file.finished());
  EXPECT_EQ(file.outcome(), "done");
  file.read_checkpoint({{"x", "", "", &found}});
  EXPECT_EQ(found, x);
  file.read_static("analysis", {{"y", "", "", &found}});
  EXPECT_EQ(found, y);
  file.commit({{"x", "", "", &x}});
  EXPECT_FALSE(ResultFile::open(path).finished());
}

TEST_F(Results, RefusesUnusablePaths) {
  spill(path, "precious");
  EXPECT_MESSAGE(ResultFile::create(path, {}, false), "exists already");
  EXPECT_EQ(slurp(path), "precious");
  EXPECT_MESSAGE(ResultFile::create(folder, {}, true), "folder");
  EXPECT_MESSAGE(ResultFile::create(folder / "none" / "run.h5", {}, false), "there is no folder");
  EXPECT_MESSAGE(ResultFile::create("", {}, false), "not the name of a file");
  const fs::path link = folder / "link.h5";
  fs::create_symlink("run.h5", link);
  EXPECT_MESSAGE(ResultFile::create(link, {}, true), "symbolic link");
  EXPECT_MESSAGE(ResultFile::open_to_continue(link), "symbolic link");
  fs::remove(link);
  if (geteuid() != 0) {
    fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_MESSAGE(ResultFile::create(folder / "new.h5", {}, false), "ermission");
    fs::permissions(folder, fs::perms::owner_all);
  }
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(Results, OverwritesOnlyWithTheFirstCommit) {
  spill(path, "precious");
  EXPECT_MESSAGE(ResultFile::create(path, {}, true), "only a result file");
  EXPECT_EQ(slurp(path), "precious");
  fs::remove(path);
  ResultFile::create(path, {}, false).finish({}, "first");
  const std::string first = slurp(path);
  {
    const ResultFile file = ResultFile::create(path, {}, true);
    EXPECT_EQ(files_in_folder(), 1u);
  }
  EXPECT_EQ(slurp(path), first);
  ResultFile file = ResultFile::create(path, {}, true);
  file.commit({});
  EXPECT_FALSE(ResultFile::open(path).finished());
}

TEST_F(Results, DoesNotReplaceWhatAppearedMeanwhile) {
  ResultFile file = ResultFile::create(path, {}, false);
  spill(path, "precious");
  EXPECT_MESSAGE(file.commit({}), "exists");
  EXPECT_EQ(slurp(path), "precious");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(Results, RefusesWhatIsNoResult) {
  EXPECT_MESSAGE(ResultFile::open(path), "No such file");
  EXPECT_MESSAGE(ResultFile::open_to_continue(path), "No such file");
  EXPECT_MESSAGE(ResultFile::open(folder), "folder");
  EXPECT_MESSAGE(ResultFile::open_to_continue(folder), "folder");
  spill(path, "");
  EXPECT_MESSAGE(ResultFile::open(path), "not a sound HDF5 file");
  spill(path, std::string(100000, 'g'));
  EXPECT_MESSAGE(ResultFile::open(path), "not a sound HDF5 file");
  fs::remove(path);
  H5Fclose(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_MESSAGE(ResultFile::open(path), "not a result of this program");
  EXPECT_EQ(message([&] { ResultFile::open(path); }).rfind(path.string() + ": ", 0), 0u);
}

TEST_F(Results, NamesTheFieldThatDoesNotFit) {
  std::vector<double> x{1.0, 2.0};
  std::vector<Vec3> v(3, Vec3::Zero());
  {
    ResultFile file = ResultFile::create(path, {}, false);
    file.add_snapshot(0.0, "s", {{"x", "", "", &x}, {"v", "", "", &v}});
    file.commit();
  }
  const ResultFile file = ResultFile::open(path);
  std::vector<float> f;
  std::vector<Quat> q;
  double one = 0.0;
  std::string text;
  EXPECT_MESSAGE(file.read_checkpoint({{"x", "", "", &x}}), "checkpoint: missing");
  EXPECT_MESSAGE(file.read_snapshot(1, {{"x", "", "", &x}}), "no snapshot 1");
  EXPECT_MESSAGE(file.read_snapshot(0, {{"z", "", "", &x}}), "snapshots/000000/z: missing");
  EXPECT_MESSAGE(file.read_snapshot(0, {{"x/y", "", "", &x}}), "snapshots/000000/x/y: missing");
  EXPECT_MESSAGE(file.read_snapshot(0, {{"x", "", "", &f}}),
                 "snapshots/000000/x: expected N f32, found 2 f64");
  EXPECT_MESSAGE(file.read_snapshot(0, {{"x", "", "", &v}}), "x: expected N x 3 f64, found 2 f64");
  EXPECT_MESSAGE(file.read_snapshot(0, {{"v", "", "", &q}}), "v: expected N x 4 f64, found 3 x 3 f64");
  EXPECT_MESSAGE(file.read_snapshot(0, {{"x", "", "", &one}}), "x: expected one f64, found 2 f64");
  EXPECT_MESSAGE(file.read_snapshot(0, {{"x", "", "", &x, "body"}, {"v", "", "", &v, "body"}}),
                 "v: has not as many rows");
  EXPECT_MESSAGE(file.read_attributes({{"scene", "", "", &text}}), "attribute scene: missing");
  EXPECT_MESSAGE(file.read_series("energy"), "series");
}

[[noreturn]] void commit_for_ever(const fs::path& path, std::uint64_t last) {
  try {
    ResultFile file = last == 0 ? ResultFile::create(path, {}, false) : ResultFile::open_to_continue(path);
    file.declare_series({{"step", "", ""}});
    for (std::uint64_t step = last + 1;; ++step) {
      std::vector<double> x(20000, static_cast<double>(step));
      file.add_series_row(std::vector{static_cast<double>(step)});
      file.add_snapshot(static_cast<double>(step), "s", {{"step", "", "", &step}});
      file.commit({{"step", "", "", &step}, {"x", "", "", &x}});
    }
  } catch (const std::exception&) {
    _exit(1);
  }
}

TEST_F(Results, KilledAtAnyTimeTheFileIsWhole) {
  Random random(11, 1);
  std::uint64_t last = 0;
  for (int round = 0; round < 20; ++round) {
    const pid_t child = fork();
    if (child == 0) commit_for_ever(path, last);
    // Not before the first commit, and then at any time.
    while (!fs::exists(path)) {
      ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "the child has died";
      usleep(1000);
    }
    usleep(static_cast<useconds_t>(random.uniform(0.0, 60000.0)));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));

    const ResultFile file = ResultFile::open(path);
    std::uint64_t step = 0;
    std::vector<double> x;
    file.read_checkpoint({{"step", "", "", &step}, {"x", "", "", &x}});
    EXPECT_EQ(x, std::vector<double>(20000, static_cast<double>(step)));
    EXPECT_GE(step, last);
    EXPECT_EQ(file.snapshots().size(), step);
    EXPECT_EQ(file.read_series("step").size(), step);
    last = step;
  }
  EXPECT_GT(last, 1u);
  { ResultFile::open_to_continue(path).commit(); }
  EXPECT_EQ(files_in_folder(), 1u);  // what the killed ones left is gone
}

TEST_F(Results, OthersFilesWithNamesLikeOursAreLeft) {
  spill(folder / "precious", "precious");
  for (const char* name : {"run.h5.part", "run.h5.0123456789abcdef.part", "run.h5.xdmf.part"})
    fs::create_symlink("precious", folder / name);
  {
    ResultFile file = ResultFile::create(path, {}, false);
    for (int k = 0; k < 3; ++k) file.commit({});
  }
  EXPECT_EQ(slurp(folder / "precious"), "precious");
  EXPECT_EQ(files_in_folder(), 5u);
}

TEST_F(Results, AFullDiskLeavesTheOldFileAndLosesNothing) {
  std::vector<double> small{1.0}, large(200000, 2.0);
  ResultFile file = ResultFile::create(path, {}, false);
  file.declare_series({{"time", "s", ""}});
  file.commit({{"x", "", "", &small}});
  const std::string before = slurp(path);
  file.add_series_row(std::vector{1.0});
  for (int k = 0; k < 5; ++k) file.add_snapshot(k, "s", {{"x", "", "", &large}});
  rlimit saved{};
  getrlimit(RLIMIT_FSIZE, &saved);
  // Ends within the copy, within the first written bytes, within the data, and just before the end.
  for (const rlim_t limit : {100u, 7000u, 9000u, 30000u, 1000000u, 5000000u, 9610000u}) {
    const rlimit lower{limit, saved.rlim_max};
    setrlimit(RLIMIT_FSIZE, &lower);
    const std::string text = message([&] { file.commit({{"x", "", "", &large}}); });
    setrlimit(RLIMIT_FSIZE, &saved);
    EXPECT_EQ(text, path.string() + ": File too large") << limit;
    EXPECT_TRUE(slurp(path) == before) << limit;
    EXPECT_EQ(files_in_folder(), 1u);
  }
  EXPECT_EQ(H5Fget_obj_count(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_ALL), 0);
  file.commit({{"x", "", "", &large}});
  const ResultFile read = ResultFile::open(path);
  EXPECT_EQ(read.snapshots().size(), 5u);
  EXPECT_EQ(read.read_series("time"), std::vector{1.0});
  std::vector<double> x;
  read.read_snapshot(4, {{"x", "", "", &x}});
  EXPECT_EQ(x, large);
}

TEST_F(Results, ReplacedCheckpointsTakeNoRoom) {
  for (const std::size_t n : {20, 300, 20000}) {
    Random random(n, 3);
    ResultFile file = ResultFile::create(path, {}, true);
    file.declare_series({{"time", "s", ""}});
    std::vector<Vec3> snapshot(n, Vec3::Ones());
    std::size_t stored = 0, checkpoint = 0;
    for (int commit = 0; commit < 100; ++commit) {
      std::vector<double> a(n / 2 + random.bits() % n), b(random.bits() % n);
      std::vector<Vec3> c(n);
      file.add_series_row(std::vector{1.0 * commit});
      if (commit % 10 == 0) {
        file.add_snapshot(commit, "s", {{"x", "", "", &snapshot}});
        stored += n * sizeof(Vec3);
      }
      file.commit({{"a", "", "", &a}, {"group/b", "", "", &b}, {"group/c", "", "", &c}});
      if (commit % 25 == 24) {  // as when a run is resumed
        file = ResultFile::create(folder / "other.h5", {}, false);
        file = ResultFile::open_to_continue(path);
      }
      checkpoint = a.size() * 8 + b.size() * 8 + c.size() * 24;
    }
    // Beyond the data themselves: a frame, and the headers of ten snapshots.
    EXPECT_LT(fs::file_size(path), stored + checkpoint + 32768) << n;
  }
}

TEST_F(Results, OneWriterAtATimeAndAnyReaders) {
  std::vector<double> x{1.0};
  ResultFile file = ResultFile::create(path, {}, false);
  for (int commit = 0; commit < 2; ++commit) {  // the lock moves on to each new version of the file
    file.commit({{"x", "", "", &x}});
    EXPECT_MESSAGE(ResultFile::open_to_continue(path), "being written by another process");
    EXPECT_MESSAGE(ResultFile::create(path, {}, true), "being written by another process");
    ResultFile::open(path).read_checkpoint({{"x", "", "", &x}});
    const hid_t raw = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);  // HDF5 takes a lock of its own
    EXPECT_GE(raw, 0);
    H5Fclose(raw);
  }
  file = ResultFile::create(folder / "other.h5", {}, false);
  ResultFile::open_to_continue(path);
}

TEST_F(Results, ADeadWriterHoldsNoLock) {
  std::vector<double> x{1.0};
  ResultFile::create(path, {}, false).commit({{"x", "", "", &x}});
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const ResultFile file = ResultFile::open_to_continue(path);
    if (write(ready[1], "x", 1) == 1) pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_MESSAGE(ResultFile::open_to_continue(path), "being written by another process");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  ResultFile::open_to_continue(path).commit({{"x", "", "", &x}});
  close(ready[0]);
  close(ready[1]);
}

TEST_F(Results, MisuseIsAnErrorOfTheProgram) {
  std::vector<double> one(1), two(2);
  ResultFile file = ResultFile::create(path, {}, false);
  file.declare_series({{"time", "s", ""}});
  EXPECT_THROW(file.add_series_row(two), std::logic_error);
  EXPECT_THROW(file.add_snapshot(0.0, "s", {{"a", "", "", &one, "body"}, {"b", "", "", &two, "body"}}),
               std::logic_error);
  EXPECT_THROW(file.read_series("time"), std::logic_error);
  file.commit({});
  EXPECT_THROW(ResultFile::open(path).commit(), std::logic_error);
}

}  // namespace
}  // namespace cairn
