// Points spread evenly over surfaces.
#pragma once

#include <vector>

#include "core/math.h"
#include "shape/mesh.h"

namespace cairn {

struct SurfaceSample {
  Vec3 point;   ///< m
  Vec3 normal;  ///< unit, of its triangle
};

/// `count` points of equal area on a mesh, of low discrepancy; the seed shifts them.
std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed);

/// `count` directions of equal solid angle (a Fibonacci spiral).
std::vector<Vec3> spiral_directions(std::size_t count);

}  // namespace cairn
