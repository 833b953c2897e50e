#include "cli/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace cairn::cli {

namespace fs = std::filesystem;

std::string read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

namespace {

/// In the child: everything up to the program itself.
[[noreturn]] void become_cairn(const Folder& folder, const std::vector<std::string>& arguments,
                               const Circumstances& with) {
  const auto redirect = [&](const fs::path& name, int to) {
    const int fd = open((folder.path() / name).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd < 0 || dup2(fd, to) < 0) _exit(126);
  };
  redirect(with.out, STDOUT_FILENO);
  redirect(".err", STDERR_FILENO);
  for (const int fd : with.closed) close(fd);
  for (const auto& [name, value] : with.environment) setenv(name.c_str(), value.c_str(), 1);
  if (chdir((folder / "").c_str()) != 0) _exit(126);
  setenv("OMP_WAIT_POLICY", "passive", 1);  // threads share the cores with other tests
  setenv("OMP_NUM_THREADS", std::to_string(with.threads).c_str(), 1);
  if (with.file_size_limit) {
    const rlimit limit{*with.file_size_limit, *with.file_size_limit};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(126);
  }
  std::vector<char*> argv{const_cast<char*>("cairn")};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  execv(CAIRN_PROGRAM, argv.data());
  _exit(127);
}

}  // namespace

Outcome cairn(const Folder& folder, const std::vector<std::string>& arguments, const Circumstances& with) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become_cairn(folder, arguments, with);
  int status = 0;
  if (with.stop) {
    using clock = std::chrono::steady_clock;
    std::optional<clock::time_point> there;
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (!there && fs::exists(with.stop->file)) there = clock::now();
      if (there && clock::now() - *there >= std::chrono::duration<double>(with.stop->after)) {
        kill(child, with.stop->signal);
        waitpid(child, &status, 0);
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  } else {
    waitpid(child, &status, 0);
  }
  Outcome outcome;
  if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  if (fs::is_regular_file(folder.path() / with.out)) outcome.out = read_bytes(folder.path() / with.out);
  outcome.err = read_bytes(folder / ".err");
  return outcome;
}

std::map<std::string, std::string> fault(const fs::path& paths, const std::string& deed, std::size_t at,
                                         const std::string& call) {
  std::map<std::string, std::string> environment{{"LD_PRELOAD", CAIRN_FAULT_SHIM},
                                                 {"FAULT_PATHS", paths.string()},
                                                 {"FAULT_DEED", deed},
                                                 {"FAULT_AT", std::to_string(at)}};
  if (!call.empty()) environment["FAULT_CALL"] = call;
  return environment;
}

std::vector<std::string> calls(const Folder& folder, const std::vector<std::string>& arguments,
                               const fs::path& paths) {
  auto environment = fault(paths, "nothing", 0);
  environment["FAULT_LOG"] = (folder / ".calls").string();
  const Outcome end = cairn(folder, arguments, {.environment = environment});
  EXPECT_TRUE(succeeded(end));
  std::istringstream log(read_bytes(folder / ".calls"));
  fs::remove(folder / ".calls");
  return {std::istream_iterator<std::string>(log), {}};
}

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

testing::AssertionResult refused(const Outcome& outcome, const std::vector<std::string>& words) {
  const auto failure = [&](const std::string& what) {
    return testing::AssertionFailure()
           << what << "\nexit code " << outcome.code << ", signal " << outcome.signal
           << "\nstdout: " << outcome.out << "\nstderr: " << outcome.err;
  };
  if (outcome.code != 2) return failure("exit code 2 expected");
  if (lines(outcome.err) != 1 || outcome.err.back() != '\n') return failure("one line on stderr expected");
  for (const std::string& word : words)
    if (!contains(outcome.err, word)) return failure("expected in the line: " + word);
  return testing::AssertionSuccess();
}

testing::AssertionResult succeeded(const Outcome& outcome) {
  if (outcome.code == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "exit code " << outcome.code << ", signal " << outcome.signal
                                     << "\nstdout: " << outcome.out << "\nstderr: " << outcome.err;
}

namespace {

using Contents = std::map<std::string, std::string>;

/// Type class and size, shape, then the bytes.
std::string describe(hid_t type, hid_t space) {
  hsize_t dims[H5S_MAX_RANK];
  const int rank = H5Sget_simple_extent_dims(space, dims, nullptr);
  std::string text = fmt::format("{}:{}", static_cast<int>(H5Tget_class(type)), H5Tget_size(type));
  for (int k = 0; k < rank; ++k) text += fmt::format(",{}", dims[k]);
  text += '|';
  return text;
}

template <class Read>
std::string value(hid_t type, hid_t space, Read&& read) {
  std::string bytes(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * H5Tget_size(type), '\0');
  if (H5Tis_variable_str(type) > 0 || read(bytes.data()) < 0)
    throw std::runtime_error("unreadable HDF5 value");
  std::string text = describe(type, space) + bytes;
  H5Sclose(space);
  H5Tclose(type);
  return text;
}

/// Adds the object and all that is below it.
void add_object(hid_t object, const std::string& path, Contents& all) {
  if (H5Iget_type(object) == H5I_DATASET) {
    const hid_t type = H5Dget_type(object);
    all[path] = value(type, H5Dget_space(object),
                      [&](void* to) { return H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to); });
  } else {
    all[path] = "group";
    H5G_info_t info;
    H5Gget_info(object, &info);
    for (hsize_t k = 0; k < info.nlinks; ++k) {
      char name[256];
      H5Lget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT);
      const hid_t child = H5Oopen(object, name, H5P_DEFAULT);
      add_object(child, path + "/" + name, all);
      H5Oclose(child);
    }
  }
  for (int k = 0; k < H5Aget_num_attrs(object); ++k) {
    const hid_t attribute = H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, static_cast<hsize_t>(k),
                                           H5P_DEFAULT, H5P_DEFAULT);
    char name[256];
    H5Aget_name(attribute, sizeof name, name);
    const hid_t type = H5Aget_type(attribute);
    all[path + "@" + name] =
        value(type, H5Aget_space(attribute), [&](void* to) { return H5Aread(attribute, type, to); });
    H5Aclose(attribute);
  }
}

}  // namespace

Contents contents(const fs::path& path) {
  Contents all;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) throw std::runtime_error(path.string() + ": cannot be opened");
  const hid_t root = H5Gopen2(file, "/", H5P_DEFAULT);
  add_object(root, "", all);
  H5Gclose(root);
  H5Fclose(file);
  return all;
}

testing::AssertionResult same_bits(const Contents& a, const Contents& b) {
  std::string differing;
  for (const auto& [path, bytes] : a) {
    const auto it = b.find(path);
    if (it == b.end())
      differing += "\n  only in the first: " + path;
    else if (it->second != bytes)
      differing += "\n  differs: " + path;
  }
  for (const auto& [path, bytes] : b)
    if (!a.contains(path)) differing += "\n  only in the second: " + path;
  if (differing.empty()) return testing::AssertionSuccess();
  if (differing.size() > 2000) differing = differing.substr(0, 2000) + " ...";
  return testing::AssertionFailure() << differing;
}

void write_foreign_hdf5(const fs::path& path) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(H5Gcreate2(file, "bodies", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Fclose(file);
}

}  // namespace cairn::cli
