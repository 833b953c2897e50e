// Bodies for the tests of the analysis room: loose spheres and hand-made aggregates.
#pragma once

#include "body/bodies.h"

namespace cairn::test {

inline RigidShape unit_sphere() {
  RigidShape shape;
  shape.volume = 4.0 / 3.0 * kPi;
  shape.inertia = {0.4, 0.4, 0.4};
  shape.offsets = {Vec3::Zero()};
  shape.radii = {1.0};
  shape.mass_fractions = {1.0};
  return shape;
}

/// Two touching unit spheres on the body's x axis.
inline RigidShape dumbbell() {
  RigidShape shape;
  shape.volume = 8.0 / 3.0 * kPi;
  shape.inertia = {0.4, 1.4, 1.4};
  shape.offsets = {Vec3(-1.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0)};
  shape.radii = {1.0, 1.0};
  shape.mass_fractions = {0.5, 0.5};
  return shape;
}

/// A loose sphere of the given mass.
inline void add_sphere(Bodies& bodies, const Vec3& x, double radius, double mass,
                       const Vec3& v = Vec3::Zero(), const Vec3& w = Vec3::Zero()) {
  Placement placement;
  placement.position = x;
  placement.velocity = v;
  placement.angular_velocity = w;
  const RigidShape shape = unit_sphere();
  add_body(bodies, shape, 0, radius, mass / (shape.volume * radius * radius * radius), 0, placement);
}

}  // namespace cairn::test
