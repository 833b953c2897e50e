#include "shape/signed_distance.h"

#include <algorithm>
#include <cmath>

#include "core/elementary.h"

namespace cairn {

SignedDistance::SignedDistance(const SolidMesh& solid)
    : tree_(solid.surface),
      corners_(solid.surface.triangles),
      edge_normals_(corners_.size()),
      vertex_normals_(solid.surface.vertices.size(), Vec3::Zero()) {
  for (std::uint32_t t = 0; t < corners_.size(); ++t) {
    const TriangleShape& shape = tree_.triangle(t);
    for (std::size_t k = 0; k < 3; ++k) {
      edge_normals_[t][k] = shape.normal + tree_.triangle(solid.neighbours[t][k]).normal;
      const Vec3 next = shape.corner[(k + 1) % 3] - shape.corner[k],
                 last = shape.corner[(k + 2) % 3] - shape.corner[k];
      vertex_normals_[corners_[t][k]] += arc_tangent(next.cross(last).norm(), next.dot(last)) * shape.normal;
    }
  }
}

SignedDistance::Answer SignedDistance::operator()(const Vec3& x) const {
  const NearestTriangle nearest = tree_.nearest(x);
  const NearestPoint& at = nearest.at;
  Vec3 normal = tree_.triangle(nearest.triangle).normal;
  if (at.part == NearestPoint::Part::edge) normal = edge_normals_[nearest.triangle][at.corner];
  if (at.part == NearestPoint::Part::vertex) normal = vertex_normals_[corners_[nearest.triangle][at.corner]];
  Answer answer{at.distance, at.point, normal.normalized(), nearest.triangle};
  const Vec3 arm = x - at.point;
  if (!(at.distance > 0.0)) return answer;
  if (arm.dot(normal) < 0.0) answer.distance = -at.distance;
  if (at.part != NearestPoint::Part::face) answer.normal = arm / answer.distance;
  return answer;
}

}  // namespace cairn
