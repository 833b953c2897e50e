#include "gravity/perturber.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gravity/perturber.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gravity/pack-inl.h"
#include "gravity/points.h"

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {
namespace {

template <bool tidal>
double add_to(const Pull& pull, std::span<const Vec3> positions, std::span<Vec3> acceleration) {
  const Vec3& d = pull.place;
  const Pack dx = d.x(), dy = d.y(), dz = d.z(), gm = pull.gm;
  const double d2 = d.squaredNorm();
  const Pack inverse2 = 1.0 / d2, at_zero = pull.gm / (d2 * std::sqrt(d2));
  Pack least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < positions.size(); i += kPack) {
    const std::size_t count = positions.size() - i;
    const PackVec x = load(&positions[i], count);
    PackVec a{dx - x.x, dy - x.y, dz - x.z};
    const Pack square = fma(a.x, a.x, fma(a.y, a.y, a.z * a.z));
    least = min(least, count >= kPack ? square : select(head(count) > Pack(0.0), square, least));
    const Pack third = inverse_powers(square, kCoincident * kCoincident, gm).third;
    if constexpr (tidal) {
      const Pack q =
          -inverse2 * fma(x.x, a.x + dx, fma(x.y, a.y + dy, x.z * (a.z + dz)));  // x.(x - 2D) / D^2
      // (1 + q)^(3/2) is at_zero over third.
      const Pack f = q * fma(q, q + Pack(3.0), Pack(3.0)) * third / (third + at_zero);
      a = {-fma(f, dx, x.x), -fma(f, dy, x.y), -fma(f, dz, x.z)};
    }
    store(&acceleration[i], load(&acceleration[i], count) + PackVec{third * a.x, third * a.y, third * a.z},
          count);
  }
  alignas(64) double lane[kPack];
  least.store(lane);
  return *std::min_element(lane, lane + kPack);
}

}  // namespace

double add(const Pull& pull, std::span<const Vec3> positions, std::span<Vec3> acceleration) {
  return pull.tidal ? add_to<true>(pull, positions, acceleration)
                    : add_to<false>(pull, positions, acceleration);
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn::gravity {

namespace {
HWY_EXPORT(add);
}  // namespace

Motion motion(const Orbit& orbit, double time) {
  if (const auto* kepler = std::get_if<KeplerOrbit>(&orbit)) return motion(*kepler, time);
  if (const auto* track = std::get_if<Track>(&orbit)) return track->at(time);
  return {std::get<Vec3>(orbit), Vec3::Zero()};
}

double closest(const Orbit& orbit) {
  if (const auto* kepler = std::get_if<KeplerOrbit>(&orbit)) return kepler->periapsis;
  if (const auto* track = std::get_if<Track>(&orbit)) return track->closest();
  return std::get<Vec3>(orbit).norm();
}

double add_pull(const Pull& pull, std::span<const Vec3> positions, std::span<Vec3> acceleration) {
  return HWY_DYNAMIC_DISPATCH(add)(pull, positions, acceleration);
}

}  // namespace cairn::gravity
#endif
