// The header of a PLY file: which elements follow, how many, and what each holds.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cairn {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool list = false;
  PlyType count_type = PlyType::uint8;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint32_t count = 0;
  std::size_t line = 0;  ///< of the file
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0, lines = 0;  ///< of the header
};

std::size_t size_of(PlyType type);
bool is_integer(PlyType type);

/// Reads the header. @throws InputError "NAME:LINE: what is wrong".
PlyHeader read_ply_header(std::string_view bytes, const std::string& name);

}  // namespace cairn
