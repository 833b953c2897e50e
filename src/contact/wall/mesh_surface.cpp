#include "contact/wall/mesh_surface.h"

#include <algorithm>
#include <cmath>

namespace cairn {

namespace {

constexpr double kOneDirection = 0.99939;  // cosine of 2 degrees
constexpr double kTie = 1e-12;             // of the radius: distances closer than this are equal
constexpr double kLevel = 1e-5;            // of the radius: as far above a plane counts as in it

struct Hit {
  std::uint32_t triangle, feature;
  NearestPoint nearest;
};

}  // namespace

MeshSurface::MeshSurface(TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(mesh_) {
  struct Side {
    std::uint32_t a, b, triangle, corner;
  };
  std::vector<Side> sides;
  const auto faces = static_cast<std::uint32_t>(mesh_.triangles.size());
  for (std::uint32_t t = 0; t < faces; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]);
      sides.push_back({a, b, t, k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tuple(x.a, x.b, x.triangle) < std::tuple(y.a, y.b, y.triangle);
  });
  edge_of_.resize(faces);
  for (const Side& side : sides) {
    if (edges_.empty() || edges_.back().a != side.a || edges_.back().b != side.b) {
      edges_.push_back({side.a, side.b});
      first_.push_back(static_cast<std::uint32_t>(around_.size()));
    }
    edge_of_[side.triangle][side.corner] = static_cast<std::uint32_t>(edges_.size() - 1);
    around_.push_back(side.triangle);
  }
  std::vector<std::vector<std::uint32_t>> fans(mesh_.vertices.size());
  for (std::uint32_t t = 0; t < faces; ++t)
    for (std::uint32_t v : mesh_.triangles[t]) fans[v].push_back(t);
  for (const auto& fan : fans) {
    first_.push_back(static_cast<std::uint32_t>(around_.size()));
    around_.insert(around_.end(), fan.begin(), fan.end());
  }
  first_.push_back(static_cast<std::uint32_t>(around_.size()));
}

std::uint32_t MeshSurface::feature(std::uint32_t triangle, const NearestPoint& nearest) const {
  const auto faces = static_cast<std::uint32_t>(mesh_.triangles.size());
  if (nearest.part == NearestPoint::Part::face) return triangle;
  if (nearest.part == NearestPoint::Part::edge) return faces + edge_of_[triangle][nearest.corner];
  return faces + static_cast<std::uint32_t>(edges_.size()) + mesh_.triangles[triangle][nearest.corner];
}

std::span<const std::uint32_t> MeshSurface::around(std::uint32_t feature) const {
  const std::size_t k = feature - mesh_.triangles.size();
  return {around_.begin() + first_[k], around_.begin() + first_[k + 1]};
}

void MeshSurface::touch(const Vec3& y, double radius, std::span<const std::uint32_t> triangles,
                        std::vector<WallTouch>& touches) const {
  static thread_local std::vector<Hit> hits, minima;
  hits.clear();
  minima.clear();
  for (const std::uint32_t t : triangles) {
    const NearestPoint nearest = tree_.triangle(t).nearest(y);
    if (nearest.distance < radius) hits.push_back({t, feature(t, nearest), nearest});
  }
  // The nearest point of one triangle is a local minimum of the whole mesh unless it lies on the rim and a
  // neighbour there comes nearer.
  for (const Hit& hit : hits) {
    bool minimum = true;
    if (hit.nearest.part != NearestPoint::Part::face)
      for (const std::uint32_t t : around(hit.feature)) {
        const auto other =
            std::lower_bound(hits.begin(), hits.end(), t,
                             [](const Hit& h, std::uint32_t triangle) { return h.triangle < triangle; });
        if (other != hits.end() && other->triangle == t &&
            other->nearest.distance < hit.nearest.distance - kTie * radius)
          minimum = false;
      }
    if (minimum) minima.push_back(hit);
  }
  std::sort(minima.begin(), minima.end(), [](const Hit& a, const Hit& b) {
    return a.nearest.distance != b.nearest.distance ? a.nearest.distance < b.nearest.distance
                                                    : a.feature < b.feature;
  });
  const std::size_t first = touches.size();
  for (const Hit& hit : minima) {
    const TriangleShape& shape = tree_.triangle(hit.triangle);
    WallTouch touch{hit.feature, shape.normal, hit.nearest.distance};
    if (touch.arm == 0.0)
      touch.arm = -radius;
    else if (hit.nearest.part != NearestPoint::Part::face)
      touch.n = (hit.nearest.point - y) / touch.arm;
    else if ((y - shape.corner[0]).dot(shape.normal) > 0.0)
      touch.n = -shape.normal;
    const bool rim = hit.nearest.part != NearestPoint::Part::face;
    const auto covers = [&](const WallTouch& t) {
      return t.n.dot(touch.n) > kOneDirection ||
             (rim && t.n.dot(hit.nearest.point - y) > t.arm - kLevel * radius);
    };
    if (std::none_of(touches.begin() + static_cast<std::ptrdiff_t>(first), touches.end(), covers))
      touches.push_back(touch);
  }
  std::sort(touches.begin() + static_cast<std::ptrdiff_t>(first), touches.end(),
            [](const WallTouch& a, const WallTouch& b) { return a.feature < b.feature; });
}

WallTouch MeshSurface::extend(std::uint32_t feature, const Vec3& y) const {
  const std::size_t faces = mesh_.triangles.size();
  if (feature < faces) {
    const TriangleShape& shape = tree_.triangle(feature);
    const double height = (y - shape.corner[0]).dot(shape.normal);
    return {feature, height > 0.0 ? Vec3(-shape.normal) : shape.normal, std::abs(height)};
  }
  Vec3 point;
  if (feature < faces + edges_.size()) {
    const Edge& edge = edges_[feature - faces];
    const Vec3 &a = mesh_.vertices[edge.a], along = (mesh_.vertices[edge.b] - a).normalized();
    point = a + (y - a).dot(along) * along;
  } else {
    point = mesh_.vertices[feature - faces - edges_.size()];
  }
  const Vec3 arm = point - y;
  const double distance = arm.norm();
  return {feature, distance > 0.0 ? Vec3(arm / distance) : Vec3::UnitZ(), distance};
}

}  // namespace cairn
