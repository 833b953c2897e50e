// Triangles of one mesh that cross each other.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "shape/mesh.h"

namespace cairn {

/// The first pair of triangles, in the order of their numbers, of which an edge of one runs through the
/// other by more than 1e-9 of the mesh's extent. Neighbours may meet in the edge or vertex that they share;
/// surfaces that only touch do not cross. `neighbours`: of a closed mesh, across the edge from corner k of a
/// triangle to the next.
std::optional<std::pair<std::uint32_t, std::uint32_t>> find_crossing(
    const TriangleMesh& mesh, const std::vector<std::array<std::uint32_t, 3>>& neighbours);

}  // namespace cairn
