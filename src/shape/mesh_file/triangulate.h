// Polygons of files into triangles.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "shape/mesh_file/file_surface.h"

namespace cairn {

/// Triangles and the facets that they are parts of, counted from 0 as in the file.
struct Triangulation {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> facet;  ///< of each triangle, ascending
};

/// Cuts facets into triangles with all of their corners, each with an area, that together cover the polygon
/// as seen along its vector area: a fan about the first corner where the polygon is convex, ears cut off
/// elsewhere. Facets without area become one triangle without area.
/// @throws InputError "NAME:LINE: facet ..." when an outline crosses itself.
Triangulation triangulate(const FileSurface& surface, const std::string& name);

/// Whether a triangle has an area: the sine of its smallest angle is more than round-off.
bool has_area(const Vec3& a, const Vec3& b, const Vec3& c);

/// "facet 12 of the file": what messages call facet 11.
std::string facet_of_file(std::size_t facet);

}  // namespace cairn
