// Moments of the part of a sphere's surface that other spheres leave uncovered.
#pragma once

#include <array>
#include <vector>

#include "core/math.h"

namespace cairn {

/// The cap of the unit sphere that another sphere covers: directions u with u . axis > height.
struct Cap {
  Vec3 axis;
  double height;  ///< cosine of the angular radius, in (-1, 1)
  double rim;     ///< sine of the angular radius
};

/// Integrals over the exposed part of the unit sphere of 1, u, u u^T and u u^T u_k.
struct SurfaceMoments {
  double area = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  std::array<Mat3, 3> third = {Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
};

/// Moments of the unit sphere outside every cap, to about 1e-14.
SurfaceMoments exposed_moments(const std::vector<Cap>& caps);

}  // namespace cairn
