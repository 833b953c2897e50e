// The attraction of a run of sources on a few targets, the inner loop of every near field.
#pragma once

#include <algorithm>
#include <vector>

#include "core/math.h"
#include "gravity/points.h"
#include "gravity/simd.h"

namespace cairn::gravity {

inline constexpr int kTile = 4;  ///< targets that share one pass over the sources

/// Points as separate arrays, padded with massless points so that whole packs and tiles can be read
/// anywhere.
struct PointArrays {
  std::vector<double> x, y, z;  ///< m
  std::vector<double> mass;     ///< kg
  std::vector<double> group;    ///< group number

  void resize(std::size_t points) {
    const std::size_t padded = points + std::max(kLanes, kTile);
    for (auto* column : {&x, &y, &z, &mass, &group}) column->resize(padded);
    for (std::size_t i = points; i < padded; ++i) set(i, Vec3::Zero(), 0.0, -1.0);
  }
  void assign(const Points& points) {
    resize(points.size());
    for (std::size_t g = 0; g < points.groups(); ++g)
      for (std::size_t i = points.first[g]; i < points.first[g + 1]; ++i)
        set(i, points.positions[i], points.masses[i], static_cast<double>(g));
  }
  void set(std::size_t i, const Vec3& position, double m, double g) {
    x[i] = position.x();
    y[i] = position.y();
    z[i] = position.z();
    mass[i] = m;
    group[i] = g;
  }
};

/// Sums of m d / r^3 and m / r over sources, kept apart by lane until `sum`.
struct PairSum {
  Pack x{}, y{}, z{}, potential{};
};

/// Adds the sources [begin, end) to the sums of the targets [target, target + kTile). Sources are read in
/// whole packs: end - begin is a multiple of kLanes, or `end` the end of the arrays. Points of one group are
/// left out when `exclude_group`.
template <bool with_potential, bool exclude_group>
inline void attract(const PointArrays& targets, std::size_t target, const PointArrays& sources,
                    std::size_t begin, std::size_t end, PairSum* sums) {
  Pack tx[kTile], ty[kTile], tz[kTile], group[kTile];
  PairSum local[kTile];
  for (int k = 0; k < kTile; ++k) {
    tx[k] = spread(targets.x[target + k]);
    ty[k] = spread(targets.y[target + k]);
    tz[k] = spread(targets.z[target + k]);
    group[k] = spread(targets.group[target + k]);
    local[k] = sums[k];
  }
  for (std::size_t j = begin; j < end; j += kLanes) {
    const Pack sx = load(&sources.x[j]), sy = load(&sources.y[j]), sz = load(&sources.z[j]);
    const Pack mass = load(&sources.mass[j]);
    const Pack source_group = exclude_group ? load(&sources.group[j]) : Pack{};
    for (int k = 0; k < kTile; ++k) {
      const Pack dx = sx - tx[k], dy = sy - ty[k], dz = sz - tz[k];
      const Pack square = fma(dx, dx, fma(dy, dy, dz * dz));
      Mask counts = greater(square, spread(kCoincident * kCoincident));
      if constexpr (exclude_group) counts &= differ(source_group, group[k]);
      const InversePowers w = inverse_powers<with_potential>(counts, square, mass);
      local[k].x = fma(w.third, dx, local[k].x);
      local[k].y = fma(w.third, dy, local[k].y);
      local[k].z = fma(w.third, dz, local[k].z);
      if constexpr (with_potential) local[k].potential += w.first;
    }
  }
  for (int k = 0; k < kTile; ++k) sums[k] = local[k];
}

}  // namespace cairn::gravity
