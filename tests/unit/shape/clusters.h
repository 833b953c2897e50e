// Test clusters.
#pragma once

#include <cmath>

#include "core/random.h"
#include "shape/shape.h"

namespace cairn::test {

/// `count` overlapping spheres of radius 0.3 to 1.2 around the origin.
inline Shape random_cluster(int count, std::uint64_t seed) {
  Random random(seed, 0);
  Shape shape{"cluster", "", {}, {}};
  for (int i = 0; i < count; ++i) {
    shape.centers.push_back(std::cbrt(count) * 0.8 * random.in_ball());
    shape.radii.push_back(random.uniform(0.3, 1.2));
  }
  return shape;
}

/// The shape turned by `rotation`, then shifted.
inline Shape moved(Shape shape, const Quat& rotation, const Vec3& shift) {
  for (Vec3& center : shape.centers) center = rotation * center + shift;
  return shape;
}

}  // namespace cairn::test
