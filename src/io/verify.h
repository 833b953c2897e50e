// Reading all of a result file, to tell whether it is whole and whether two hold the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cairn {

struct Verification {
  std::uint64_t datasets = 0;
  std::uint64_t bytes = 0;           ///< of the datasets
  std::string digest;                ///< XXH3-128 of names and values of everything but the root's attributes
  std::vector<std::string> damaged;  ///< one line for each object that cannot be read as it was written
};

/// Reads every dataset and attribute and compares the checksums. Equal results have equal digests, however
/// often their runs were stopped. Throws InputError when the file cannot be opened as a result at all.
Verification verify(const std::filesystem::path& path);

}  // namespace cairn
