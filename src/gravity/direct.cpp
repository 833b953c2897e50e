#include "gravity/direct.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gravity/direct.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>

#include "core/parallel.h"
#include "gravity/pair_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {
namespace {

constexpr std::size_t kTargets = 64;    // targets of one task: their sums fit the first-level cache
constexpr std::size_t kSources = 1024;  // sources of one pass: theirs stay in the second-level cache

std::size_t whole_packs_below(std::size_t i) {
  return i / kPack * kPack;
}

// Sources [begin, end) on one tile; only the packs that hold some point of the tile's groups,
// [near_begin, near_end), compare group numbers.
template <bool with_potential>
void attract_around(const PointArrays& a, std::size_t target, std::size_t begin, std::size_t end,
                    std::size_t near_begin, std::size_t near_end, PairSum* sums) {
  const std::size_t b = std::clamp(near_begin, begin, end), e = std::clamp(near_end, begin, end);
  attract<with_potential, false>(a, target, a, begin, b, sums);
  attract<with_potential, true>(a, target, a, b, e, sums);
  attract<with_potential, false>(a, target, a, e, end, sums);
}

template <bool with_potential>
void sum_block(const Points& points, const PointArrays& a, std::size_t begin, std::size_t end,
               std::span<Vec3> acceleration, std::span<double> potential) {
  const std::size_t n = points.size();
  PairSum sums[kTargets];
  for (PairSum& s : sums) s.clear();
  for (std::size_t from = 0; from < n; from += kSources) {
    const std::size_t to = std::min(from + kSources, n);
    for (std::size_t i = begin; i < end; i += kTile) {
      const std::size_t last = std::min(i + kTile, n) - 1;
      const auto g0 = static_cast<std::size_t>(a.group[i]), g1 = static_cast<std::size_t>(a.group[last]);
      // A group of one point is left out by its zero distance.
      const bool alone = points.first[g1 + 1] - points.first[g0] == last + 1 - i && g1 - g0 == last - i;
      const std::size_t near_begin = alone ? n : whole_packs_below(points.first[g0]);
      const std::size_t near_end = alone ? n : whole_packs_below(points.first[g1 + 1] + kPack - 1);
      attract_around<with_potential>(a, i, from, to, near_begin, near_end, &sums[i - begin]);
    }
  }
  for (std::size_t i = begin; i < end; ++i) {
    const PairSum& s = sums[i - begin];
    acceleration[i] = kGravitationalConstant * Vec3(sum(s.x), sum(s.y), sum(s.z));
    if constexpr (with_potential) potential[i] = -kGravitationalConstant * sum(s.potential);
  }
}

}  // namespace

void sum_all(const Points& points, const PointArrays& arrays, std::span<Vec3> acceleration,
             std::span<double> potential) {
  parallel_blocks(points.size(), kTargets, [&](std::size_t begin, std::size_t end) HWY_ATTR {
    if (potential.empty()) {
      sum_block<false>(points, arrays, begin, end, acceleration, potential);
    } else {
      sum_block<true>(points, arrays, begin, end, acceleration, potential);
    }
  });
}

/// Of the first acceleration.size() targets by the first `count` sources.
void sum_at(const PointArrays& targets, const PointArrays& sources, std::size_t count,
            std::span<Vec3> acceleration) {
  parallel_blocks(acceleration.size(), kTile, [&](std::size_t begin, std::size_t end) HWY_ATTR {
    PairSum sums[kTile];
    for (PairSum& s : sums) s.clear();
    attract<false, true>(targets, begin, sources, 0, count, sums);
    for (std::size_t i = begin; i < end; ++i) {
      const PairSum& s = sums[i - begin];
      acceleration[i] = kGravitationalConstant * Vec3(sum(s.x), sum(s.y), sum(s.z));
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn::gravity {

namespace {
HWY_EXPORT(sum_all);
HWY_EXPORT(sum_at);
}  // namespace

void DirectSum::evaluate(const Points& points, std::span<Vec3> acceleration, std::span<double> potential) {
  check(points);
  arrays_.assign(points);
  HWY_DYNAMIC_DISPATCH(sum_all)(points, arrays_, acceleration, potential);
}

void DirectSum::evaluate_at(std::span<const std::size_t> numbers, const Points& points,
                            std::span<Vec3> acceleration) {
  check(points);
  arrays_.assign(points);
  PointArrays targets;
  targets.resize(numbers.size());
  for (std::size_t k = 0; k < numbers.size(); ++k)
    targets.set(k, points.positions[numbers[k]], 0.0, arrays_.group[numbers[k]]);
  HWY_DYNAMIC_DISPATCH(sum_at)(targets, arrays_, points.size(), acceleration);
}

}  // namespace cairn::gravity
#endif
