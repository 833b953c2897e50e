// Sheets of triangles, two to a cell of an n by n grid.
#pragma once

#include "shape/mesh.h"

namespace cairn {

/// `vertex(u, v)`: a point of the sheet, u and v from 0 to 1.
template <class Vertex>
TriangleMesh grid_mesh(std::uint32_t n, Vertex&& vertex) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j)
      mesh.vertices.push_back(vertex(static_cast<double>(i) / n, static_cast<double>(j) / n));
  const auto at = [n](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

}  // namespace cairn
