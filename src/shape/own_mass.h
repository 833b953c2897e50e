// How a shape's own masses and inertia spread its mass.
#pragma once

#include "shape/shape.h"

namespace cairn {

/// How the mass of a body is spread.
struct MassSpread {
  Vec3 center;
  Mat3 inertia;  ///< about it, per mass
};

/// Inertia per mass, about the origin, of a ball whose centre is at d.
inline Mat3 ball_inertia(const Vec3& d, double radius) {
  return (d.squaredNorm() + 0.4 * radius * radius) * Mat3::Identity() - d * d.transpose();
}

/// That of a shape whose spheres have masses of their own.
MassSpread spread_of_spheres(const Shape& shape);

}  // namespace cairn
