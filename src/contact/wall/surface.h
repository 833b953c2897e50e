// Smooth wall surfaces: plane, sphere, cylinder. Lengths in m, in the wall frame.
#pragma once

#include "core/math.h"

namespace cairn {

/// How a sphere meets a surface.
struct WallTouch {
  std::uint32_t feature = 0;  ///< which part of the surface; a smooth one is all one part
  Vec3 n = Vec3::UnitZ();     ///< unit normal from the sphere's centre into the wall
  double arm = 0.0;           ///< distance of the centre from the surface, negative beyond it
};

/// Half-space {y : (y - point).normal < 0} is solid.
struct PlaneSurface {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit

  WallTouch nearest(const Vec3& y) const { return {0, -normal, (y - point).dot(normal)}; }
};

/// Spheres are kept inside, or outside.
struct SphereSurface {
  Vec3 center = Vec3::Zero();
  double radius = 1.0;
  bool inside = true;

  WallTouch nearest(const Vec3& y) const;
};

/// Infinite along its axis.
struct CylinderSurface {
  Vec3 point = Vec3::Zero();  ///< of the axis
  Vec3 axis = Vec3::UnitZ();  ///< unit
  double radius = 1.0;
  bool inside = true;

  WallTouch nearest(const Vec3& y) const;
};

}  // namespace cairn
