// Starts the built program as a user would, in a folder of the test's own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "folder.h"

namespace cairn::cli {

/// How a program ended.
struct Outcome {
  int code = -1;    ///< exit code; -1 after a signal
  int signal = 0;   ///< that ended it; 0: none
  std::string out;  ///< what it said on stdout
  std::string err;  ///< and on stderr
};

/// A signal sent a while after a file is there.
struct Stop {
  int signal = 0;
  double after = 0.0;  ///< s
  std::filesystem::path file;
};

struct Circumstances {
  int threads = 1;
  std::optional<Stop> stop = {};
  std::optional<std::uint64_t> file_size_limit = {};  ///< bytes, RLIMIT_FSIZE
  std::vector<int> closed = {};                       ///< of the descriptors 0, 1 and 2
  std::filesystem::path out = ".out";                 ///< where stdout goes
  std::map<std::string, std::string> environment = {};
};

/// Runs `cairn ARGUMENTS` to its end, with the folder as the working directory.
Outcome cairn(const Folder& folder, const std::vector<std::string>& arguments,
              const Circumstances& with = {});

/// The environment in which the program's call number `at` (from 1) on files whose path begins with `paths`,
/// of those named `call` if given, meets `deed`: see fault_shim.c.
std::map<std::string, std::string> fault(const std::filesystem::path& paths, const std::string& deed,
                                         std::size_t at, const std::string& call = "");

/// The names of all such calls that a program makes.
std::vector<std::string> calls(const Folder& folder, const std::vector<std::string>& arguments,
                               const std::filesystem::path& paths);

/// One line on stderr that contains `words`, exit code 2.
testing::AssertionResult refused(const Outcome& outcome, const std::vector<std::string>& words);

/// Ended well, silently on stderr.
testing::AssertionResult succeeded(const Outcome& outcome);

std::string read_bytes(const std::filesystem::path& path);
std::size_t lines(const std::string& text);
bool contains(const std::string& text, const std::string& part);

/// Every dataset and attribute of an HDF5 file: its path, and its type, shape and bytes.
std::map<std::string, std::string> contents(const std::filesystem::path& path);

/// The same datasets and attributes with the same bits.
testing::AssertionResult same_bits(const std::map<std::string, std::string>& a,
                                   const std::map<std::string, std::string>& b);

/// An HDF5 file that this program did not make.
void write_foreign_hdf5(const std::filesystem::path& path);

}  // namespace cairn::cli
