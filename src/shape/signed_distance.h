// Where points lie relative to a solid's surface.
#pragma once

#include "shape/solid_mesh.h"
#include "shape/triangle_tree.h"

namespace cairn {

/// Distances from the surface of a solid, negative inside. The side is that of the nearest face, or of the
/// mean normal of the nearest edge or vertex, each face weighted by its angle there [Baerentzen & Aanaes
/// 2005, IEEE Trans. Vis. Comp. Graph. 11, 243]: exact wherever the nearest point lies.
class SignedDistance {
 public:
  explicit SignedDistance(const SolidMesh& solid);

  struct Answer {
    double distance = 0.0;       ///< m, negative inside
    Vec3 point = Vec3::Zero();   ///< nearest on the surface
    Vec3 normal = Vec3::Zero();  ///< unit, outward: the gradient of the distance; the surface's where it is 0
    std::uint32_t triangle = 0;  ///< that holds the point
  };
  Answer operator()(const Vec3& x) const;

  /// Points of the surface are not inside.
  bool inside(const Vec3& x) const { return (*this)(x).distance < 0.0; }

  const TriangleTree& tree() const { return tree_; }

 private:
  TriangleTree tree_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<std::array<Vec3, 3>> edge_normals_;  // of the edge from corner k to the next, any length
  std::vector<Vec3> vertex_normals_;               // any length
};

}  // namespace cairn
