#include "pile/region.h"

#include <algorithm>
#include <cmath>

namespace cairn {

namespace {

double box_distance(const Vec3& half, const Vec3& x) {
  const Vec3 beyond = x.cwiseAbs() - half;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

}  // namespace

double ellipsoid_distance(const Vec3& semi_axes, const Vec3& x) {
  const Vec3 e2 = semi_axes.cwiseAbs2();
  // The foot is e^2 x / (e^2 + t) for the largest root t of F(t) = |e x / (e^2 + t)|^2 - 1; here s = t + min
  // e^2. Components of x that vanish are nudged off the planes of symmetry, where the foot is not unique.
  const Vec3 above = e2.array() - e2.minCoeff();
  const Vec3 y = x.cwiseAbs().cwiseMax(1e-14 * semi_axes.minCoeff());
  const Vec3 ey = semi_axes.cwiseProduct(y);
  double low = 0.0, high = ey.norm() + e2.maxCoeff();
  for (int k = 0; k < 2000; ++k) {
    const double s = 0.5 * (low + high);
    if (s <= low || s >= high) break;
    (ey.cwiseQuotient((above.array() + s).matrix()).squaredNorm() > 1.0 ? low : high) = s;
  }
  const Vec3 foot = e2.cwiseProduct(y).cwiseQuotient((above.array() + high).matrix());
  const bool inside = y.cwiseQuotient(semi_axes).squaredNorm() < 1.0;
  return inside ? -(foot - y).norm() : (foot - y).norm();
}

Region::Region(const RegionSpec& spec, const InputFiles& files) : spec_(spec) {
  switch (spec.kind) {
    case RegionKind::ball:
      volume_ = 4.0 / 3.0 * kPi * cubed(spec.radius);
      reach_ = spec.radius;
      return;
    case RegionKind::ellipsoid:
      volume_ = kPi / 6.0 * spec.size.prod();
      reach_ = 0.5 * spec.size.maxCoeff();
      return;
    case RegionKind::box:
      volume_ = spec.size.prod();
      reach_ = 0.5 * spec.size.norm();
      return;
    case RegionKind::mesh:
      break;
  }
  const std::filesystem::path path = files.path_of(spec.file);
  SolidMesh solid = parse_solid(files.read(spec.file), path, spec.unit);
  for (const std::string& note : solid.notes) files.note(path.string() + ": " + note);
  if (spec.frame != MeshFrame::file) {
    const MassProperties mass = mass_of(solid.surface);
    if (spec.frame == MeshFrame::principal)
      solid.surface = in_principal_frame(solid.surface, mass);
    else
      for (Vec3& v : solid.surface.vertices) v -= mass.centroid;
  }
  std::vector<Vec3>& vertices = solid.surface.vertices;
  if (spec.size != Vec3::Zero()) {
    Vec3 low = vertices.front(), high = low;
    for (const Vec3& v : vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    const Vec3 stretch = spec.size.cwiseQuotient(high - low);
    for (Vec3& v : vertices) v = v.cwiseProduct(stretch);
  }
  for (const Vec3& v : vertices) reach_ = std::max(reach_, v.norm());
  volume_ = mass_of(solid.surface).volume;
  mesh_ = std::make_shared<const SignedDistance>(solid);
}

double Region::distance(const Vec3& x) const {
  const Vec3 y = spec_.orientation.conjugate() * (x - spec_.position);
  switch (spec_.kind) {
    case RegionKind::ball:
      return y.norm() - spec_.radius;
    case RegionKind::ellipsoid:
      return ellipsoid_distance(0.5 * spec_.size, y);
    case RegionKind::box:
      return box_distance(0.5 * spec_.size, y);
    case RegionKind::mesh:
      break;
  }
  return (*mesh_)(y).distance;
}

}  // namespace cairn
