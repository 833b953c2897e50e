#include "shape/mesh_file/triangulate.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace cairn {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kFlat = 1e-9;       // sine of the corners of a triangle without area
constexpr double kRounding = 1e-12;  // of products of lengths: on one line
constexpr double kCovered = 1e-9;    // of a polygon's area
constexpr std::size_t kMostCorners =
    10'000;  // of a polygon that is not convex, whose edges are looked at in pairs

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Twice the area of a triangle, positive if it turns to the left; zero if that is round-off.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a, v = c - a;
  const double twice = cross(u, v);
  return std::abs(twice) > kRounding * (u.norm() * v.norm()) ? twice : 0.0;
}

/// One polygon: its corners seen along its vector area, in which it turns to the left.
class Polygon {
 public:
  Polygon(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices) : vertices_(vertices) {
    for (const std::uint32_t corner : corners)
      if (loop_.empty() || vertices[corner] != vertices[loop_.back()]) loop_.push_back(corner);
    while (loop_.size() > 1 && vertices[loop_.front()] == vertices[loop_.back()]) loop_.pop_back();
  }

  /// Appends triangles. False: the outline crosses itself.
  bool cut(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    if (is_flat()) {
      while (loop_.size() < 3) loop_.push_back(loop_.front());
      triangles.push_back({loop_[0], loop_[1], loop_[2]});
      return true;
    }
    if (!project()) return false;
    const std::size_t first = triangles.size();
    if (!fan(triangles)) {
      triangles.resize(first);
      if (loop_.size() > kMostCorners || crosses_itself() || !cut_ears(triangles)) return false;
    }
    double covered = 0.0;
    for (std::size_t t = first; t < triangles.size(); ++t) {
      Vec3 sum = Vec3::Zero();
      const Vec3& a = vertices_[triangles[t][0]];
      sum = (vertices_[triangles[t][1]] - a).cross(vertices_[triangles[t][2]] - a);
      const double area = 0.5 * sum.dot(normal_);
      if (!(area > 0.0)) return false;
      covered += area;
    }
    return std::abs(covered - area_) <= kCovered * area_;
  }

 private:
  bool is_flat() const {
    for (std::size_t k = 2; k < loop_.size(); ++k) {
      const Vec3& a = vertices_[loop_[0]];
      // The farthest corner so far would do better than the second; a facet so thin is one without area.
      if (has_area(a, vertices_[loop_[k - 1]], vertices_[loop_[k]])) return false;
    }
    return true;
  }

  /// Corners in the plane across the polygon's vector area. False: that vanishes.
  bool project() {
    const Vec3 origin = vertices_[loop_[0]];
    Vec3 twice = Vec3::Zero();
    double extent = 0.0;
    for (std::size_t k = 1; k < loop_.size(); ++k) {
      const Vec3 x = vertices_[loop_[k]] - origin;
      extent = std::max(extent, x.squaredNorm());
      twice += x.cross(vertices_[loop_[(k + 1) % loop_.size()]] - origin);
    }
    area_ = 0.5 * twice.norm();
    if (!(area_ > kFlat * extent)) return false;
    normal_ = twice.normalized();
    const Vec3 u = normal_.unitOrthogonal(), v = normal_.cross(u);
    for (const std::uint32_t corner : loop_) {
      const Vec3 x = vertices_[corner] - origin;
      at_.push_back({u.dot(x), v.dot(x)});
    }
    return true;
  }

  const Vec2& at(std::size_t k) const { return at_[k % at_.size()]; }

