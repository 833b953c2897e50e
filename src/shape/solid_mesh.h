// Meshes that bound a solid: what is wrong with those that do not, and the repairs that are safe.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "shape/mesh.h"
#include "shape/shape.h"

namespace cairn {

/// The surface of one connected solid: closed, every edge shared by two triangles and every vertex
/// surrounded by one fan of them, oriented outwards, crossing itself nowhere. It may have cavities.
struct SolidMesh {
  TriangleMesh surface;
  std::vector<std::array<std::uint32_t, 3>> neighbours;  ///< across the edge from corner k to the next
  std::size_t facets = 0;  ///< of the file, whose polygons are cut into several triangles
  std::size_t cavities = 0;
  std::vector<std::string> repairs;     ///< what was changed, one line each
  std::vector<std::string> notes = {};  ///< what a user should know of how a file was read, one line each
};

/// Turns triangles that face inwards and checks everything else. `read`, if any, tells which facets of a file
/// the triangles were, for the messages; they count from 1 otherwise too.
/// @throws InputError with the first offending facet: a vertex that does not exist or is not finite, no
/// triangles, an open edge, an edge of three triangles, a vertex of two fans, one-sided surfaces, triangles
/// that cross, no volume, several separate parts.
SolidMesh make_solid(TriangleMesh mesh, const Welding* read = nullptr);

/// Reads a mesh file, see load_mesh, as the surface of a solid.
/// @throws InputError "FILE: what is wrong".
SolidMesh load_solid(const std::filesystem::path& path, double unit);

/// Volume, centroid and inertia of what a closed, outward mesh bounds, exact to round-off [Mirtich 1996, J.
/// Graphics Tools 1(2), 31; here by signed tetrahedra about the middle of the mesh].
MassProperties mass_of(const TriangleMesh& closed);

/// Semi-axes, descending, of the ellipsoid of the same volume whose principal moments have the same ratios
/// (the dynamically equivalent equal-volume ellipsoid, DEEVE).
Vec3 equivalent_ellipsoid(const MassProperties& mass);

/// The mesh with its centroid at the origin and its principal axes, of ascending moment, along x, y and z.
TriangleMesh in_principal_frame(const TriangleMesh& mesh, const MassProperties& mass);

}  // namespace cairn
