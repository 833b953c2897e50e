#include "shape/triangle_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace cairn {

namespace {

constexpr std::uint32_t kLeaf = 4;  // triangles

/// Squared distance of y from a box; not less than any limit when y is not finite.
double box_distance2(const Vec3& low, const Vec3& high, const Vec3& y) {
  return (low - y).cwiseMax(y - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& y, double& along) {
  const Vec3 edge = b - a;
  along = std::clamp((y - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return along == 1.0 ? b : Vec3(a + along * edge);
}

TriangleShape::TriangleShape(const Vec3& a, const Vec3& b, const Vec3& c)
    : corner{a, b, c}, normal((b - a).cross(c - a).normalized()) {
  for (int k = 0; k < 3; ++k) outward[k] = (corner[(k + 1) % 3] - corner[k]).cross(normal);
}

NearestPoint TriangleShape::nearest(const Vec3& y) const {
  NearestPoint best;
  best.distance = std::numeric_limits<double>::infinity();
  bool above = true;
  for (std::uint8_t k = 0; k < 3; ++k) {
    if ((y - corner[k]).dot(outward[k]) <= 0.0) continue;
    // Only edges that y lies beyond can hold the nearest point.
    above = false;
    const std::uint8_t next = k == 2 ? 0 : static_cast<std::uint8_t>(k + 1);
    double along = 0.0;
    const Vec3 point = nearest_on_segment(corner[k], corner[next], y, along);
    const double distance = (y - point).norm();
    if (!(distance < best.distance)) continue;
    best.distance = distance;
    best.point = point;
    best.part = along > 0.0 && along < 1.0 ? NearestPoint::Part::edge : NearestPoint::Part::vertex;
    best.corner = along == 1.0 ? next : k;
  }
  if (above) {
    const double height = (y - corner[0]).dot(normal);
    best.distance = std::abs(height);
    best.point = y - height * normal;
  }
  return best;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) : order_(mesh.triangles.size()) {
  triangles_.reserve(order_.size());
  std::vector<Vec3> centers;
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles_.emplace_back(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    centers.push_back((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0);
  }
  std::iota(order_.begin(), order_.end(), 0u);
  build(0, static_cast<std::uint32_t>(order_.size()), centers);
}

std::uint32_t TriangleTree::build(std::uint32_t begin, std::uint32_t end, const std::vector<Vec3>& centers) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  Vec3 first = low, last = high;  // of the centres
  for (std::uint32_t k = begin; k < end; ++k) {
    for (const Vec3& x : triangles_[order_[k]].corner) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    first = first.cwiseMin(centers[order_[k]]);
    last = last.cwiseMax(centers[order_[k]]);
  }
  nodes_.push_back({low, high, begin, end});
  if (end - begin <= kLeaf) return index;
  Eigen::Index axis = 0;
  (last - first).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return centers[a][axis] < centers[b][axis]; });
  build(begin, middle, centers);
  nodes_[index].second = build(middle, end, centers);
  return index;
}

void TriangleTree::find(const Vec3& y, double reach, std::vector<std::uint32_t>& found) const {
  const std::size_t old = found.size();
  std::uint32_t stack[64] = {0};  // the tree halves: 32 levels at most
  for (int top = 1; top > 0;) {
    const std::uint32_t index = stack[--top];
    const Node& node = nodes_[index];
    if (!(box_distance2(node.low, node.high, y) < reach * reach)) continue;
    if (node.second != 0) {
      stack[top++] = index + 1;
      stack[top++] = node.second;
      continue;
    }
    for (std::uint32_t k = node.begin; k < node.end; ++k)
      if (triangles_[order_[k]].nearest(y).distance < reach) found.push_back(order_[k]);
  }
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(old), found.end());
}

NearestTriangle TriangleTree::nearest(const Vec3& y) const {
  NearestTriangle best;
  best.at.distance = std::numeric_limits<double>::infinity();
  std::uint32_t stack[64] = {0};
  for (int top = 1; top > 0;) {
    const std::uint32_t index = stack[--top];
    const Node& node = nodes_[index];
    if (!(box_distance2(node.low, node.high, y) < best.at.distance * best.at.distance)) continue;
    if (node.second == 0) {
      for (std::uint32_t k = node.begin; k < node.end; ++k) {
        const NearestPoint at = triangles_[order_[k]].nearest(y);
        if (at.distance < best.at.distance) best = {order_[k], at};
      }
      continue;
    }
    const auto from = [&](std::uint32_t child) {
      return box_distance2(nodes_[child].low, nodes_[child].high, y);
    };
    const bool left = from(index + 1) < from(node.second);  // the nearer child is looked into first
    stack[top++] = left ? node.second : index + 1;
    stack[top++] = left ? index + 1 : node.second;
  }
  return best;
}

void TriangleTree::find_along(const Vec3& p, const Vec3& q, double margin,
                              std::vector<std::uint32_t>& found) const {
  const Vec3 middle = 0.5 * (p + q), half = 0.5 * (q - p), reach = half.cwiseAbs();
  // They are apart along an axis of the box, or along one that is perpendicular to that and the segment.
  const auto meets = [&](const Vec3& low, const Vec3& high) {
    const Vec3 away = middle - 0.5 * (low + high), size = (0.5 * (high - low)).array() + margin;
    if ((away.cwiseAbs().array() > (size + reach).array()).any()) return false;
    const Vec3 across = away.cross(half).cwiseAbs();
    return across.x() <= size.y() * reach.z() + size.z() * reach.y() &&
           across.y() <= size.z() * reach.x() + size.x() * reach.z() &&
           across.z() <= size.x() * reach.y() + size.y() * reach.x();
  };
  std::uint32_t stack[64] = {0};
  for (int top = 1; top > 0;) {
    const std::uint32_t index = stack[--top];
    const Node& node = nodes_[index];
    if (!meets(node.low, node.high)) continue;
    if (node.second != 0) {
      stack[top++] = index + 1;
      stack[top++] = node.second;
      continue;
    }
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      const auto& [a, b, c] = triangles_[order_[k]].corner;
      if (meets(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c))) found.push_back(order_[k]);
    }
  }
}

}  // namespace cairn