  /// The fan about the first corner of a convex polygon, all of whose corners turn to the left, once round.
  bool fan(std::vector<std::array<std::uint32_t, 3>>& triangles) const {
    const std::size_t n = loop_.size();
    int changes = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 before = at(k + 1) - at(k), after = at(k + 2) - at(k + 1);
      if (!(turn(at(k), at(k + 1), at(k + 2)) > 0.0)) return false;
      changes += (before.x() < 0.0) != (after.x() < 0.0);
    }
    if (changes != 2) return false;
    for (std::size_t k = 1; k + 1 < n; ++k) {
      if (!has_area(vertices_[loop_[0]], vertices_[loop_[k]], vertices_[loop_[k + 1]])) return false;
      triangles.push_back({loop_[0], loop_[k], loop_[k + 1]});
    }
    return true;
  }

  /// Whether edges without a common end cross, or one is passed twice the same way.
  bool crosses_itself() const {
    const std::size_t n = loop_.size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) {
        const Vec2 &a = at(i), &b = at(i + 1), &c = at(j), &d = at(j + 1);
        if (a == c && b == d) return true;
        if (a == c || a == d || b == c || b == d) continue;
        if (turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0) return true;
      }
    return false;
  }

  /// Cuts off corners whose triangle holds nothing of the rest, until a triangle is left.
  bool cut_ears(std::vector<std::array<std::uint32_t, 3>>& triangles) const {
    std::vector<std::size_t> rest(loop_.size());
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k] = k;
    std::size_t tip = 1, failed = 0;
    while (rest.size() > 3) {
      tip %= rest.size();
      if (!is_ear(rest, tip)) {
        if (++failed == rest.size()) return false;
        ++tip;
        continue;
      }
      failed = 0;
      add(rest, tip, triangles);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(tip));
    }
    if (!turns_left(rest, 1)) return false;
    add(rest, 1, triangles);
    return true;
  }

  std::size_t before(const std::vector<std::size_t>& rest, std::size_t tip) const {
    return rest[(tip + rest.size() - 1) % rest.size()];
  }
  std::size_t after(const std::vector<std::size_t>& rest, std::size_t tip) const {
    return rest[(tip + 1) % rest.size()];
  }
  void add(const std::vector<std::size_t>& rest, std::size_t tip,
           std::vector<std::array<std::uint32_t, 3>>& triangles) const {
    triangles.push_back({loop_[before(rest, tip)], loop_[rest[tip]], loop_[after(rest, tip)]});
  }
  bool turns_left(const std::vector<std::size_t>& rest, std::size_t tip) const {
    const std::size_t a = before(rest, tip), b = rest[tip], c = after(rest, tip);
    return turn(at_[a], at_[b], at_[c]) > 0.0 &&
           has_area(vertices_[loop_[a]], vertices_[loop_[b]], vertices_[loop_[c]]);
  }

  bool is_ear(const std::vector<std::size_t>& rest, std::size_t tip) const {
    if (!turns_left(rest, tip)) return false;
    const Vec2 &a = at_[before(rest, tip)], &b = at_[rest[tip]], &c = at_[after(rest, tip)];
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const Vec2& x = at_[rest[k]];
      if (k == tip || x == a || x == c) continue;
      if (x == b) {  // an outline that comes back here must not go on into the triangle
        for (const std::size_t other : {before(rest, k), after(rest, k)})
          if (turn(b, c, at_[other]) > 0.0 && turn(b, at_[other], a) > 0.0) return false;
        continue;
      }
      if (turn(a, b, x) >= 0.0 && turn(b, c, x) >= 0.0 && turn(c, a, x) >= 0.0) return false;
    }
    return true;
  }

  const std::vector<Vec3>& vertices_;
  std::vector<std::uint32_t> loop_;
  std::vector<Vec2> at_;
  Vec3 normal_ = Vec3::Zero();
  double area_ = 0.0;
};

}  // namespace

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() > kFlat * longest;
}

std::string facet_of_file(std::size_t facet) {
  return fmt::format("facet {} of the file", facet + 1);
}

Triangulation triangulate(const FileSurface& surface, const std::string& name) {
  Triangulation out;
  out.triangles.reserve(surface.ends.size());
  out.facet.reserve(surface.ends.size());
  for (std::size_t f = 0; f < surface.ends.size(); ++f) {
    const auto corners = surface.facet(f);
    if (corners.size() == 3)
      out.triangles.push_back({corners[0], corners[1], corners[2]});
    else if (!Polygon(corners, surface.vertices).cut(out.triangles))
      throw InputError(
          "{}: {} has {} corners, and an outline that crosses itself or cannot be cut into triangles",
          surface.place(name, f), facet_of_file(f), corners.size());
    out.facet.resize(out.triangles.size(), static_cast<std::uint32_t>(f));
  }
  return out;
}

}  // namespace cairn
