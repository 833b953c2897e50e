#include "shape/self_crossing.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "shape/triangle_tree.h"

namespace cairn {
namespace {

constexpr double kClear = 1e-9;  // of the extent: this far on either side is a crossing
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Whether the segment from p to q runs through a triangle, its border included.
bool runs_through(const Vec3& p, const Vec3& q, const TriangleShape& triangle, double clear) {
  const auto& [a, b, c] = triangle.corner;
  const double above = (p - a).dot(triangle.normal), below = (q - a).dot(triangle.normal);
  if (!(std::min(above, below) < -clear && std::max(above, below) > clear)) return false;
  // The volumes that the line makes with the edges have one sign when it passes inside.
  const Vec3 u = a - p, v = b - p, w = c - p, d = q - p;
  const double ab = d.dot(u.cross(v)), bc = d.dot(v.cross(w)), ca = d.dot(w.cross(u));
  return (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
}

class Finder {
 public:
  explicit Finder(const TriangleMesh& mesh) : mesh_(mesh), tree_(mesh) {
    Eigen::AlignedBox3d box;
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t v : t) box.extend(mesh.vertices[v]);
    clear_ = kClear * box.diagonal().norm();
  }

  /// The first triangle after t that crosses it; kNone: none.
  std::uint32_t first_after(std::uint32_t t, std::vector<std::uint32_t>& near) const {
    const auto& [a, b, c] = tree_.triangle(t).corner;
    near.clear();
    tree_.find(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), near);
    std::uint32_t first = kNone;
    for (const std::uint32_t other : near)
      if (other > t && other < first && (pierces(t, other) || pierces(other, t))) first = other;
    return first;
  }

 private:
  /// Whether an edge of triangle t that has no vertex in common with `other` runs through it.
  bool pierces(std::uint32_t t, std::uint32_t other) const {
    const auto &mine = mesh_.triangles[t], &theirs = mesh_.triangles[other];
    const auto shared = [&](std::uint32_t v) { return v == theirs[0] || v == theirs[1] || v == theirs[2]; };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mine[k], to = mine[(k + 1) % 3];
      if (shared(from) || shared(to)) continue;
      if (runs_through(mesh_.vertices[from], mesh_.vertices[to], tree_.triangle(other), clear_)) return true;
    }
    return false;
  }

  const TriangleMesh& mesh_;
  TriangleTree tree_;
  double clear_ = 0.0;
};

}  // namespace

std::optional<std::pair<std::uint32_t, std::uint32_t>> find_crossing(const TriangleMesh& mesh) {
  const Finder finder(mesh);
  constexpr std::size_t block = 1024;
  const std::size_t count = mesh.triangles.size();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found((count + block - 1) / block, {kNone, kNone});
  parallel_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    for (std::size_t t = begin; t < end; ++t) {
      const std::uint32_t other = finder.first_after(static_cast<std::uint32_t>(t), near);
      if (other == kNone) continue;
      found[begin / block] = {static_cast<std::uint32_t>(t), other};
      return;
    }
  });
  for (const auto& pair : found)
    if (pair.first != kNone) return pair;
  return std::nullopt;
}

}  // namespace cairn
