// Triangle meshes: containers and obstacles read from files.
#pragma once

#include <array>
#include <filesystem>
#include <span>
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
  std::vector<std::uint32_t> kept;  ///< facet of each triangle that is left, as numbered before or in a file
  std::vector<std::uint32_t> lines = {};  ///< of the file, of each triangle that is left; empty: it has none
  std::string name = {};                  ///< of the file
  double farthest = 0.0;                  ///< m, between two vertices that became one
  std::size_t flat = 0, copies = 0;       ///< facets left out: without area, with the vertices of another
  std::vector<std::string> notes = {};    ///< what a user should know of how a file was read, a line each
};

struct FileSurface;

/// The format of a mesh file by its extension ("obj", "gltf" ...); empty: not that of a mesh. Files with
/// other extensions are read if their text is that of a mesh.
std::string mesh_kind(const std::filesystem::path& path);

/// Reads a mesh file whose lengths are in units of `unit` metres: OBJ, STL, PLY, OFF and tables of vertices
/// and facets or of radii, in double precision; others through assimp. Polygons are cut into triangles;
/// vertices closer than a millionth of the mesh's extent become one; triangles without area and copies of a
/// triangle are left out.
/// @throws InputError "FILE:LINE: what is wrong" when anything in the file cannot be read, it holds no
/// triangle, or lies so far from its origin that rounding takes more than a thousandth of the extent.
TriangleMesh load_mesh(const std::filesystem::path& path, double unit, Welding* welding = nullptr);

/// The same from the bytes of a file called `name`; `kind` is "obj", "stl", "ply" or "off", or anything else
/// for text that tells by itself what it is.
TriangleMesh parse_mesh(std::string_view bytes, const std::string& kind, const std::string& name, double unit,
                        Welding* welding = nullptr);

/// The mesh of what a file called `name` holds.
TriangleMesh make_mesh(const FileSurface& surface, const std::string& name, double unit,
                       Welding* welding = nullptr);

/// The same surface with vertices within `tolerance` (m) of each other welded, without triangles that have no
/// area or repeat another's vertices. Vertices that no triangle uses are left out. `facet` numbers the facets
/// that triangles are parts of, ascending; they are facets of their own where it is empty.
TriangleMesh weld(const TriangleMesh& mesh, double tolerance, Welding* welding = nullptr,
                  std::span<const std::uint32_t> facet = {});

/// The text of an OBJ file with the given number of significant digits, lengths in units of `unit` metres.
std::string obj_text(const TriangleMesh& mesh, double unit = 1.0, int digits = 17);

}  // namespace cairn
