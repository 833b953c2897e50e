// The attraction of a run of sources on a few targets, the inner loop of every near field.

#include "gravity/pack-inl.h"
#include "gravity/point_arrays.h"

#if defined(CAIRN_GRAVITY_PAIR_KERNEL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_GRAVITY_PAIR_KERNEL_INL_H
#undef CAIRN_GRAVITY_PAIR_KERNEL_INL_H
#else
#define CAIRN_GRAVITY_PAIR_KERNEL_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {

/// Targets that share one pass over the sources, as registers allow.
inline constexpr std::size_t kTile = HWY_TARGET <= HWY_AVX3 ? 4 : 1;

/// Sums of m d / r^3 and m / r over sources, kept apart by lane until `sum`.
struct PairSum {
  Pack x, y, z, potential;

  CAIRN_INLINE void clear() { x = y = z = potential = Pack(0.0); }
};

/// `mass`, 0 where the groups are the same.
CAIRN_INLINE Pack without(const Pack& group, const Pack& other, const Pack& mass) {
  const Pack difference = group - other;
  return select(difference * difference > Pack(0.0), mass, Pack(0.0));
}

/// Adds the sources [begin, end) to the sums of the targets [target, target + kTile). Sources are read in
/// whole packs: end - begin is a multiple of kPack, or `end` the end of the arrays. Points of one group are
/// left out when `exclude_group`.
template <bool with_potential, bool exclude_group>
CAIRN_INLINE void attract(const PointArrays& targets, std::size_t target, const PointArrays& sources,
                          std::size_t begin, std::size_t end, PairSum* sums) {
  Pack tx[kTile], ty[kTile], tz[kTile], group[kTile];
  PairSum local[kTile];
  for (std::size_t k = 0; k < kTile; ++k) {
    tx[k] = targets.x[target + k];
    ty[k] = targets.y[target + k];
    tz[k] = targets.z[target + k];
    group[k] = targets.group[target + k];
    local[k] = sums[k];
  }
  for (std::size_t j = begin; j < end; j += kPack) {
    const Pack sx = load(&sources.x[j]), sy = load(&sources.y[j]), sz = load(&sources.z[j]);
    const Pack mass = load(&sources.mass[j]);
    const Pack source_group = exclude_group ? load(&sources.group[j]) : Pack(0.0);
    for (std::size_t k = 0; k < kTile; ++k) {
      const Pack dx = sx - tx[k], dy = sy - ty[k], dz = sz - tz[k];
      const Pack square = fma(dx, dx, fma(dy, dy, dz * dz));
      const Pack counted = exclude_group ? without(source_group, group[k], mass) : mass;
      const InversePowers w = inverse_powers(square, kCoincident * kCoincident, counted);
      local[k].x = fma(w.third, dx, local[k].x);
      local[k].y = fma(w.third, dy, local[k].y);
      local[k].z = fma(w.third, dz, local[k].z);
      if constexpr (with_potential) local[k].potential += w.first;
    }
  }
  for (std::size_t k = 0; k < kTile; ++k) sums[k] = local[k];
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#endif
