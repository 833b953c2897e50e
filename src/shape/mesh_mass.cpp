// Mass properties of closed meshes.
#include <algorithm>
#include <cmath>

#include "core/elementary.h"
#include "core/parallel.h"
#include "shape/principal_frame.h"
#include "shape/solid_mesh.h"
#include "shape/solid_moments.h"

namespace cairn {

MassProperties mass_of(const TriangleMesh& closed) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : closed.triangles)
    for (const std::uint32_t v : triangle) box.extend(closed.vertices[v]);
  // Differences from the middle lose nothing, however far the mesh lies from the origin.
  const Vec3 origin = box.center();
  const auto moments = parallel_sum(closed.triangles.size(), SolidMoments{}, [&](std::size_t t) {
    const Vec3 a = closed.vertices[closed.triangles[t][0]] - origin,
               b = closed.vertices[closed.triangles[t][1]] - origin,
               c = closed.vertices[closed.triangles[t][2]] - origin, sum = a + b + c;
    const double volume = a.dot(b.cross(c)) / 6.0;
    const Mat3 squares = a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose();
    return SolidMoments{volume, volume / 4.0 * sum, volume / 20.0 * squares};
  });
  return about_centroid(moments, origin);
}

Vec3 equivalent_ellipsoid(const MassProperties& mass) {
  const Vec3 moments = principal_frame(mass.inertia / mass.volume).moments;
  Vec3 axes;
  for (Eigen::Index k = 0; k < 3; ++k)
    axes[k] = std::sqrt(std::max(0.0, 2.5 * (moments.sum() - 2.0 * moments[k])));
  return cube_root(mass.volume / (4.0 / 3.0 * kPi * axes.prod())) * axes;
}

TriangleMesh in_principal_frame(const TriangleMesh& mesh, const MassProperties& mass) {
  const Mat3 to_principal = principal_frame(mass.inertia / mass.volume).axes.transpose();
  TriangleMesh out = mesh;
  for (Vec3& x : out.vertices) x = to_principal * (x - mass.centroid);
  return out;
}

}  // namespace cairn
