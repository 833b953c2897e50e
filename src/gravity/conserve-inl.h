// The sums of a balance, and what it does, for eight groups at once.

#include <span>

#include "core/parallel.h"
#include "gravity/conserve.h"
#include "gravity/pack-inl.h"

#if defined(CAIRN_GRAVITY_CONSERVE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_GRAVITY_CONSERVE_INL_H
#undef CAIRN_GRAVITY_CONSERVE_INL_H
#else
#define CAIRN_GRAVITY_CONSERVE_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {

/// Wrenches on kPack groups.
struct PackWrench {
  PackVec force, torque;
};

/// Masses (kg) of the `count` groups from g on; 1 in lanes past them, which are divided by it.
CAIRN_INLINE Pack load_masses(std::span<const double> masses, std::size_t g, std::size_t count) {
  if (count >= kPack) return load(&masses[g]);
  alignas(64) double m[kPack] = {1, 1, 1, 1, 1, 1, 1, 1};
  for (std::size_t i = 0; i < count; ++i) m[i] = masses[g + i];
  return load(m);
}

CAIRN_INLINE Pack weight_of(const PackVec& force, const Pack& mass) {
  return dot(force, force) / mass;
}

/// Of the wrenches at(g, count), the PackWrench of the `count` groups from g on, on groups at `positions`
/// (m), of `masses` (kg), with places from `origin` (m). Sums run in a fixed order, in parallel.
template <class At>
NetWrench net_wrench(std::span<const Vec3> positions, std::span<const double> masses, const Vec3& origin,
                     const At& at) {
  return parallel_block_sum(
      positions.size(), 512, NetWrench{}, [&](std::size_t begin, std::size_t end) HWY_ATTR {
        const PackVec zero = spread(origin);
        PackVec net_force = zeros(), net_torque = zeros(), first = zeros(), diagonal = zeros(),
                mixed = zeros();
        Pack mass = 0.0, weight = 0.0;
        for (std::size_t g = begin; g < end; g += kPack) {
          const std::size_t count = end - g;
          const PackWrench w = at(g, count);
          const PackVec x = load(&positions[g], count) - zero;
          const Pack m = load_masses(masses, g, count), part = weight_of(w.force, m);
          net_force = net_force + w.force;
          net_torque = net_torque + cross(x, w.force) + w.torque;
          mass += count >= kPack ? m : head(count) * m;
          weight += part;
          const PackVec moment{part * x.x, part * x.y, part * x.z};
          first = first + moment;
          diagonal = diagonal + PackVec{moment.x * x.x, moment.y * x.y, moment.z * x.z};
          mixed = mixed + PackVec{moment.y * x.z, moment.z * x.x, moment.x * x.y};
        }
        const Vec3 d = sum(diagonal), s = sum(mixed);
        Mat3 second;
        second << d.x(), s.z(), s.y(), s.z(), d.y(), s.x(), s.y(), s.x(), d.z();
        return NetWrench{sum(net_force), sum(net_torque), sum(mass), sum(weight), sum(first), second};
      });
}

/// The wrenches on kPack groups at x (m), of masses m, with the change.
CAIRN_INLINE PackWrench balanced(const Balance& balance, const PackVec& x, const Pack& m,
                                 const PackWrench& w) {
  const PackVec lever = x - spread(balance.origin);
  const Pack weight = weight_of(w.force, m);
  return {fma(weight, spread(balance.shift) + cross(spread(balance.rotation), lever), w.force),
          fma(m, spread(balance.torque), w.torque)};
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#endif
