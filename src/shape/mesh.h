// Triangle meshes: containers and obstacles read from files.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/math.h"

namespace cairn {

/// A surface of triangles, open or closed. Triangles that meet share their vertices.
struct TriangleMesh {
  std::vector<Vec3> vertices;                           ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
};

/// What welding changed, and what there is to say of the file that the mesh was read from.
struct Welding {
  std::vector<std::uint32_t> kept;   ///< the triangles that are left, as numbered before
  double farthest = 0.0;             ///< m, between two vertices that became one
  std::size_t flat = 0, copies = 0;  ///< triangles left out: without area, with the vertices of another
  bool cut = false;                  ///< the file has polygons, whose triangles are numbered
  std::string far_off = {};          ///< a line on the digits lost to a distance from the origin, or nothing
};

/// "facet 12 of the file", or "... of the file cut into triangles": what messages call triangle 11 of a file.
std::string facet_of_file(std::size_t triangle, bool cut);

/// "obj", "stl", "ply" or "off" by the extension of a file's name; empty: no mesh that can be read.
std::string mesh_kind(const std::filesystem::path& path);

/// Reads an OBJ, STL, PLY or OFF file whose lengths are in units of `unit` metres. Polygons are cut into
/// triangles; vertices closer than a millionth of the mesh's extent become one; triangles without area and
/// copies of a triangle are left out. Coordinates have single precision (assimp): `welding` tells where that
/// takes more than a millionth of the extent.
/// @throws InputError "FILE: what is wrong" when the file cannot be read, holds no triangle or lies so far
/// from its origin that single precision takes more than a thousandth of the extent.
TriangleMesh load_mesh(const std::filesystem::path& path, double unit, Welding* welding = nullptr);

/// The same from the bytes of a file called `name`; `kind` is "obj", "stl", "ply" or "off". Files that take
/// more than `seconds` of computing are refused.
TriangleMesh parse_mesh(std::string_view bytes, const std::string& kind, const std::string& name, double unit,
                        double seconds = 60.0, Welding* welding = nullptr);

/// The mesh of a file called `name` from the vertices and corners that it holds; `cut`: of its polygons.
TriangleMesh make_mesh(const std::vector<std::array<float, 3>>& vertices,
                       std::vector<std::array<std::uint32_t, 3>> triangles, const std::string& name,
                       double unit, Welding* welding = nullptr, bool cut = false);

/// The same surface with vertices within `tolerance` (m) of each other welded, without triangles that have no
/// area or repeat another's vertices. Vertices that no triangle uses are left out.
TriangleMesh weld(const TriangleMesh& mesh, double tolerance, Welding* welding = nullptr);

/// The text of an OBJ file with the given number of significant digits, lengths in units of `unit` metres.
std::string obj_text(const TriangleMesh& mesh, double unit = 1.0, int digits = 17);

}  // namespace cairn
