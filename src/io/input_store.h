// What InputFiles has read.
#pragma once

#include <map>
#include <string>

#include "io/inputs.h"

namespace cairn {

/// The content of one file, or its checksum where it is too large to be kept.
struct Input {
  std::string checksum;
  bool whole = false;
  std::string bytes;  ///< when whole
};

struct InputFiles::Store {
  std::filesystem::path directory;
  std::map<std::string, Input> inputs;
  std::vector<std::string> notes;
  bool closed = false;  ///< other files are not read
};

/// "xxh3-128:" and 32 hexadecimal digits.
std::string checksum_of(const std::string& bytes);

}  // namespace cairn
