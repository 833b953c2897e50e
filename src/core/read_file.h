// Whole files into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

namespace cairn {

/// What messages call a file, and how large it may be.
struct FileKind {
  std::string_view what = "file";                                  ///< what is expected there: "mesh file"
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();  ///< bytes
};

/// Only a regular file has an end for certain; opening a pipe would wait for ever.
/// @throws InputError "NAME: what is there instead".
void require_regular(const std::filesystem::path& path, const std::string& name, std::string_view what);

/// The content of a regular file, which messages call `name`.
/// @throws InputError "NAME: why not" for what is none, is too large or cannot be read.
std::string read_file(const std::filesystem::path& path, const std::string& name, const FileKind& kind = {});

}  // namespace cairn
