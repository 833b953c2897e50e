#include "analysis/axes.h"

#include <algorithm>
#include <array>

#include "analysis/spin_state.h"
#include "body/cells.h"

namespace cairn {

AxisLengths axis_lengths(const Bodies& bodies, std::span<const std::uint32_t> set) {
  const SpinState state = spin_state(bodies, set);
  const Mat3 principal = principal_axes(state.inertia).axes;
  const Spheres& spheres = bodies.spheres;
  const Vec3 center = state.center - place(bodies, set[0]);
  const auto along = [&](std::uint32_t b, std::uint32_t s) -> Vec3 {
    const Vec3 x = separation(bodies, set[0], b) + (spheres.position[s] - bodies.position[b]);
    return principal.transpose() * (x - center);
  };
  // The centre of mass may lie outside of all spheres: start from the first one.
  const Vec3 start = along(set[0], bodies.first_sphere[set[0]]);
  Vec3 low = start, high = start;
  for (const std::uint32_t b : set)
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      const Vec3 x = along(b, s);
      low = low.cwiseMin((x.array() - spheres.radius[s]).matrix());
      high = high.cwiseMax((x.array() + spheres.radius[s]).matrix());
    }
  const Vec3 lengths = high - low;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int p, int q) { return lengths[p] > lengths[q]; });
  AxisLengths result{lengths[order[0]], lengths[order[1]], lengths[order[2]], {}};
  for (int k = 0; k < 3; ++k) result.axes.col(k) = principal.col(order[static_cast<std::size_t>(k)]);
  if (result.axes.determinant() < 0.0) result.axes.col(1) = -result.axes.col(1);
  return result;
}

}  // namespace cairn
