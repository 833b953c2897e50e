// A part of space: which points are in it, and how far from its surface they are.
#pragma once

#include <memory>

#include "io/scene.h"
#include "shape/signed_distance.h"

namespace cairn {

/// Places count from the zero that its specification's position counts from.
class Region {
 public:
  /// @throws InputError for a mesh that cannot be read or does not bound a solid.
  Region(const RegionSpec& spec, const InputFiles& files);

  /// Distance (m) of x from the surface, negative inside.
  double distance(const Vec3& x) const;
  /// m^3
  double volume() const { return volume_; }
  /// m, of the farthest point from the region's position.
  double reach() const { return reach_; }
  const RegionSpec& spec() const { return spec_; }

 private:
  RegionSpec spec_;
  double volume_ = 0.0, reach_ = 0.0;
  std::shared_ptr<const SignedDistance> mesh_;
};

/// Distance (m) of x from the surface of an ellipsoid with these semi-axes (m), negative inside: to
/// round-off, by bisection for the foot of the perpendicular [Eberly 2013, "Distance from a point to an
/// ellipse, an ellipsoid, or a hyperellipsoid"].
double ellipsoid_distance(const Vec3& semi_axes, const Vec3& x);

}  // namespace cairn
