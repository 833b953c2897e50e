#include "pile/lattice.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "pile/order.h"

namespace cairn {

namespace {

constexpr double kMostSites = 1e8;

/// A lattice as layers of rows of sites: the edges of the grid of whole numbers i, j, k.
struct Grid {
  Vec3 edge;  // m
  Vec3 site(LatticeKind kind, std::int64_t i, std::int64_t j, std::int64_t k) const {
    const auto odd = [](std::int64_t n) { return static_cast<double>(n & 1); };
    Vec3 x(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
    if (kind == LatticeKind::hcp) {  // triangular layers, every second one shifted into the hollows
      x.x() += 0.5 * odd(j + k);
      x.y() += odd(k) / 3.0;
    }
    return x.cwiseProduct(edge);
  }
};

Vec3 grid_edge(LatticeKind kind, double spacing) {
  switch (kind) {
    case LatticeKind::hcp:
      return spacing * Vec3(1.0, std::sqrt(0.75), std::sqrt(2.0 / 3.0));
    case LatticeKind::fcc:  // the sites of a finer cubic lattice with i + j + k even
      return Vec3::Constant(spacing / std::sqrt(2.0));
    case LatticeKind::sc:
      break;
  }
  return Vec3::Constant(spacing);
}

}  // namespace

std::vector<Vec3> lattice_sites(LatticeKind kind, double spacing, const Region& region) {
  const Grid grid{grid_edge(kind, spacing)};
  const Vec3 ends = (region.reach() / grid.edge.array() + 1.0).floor();
  if (8.0 * ends.prod() > kMostSites)
    throw InputError("lattice: a region {:.4g} m wide has more than {:g} sites {:.4g} m apart",
                     2.0 * region.reach(), kMostSites, spacing);
  std::vector<Vec3> sites;
  const auto last = [&](int axis) { return static_cast<std::int64_t>(ends[axis]); };
  for (std::int64_t k = -last(2); k <= last(2); ++k)
    for (std::int64_t j = -last(1); j <= last(1); ++j)
      for (std::int64_t i = -last(0); i <= last(0); ++i) {
        if (kind == LatticeKind::fcc && ((i + j + k) & 1)) continue;
        const Vec3 x = region.spec().orientation * grid.site(kind, i, j, k);
        if (region.distance(region.spec().position + x) < 0.0) sites.push_back(x);
      }
  const auto code = [&](const Vec3& x) { return morton(x, region.reach()); };
  std::stable_sort(sites.begin(), sites.end(),
                   [&](const Vec3& a, const Vec3& b) { return code(a) < code(b); });
  return sites;
}

void add_lattice(const LatticeSpec& lattice, const Region& region, const RigidShape& shape,
                 std::uint32_t shape_index, std::uint16_t material, std::uint64_t seed, std::uint64_t stream,
                 Bodies& bodies) {
  const double spacing = lattice.spacing > 0.0 ? lattice.spacing : 2.0 * lattice.size * shape.bounding_radius;
  const std::vector<Vec3> sites = lattice_sites(lattice.kind, spacing, region);
  if (sites.empty()) throw InputError("lattice: no site is in the region");
  Random random(seed, stream);
  for (const Vec3& x : sites)
    add_body(bodies, shape, shape_index, lattice.size, lattice.density, material,
             {.position = x,
              .orientation = lattice.random_orientation ? random.rotation() : lattice.region.orientation,
              .velocity = Vec3::Zero(),
              .angular_velocity = Vec3::Zero(),
              .origin = lattice.region.position});
}

}  // namespace cairn
