// The surface of the volume that overlapping balls cover.
#pragma once

#include <vector>

#include "shape/shape.h"

namespace cairn {

/// A point of the surface and the ball on which it lies.
struct UnionPoint {
  Vec3 point;
  std::uint32_t ball;
};

class UnionSurface {
 public:
  explicit UnionSurface(const Shape& balls);

  /// About `count` points, each for the same area.
  std::vector<UnionPoint> sample(std::size_t count) const;

  /// Distance of x from the surface, negative inside: exact. Inside, the nearest point lies on a ball, on
  /// the circle where two meet, or on the corner of three; `near` is a distance within which some point of
  /// the surface is known to lie.
  double distance(const Vec3& x, double near) const;

 private:
  bool exposed(const Vec3& x, std::size_t a, std::size_t b, std::size_t c) const;

  const Shape& balls_;
  std::vector<std::vector<std::uint32_t>> neighbours_;  // of each ball, in increasing order
};

}  // namespace cairn
