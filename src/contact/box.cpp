#include "contact/box.h"

#include <algorithm>
#include <cmath>

#include "core/elementary.h"

namespace cairn {

Vec3 Box::nearest_image(const Vec3& d) const {
  Vec3 out;
  for (int axis = 0; axis < 3; ++axis) out[axis] = edge[axis] > 0.0 ? -std::round(d[axis] / edge[axis]) : 0.0;
  return out;
}

Vec3 Strain::edge(double t) const {
  const Vec3 growth = std::min(t, until) * rate;
  return start.cwiseProduct(Vec3(exponential(growth.x()), exponential(growth.y()), exponential(growth.z())));
}

double least_edge(const Bodies& bodies) {
  const Spheres& spheres = bodies.spheres;
  double smallest = std::numeric_limits<double>::infinity(), reach = 0.0, largest = 0.0;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    smallest = std::min(smallest, spheres.radius[s]);
    largest = std::max(largest, spheres.radius[s]);
    reach = std::max(reach, spheres.offset[s].norm() + spheres.radius[s]);
  }
  // Beside it room for the skin of the candidate list, which is never more than the smallest radius.
  return std::max(4.0 * largest, 2.0 * reach) + 2.0 * smallest;
}

}  // namespace cairn
