// An order of places that keeps neighbours close in memory.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/math.h"

namespace cairn {

/// Interleaves the bits of a point of the cube from -reach to reach (m): near points get near numbers.
inline std::uint64_t morton(const Vec3& x, double reach) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double unit = (0.5 / reach) * (x[axis] + reach);
    const auto cell = static_cast<std::uint64_t>(std::clamp(unit, 0.0, 0x1.ffffp-1) * 0x1p20);
    for (int bit = 0; bit < 20; ++bit) code |= ((cell >> bit) & 1) << (3 * bit + axis);
  }
  return code;
}

}  // namespace cairn
