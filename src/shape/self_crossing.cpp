#include "shape/self_crossing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/parallel.h"
#include "shape/triangle_tree.h"

namespace cairn {
namespace {

constexpr double kClear = 1e-9;       // of the extent: this far on either side is a crossing
constexpr std::uint32_t kMany = 100;  // triangles around a vertex
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

/// Triangles of a mesh, and a tree over them.
struct Group {
  std::uint32_t hub;                   // the vertex that all have in common; kNone: none
  std::vector<std::uint32_t> members;  // triangles of the mesh
  TriangleTree tree;
};

TriangleTree tree_over(const TriangleMesh& mesh, const std::vector<std::uint32_t>& members) {
  TriangleMesh part;
  for (const std::uint32_t t : members) {
    const auto first = static_cast<std::uint32_t>(part.vertices.size());
    for (const std::uint32_t v : mesh.triangles[t]) part.vertices.push_back(mesh.vertices[v]);
    part.triangles.push_back({first, first + 1, first + 2});
  }
  return TriangleTree(part);
}

/// The edges from one vertex run along all the triangles around it, which are so many about the tip of a
/// cone that looking at each for each edge takes for ever. They form a group of their own, which those edges
/// pass by.
std::vector<Group> grouped(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> around(mesh.vertices.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) ++around[v];
  const auto root = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(mesh.triangles.size())));
  const std::uint32_t many = std::max(kMany, root);  // each edge looks at all groups: these stay few
  std::map<std::uint32_t, std::vector<std::uint32_t>> members;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const std::uint32_t most =
        std::max({a, b, c}, [&](std::uint32_t v, std::uint32_t w) { return around[v] < around[w]; });
    members[around[most] > many ? most : kNone].push_back(t);
  }
  std::vector<Group> groups;
  for (auto& [hub, triangles] : members) {
    TriangleTree tree = tree_over(mesh, triangles);
    groups.push_back({hub, std::move(triangles), std::move(tree)});
  }
  return groups;
}

class Finder {
 public:
  explicit Finder(const TriangleMesh& mesh) : mesh_(mesh), groups_(grouped(mesh)) {
    Eigen::AlignedBox3d box;
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t v : t) box.extend(mesh.vertices[v]);
    clear_ = kClear * box.diagonal().norm();
  }

  /// The first triangle that the edge from vertex a to b runs through and does not meet in one of them;
  /// kNone: none.
  std::uint32_t first_through(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& near) const {
    const Vec3 &p = mesh_.vertices[a], &q = mesh_.vertices[b];
    std::uint32_t first = kNone;
    for (const Group& group : groups_) {
      if (group.hub == a || group.hub == b) continue;
      near.clear();
      group.tree.find_along(p, q, clear_, near);
      for (const std::uint32_t n : near) {
        const std::uint32_t t = group.members[n];
        const auto& [u, v, w] = mesh_.triangles[t];
        const bool meets = a == u || a == v || a == w || b == u || b == v || b == w;
        if (t < first && !meets && runs_through(p, q, group.tree.triangle(n), clear_)) first = t;
      }
    }
    return first;
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<Group> groups_;
  double clear_ = 0.0;
};

}  // namespace

std::optional<std::pair<std::uint32_t, std::uint32_t>> find_crossing(
    const TriangleMesh& mesh, const std::vector<std::array<std::uint32_t, 3>>& neighbours) {
  const Finder finder(mesh);
  constexpr std::size_t block = 1024;
  const std::size_t count = mesh.triangles.size();
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Pair> found((count + block - 1) / block, {kNone, kNone});
  parallel_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near;
    for (std::size_t k = 3 * begin; k < 3 * end; ++k) {
      const auto t = static_cast<std::uint32_t>(k / 3);
      if (neighbours[t][k % 3] < t) continue;  // with which the edge was looked at
      const std::uint32_t other =
          finder.first_through(mesh.triangles[t][k % 3], mesh.triangles[t][(k + 1) % 3], near);
      if (other != kNone)
        found[begin / block] = std::min(found[begin / block], Pair(std::min(t, other), std::max(t, other)));
    }
  });
  const auto first = std::min_element(found.begin(), found.end());
  if (first == found.end() || first->first == kNone) return std::nullopt;
  return *first;
}

}  // namespace cairn
