// What can be saved from a damaged result file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace cairn {

struct Salvage {
  std::size_t snapshot = 0;  ///< that was saved
  double time = 0.0;         ///< s, of it
  std::size_t bodies = 0;
  std::string lost;  ///< why later ones were not, in a line; empty: there are none
};

/// Writes the last snapshot of `damaged` that is whole to `output`, as the pile of a finished run: bodies
/// with poses and momenta, without springs of contacts.
/// @throws InputError when none is whole, or `output` cannot be written.
Salvage salvage(const std::filesystem::path& damaged, const std::filesystem::path& output, bool overwrite);

}  // namespace cairn
