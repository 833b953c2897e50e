#include "analysis/axes.h"

#include <algorithm>
#include <array>

#include "analysis/spin_state.h"

namespace cairn {

AxisLengths axis_lengths(const Bodies& bodies, std::span<const std::uint32_t> set) {
  const SpinState state = spin_state(bodies, set);
  const Mat3 principal = principal_axes(state.inertia).axes;
  const Spheres& spheres = bodies.spheres;
  // The centre of mass may lie outside of all spheres: start from the first one.
  const std::uint32_t first = bodies.first_sphere[set[0]];
  const Vec3 start = principal.transpose() * (spheres.position[first] - state.center);
  Vec3 low = start, high = start;
  for (const std::uint32_t b : set)
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      const Vec3 x = principal.transpose() * (spheres.position[s] - state.center);
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
