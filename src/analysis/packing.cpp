#include "analysis/packing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <voro++/voro++.hh>

#include "analysis/spin_state.h"
#include "body/cells.h"
#include "core/elementary.h"

namespace cairn {

namespace {

/// The spheres of a set of bodies from the set's mass centre.
struct Cluster {
  std::vector<Vec3> positions;
  std::vector<double> radii;
  std::vector<std::uint32_t> owner;  // number in the set
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
};

Cluster gather(const Bodies& bodies, std::span<const std::uint32_t> set, const Vec3& centre) {
  Cluster out;
  double largest = 0.0;
  for (std::uint32_t k = 0; k < set.size(); ++k) {
    const std::uint32_t b = set[k];
    const Vec3 x = place(bodies, b, centre);
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      const Vec3 p = x + (bodies.spheres.position[s] - bodies.position[b]);
      out.positions.push_back(p);
      out.radii.push_back(bodies.spheres.radius[s]);
      out.owner.push_back(k);
      largest = std::max(largest, bodies.spheres.radius[s]);
      out.low = out.low.cwiseMin(p);
      out.high = out.high.cwiseMax(p);
    }
  }
  out.low.array() -= 2.0 * largest;
  out.high.array() += 2.0 * largest;
  return out;
}

/// Volume (m^3) of the cells of each body that is asked for; NaN where Voro++ gives one up, as it does with
/// one in a million of a perfect lattice.
template <class Container>
std::vector<double> cell_volumes(const Cluster& cluster, const std::vector<std::uint8_t>& asked) {
  constexpr double per_block = 5.0;  // spheres; what Voro++ does fastest
  const Vec3 size = cluster.high - cluster.low;
  const double edge = cube_root(per_block * size.prod() / static_cast<double>(cluster.positions.size()));
  std::array<int, 3> n{};
  for (int axis = 0; axis < 3; ++axis) n[axis] = std::clamp(static_cast<int>(size[axis] / edge), 1, 1000);
  const Vec3 &low = cluster.low, &high = cluster.high;
  Container container(low.x(), high.x(), low.y(), high.y(), low.z(), high.z(), n[0], n[1], n[2], false, false,
                      false, 8);
  for (std::size_t s = 0; s < cluster.positions.size(); ++s) {
    const Vec3& x = cluster.positions[s];
    if constexpr (std::is_same_v<Container, voro::container_poly>)
      container.put(static_cast<int>(s), x.x(), x.y(), x.z(), cluster.radii[s]);
    else
      container.put(static_cast<int>(s), x.x(), x.y(), x.z());
  }
  std::vector<double> volume(asked.size(), 0.0);
  voro::voronoicell cell;
  voro::c_loop_all loop(container);
  if (loop.start()) do {
      const std::uint32_t owner = cluster.owner[static_cast<std::size_t>(loop.pid())];
      if (!asked[owner]) continue;
      volume[owner] += container.compute_cell(cell, loop) ? cell.volume() : std::nan("");
    } while (loop.inc());
  return volume;
}

}  // namespace

Packing interior_packing(const Bodies& bodies, std::span<const std::uint32_t> set, double radius) {
  const Vec3 centre = spin_state(bodies, set).center;
  std::vector<std::uint8_t> interior(set.size());
  Packing out;
  for (std::size_t k = 0; k < set.size(); ++k) {
    interior[k] = place(bodies, set[k], centre).norm() < radius;
    out.bodies += interior[k];
  }
  if (out.bodies == 0) {
    out.total = out.total_radical = out.mean = out.mean_radical = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  const Cluster cluster = gather(bodies, set, centre);
  const std::vector<double> plain = cell_volumes<voro::container>(cluster, interior),
                            radical = cell_volumes<voro::container_poly>(cluster, interior);
  double solid = 0.0, plain_cells = 0.0, radical_cells = 0.0;
  for (std::size_t k = 0; k < set.size(); ++k) {
    if (!interior[k]) continue;
    if (std::isnan(plain[k]) || std::isnan(radical[k])) {
      --out.bodies;
      continue;
    }
    const double volume = bodies.volume[set[k]];
    out.mean += volume / plain[k];
    out.mean_radical += volume / radical[k];
    solid += volume;
    plain_cells += plain[k];
    radical_cells += radical[k];
  }
  out.mean /= static_cast<double>(out.bodies);
  out.mean_radical /= static_cast<double>(out.bodies);
  out.total = solid / plain_cells;
  out.total_radical = solid / radical_cells;
  return out;
}

}  // namespace cairn
