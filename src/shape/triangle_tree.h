// Triangles prepared for distances, and a tree of boxes over them.
#pragma once

#include <vector>

#include "shape/mesh.h"

namespace cairn {

/// The point of a triangle nearest to another.
struct NearestPoint {
  enum class Part : std::uint8_t { face, edge, vertex };
  Part part = Part::face;
  std::uint8_t corner = 0;  ///< of a vertex; an edge runs from this corner to the next
  Vec3 point = Vec3::Zero();
  double distance = 0.0;  ///< m
};

/// A triangle with what its distances need.
struct TriangleShape {
  Vec3 corner[3];
  Vec3 normal;      ///< unit
  Vec3 outward[3];  ///< in the plane, away from the triangle at the edge from corner k to the next

  TriangleShape(const Vec3& a, const Vec3& b, const Vec3& c);
  NearestPoint nearest(const Vec3& y) const;
};

/// The point nearest to y of the segment from a to b; `along` receives its place, 0 at a and 1 at b.
Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& y, double& along);

/// The triangle nearest to a point, and where on it.
struct NearestTriangle {
  std::uint32_t triangle = 0;
  NearestPoint at;
};

/// A binary tree of boxes.
class TriangleTree {
 public:
  explicit TriangleTree(const TriangleMesh& mesh);

  const TriangleShape& triangle(std::uint32_t t) const { return triangles_[t]; }
  /// Appends the triangles nearer to y than `reach`, in increasing order.
  void find(const Vec3& y, double reach, std::vector<std::uint32_t>& found) const;
  /// The nearest triangle; of several, always the same one.
  NearestTriangle nearest(const Vec3& y) const;
  /// Distance of y from the mesh.
  double distance(const Vec3& y) const { return nearest(y).at.distance; }
  /// Appends the triangles whose boxes, larger by `margin` on all sides, meet the segment from p to q.
  void find_along(const Vec3& p, const Vec3& q, double margin, std::vector<std::uint32_t>& found) const;

 private:
  struct Node {
    Vec3 low, high;
    std::uint32_t begin, end;  // of order_; inner nodes have their first child next to them
    std::uint32_t second = 0;  // child; 0: a leaf
  };

  std::uint32_t build(std::uint32_t begin, std::uint32_t end, const std::vector<Vec3>& centers);

  std::vector<TriangleShape> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace cairn
