#include "contact/wall/surface.h"

namespace cairn {

namespace {

/// A round surface, `out` from its centre or axis to the point; on the axis all directions are as good as
/// `any`.
WallTouch round(const Vec3& out, double radius, bool inside, const Vec3& any) {
  const double distance = out.norm();
  const Vec3 n = distance > 0.0 ? Vec3(out / distance) : any;
  return inside ? WallTouch{0, n, radius - distance} : WallTouch{0, -n, distance - radius};
}

}  // namespace

WallTouch SphereSurface::nearest(const Vec3& y) const {
  return round(y - center, radius, inside, Vec3::UnitZ());
}

WallTouch CylinderSurface::nearest(const Vec3& y) const {
  const Vec3 arm = y - point;
  return round(arm - arm.dot(axis) * axis, radius, inside, axis.unitOrthogonal());
}

}  // namespace cairn
