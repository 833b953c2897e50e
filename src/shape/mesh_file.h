// The formats of mesh files: what is in the bytes, before it is checked and welded.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/math.h"

namespace cairn {

/// Polygons as a file gives them.
struct Polygons {
  std::vector<Vec3> vertices;          ///< in the unit of the file
  std::vector<std::uint32_t> corners;  ///< indices into `vertices` (not checked), polygon after polygon
  std::vector<std::size_t> ends;       ///< for each polygon where its corners end in `corners`
};

/// Reads the bytes of a file. Normals, colours, materials, points and lines are passed over.
/// @throws InputError "line N: expected ..., found ..."
/// @{
Polygons read_obj(std::string_view bytes);
Polygons read_off(std::string_view bytes);
Polygons read_stl(std::string_view bytes);  ///< text or binary
Polygons read_ply(std::string_view bytes);  ///< text or binary
/// @}

}  // namespace cairn
