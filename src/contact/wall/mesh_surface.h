// A triangle mesh as a wall. A sphere meets it where the distance from its centre has a local minimum: faces,
// edges and vertices, each at most once.
#pragma once

#include <span>
#include <vector>

#include "contact/wall/surface.h"
#include "shape/triangle_tree.h"

namespace cairn {

/// Both sides are solid surfaces: a sphere is pushed to the side of its centre. Features are numbered faces
/// first, then edges, then vertices.
class MeshSurface {
 public:
  explicit MeshSurface(TriangleMesh mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  const TriangleTree& tree() const { return tree_; }
  std::size_t features() const { return mesh_.triangles.size() + edges_.size() + mesh_.vertices.size(); }

  /// Appends what a sphere touches, in the order of the features. `triangles`, in increasing order, holds all
  /// that are nearer to y than `radius`. Of touches in almost one direction (2 degrees) the deepest stays, so
  /// that faces which are flat but for round-off press once; edges and vertices in the tangent plane of a
  /// deeper touch are left out, so that triangles of one plane need not share them. A centre on the mesh
  /// gives arm = -radius.
  void touch(const Vec3& y, double radius, std::span<const std::uint32_t> triangles,
             std::vector<WallTouch>& touches) const;

  /// The plane, line or point of a feature as seen from y.
  WallTouch extend(std::uint32_t feature, const Vec3& y) const;

 private:
  struct Edge {
    std::uint32_t a, b;  // vertices, a < b
  };

  std::uint32_t feature(std::uint32_t triangle, const NearestPoint& nearest) const;
  /// The triangles that share an edge or a vertex.
  std::span<const std::uint32_t> around(std::uint32_t feature) const;

  TriangleMesh mesh_;
  TriangleTree tree_;
  std::vector<Edge> edges_;
  std::vector<std::array<std::uint32_t, 3>> edge_of_;  // of each triangle, from corner k to the next
  std::vector<std::uint32_t> first_, around_;          // triangles of each edge, then of each vertex
};

}  // namespace cairn
