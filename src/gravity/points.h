// The input of every gravity method: point masses, and which of them belong together rigidly.
#pragma once

#include <span>

#include "core/math.h"

namespace cairn::gravity {

/// Point masses in rigid groups; points of one group do not attract each other.
struct Points {
  std::span<const Vec3> positions;       ///< m
  std::span<const double> masses;        ///< kg, not negative
  std::span<const std::uint32_t> first;  ///< points [first[g], first[g+1]) are group g; groups+1 entries

  std::size_t size() const { return positions.size(); }
  std::size_t groups() const { return first.empty() ? 0 : first.size() - 1; }
};

/// Points closer than this do not attract each other (m): their force has no direction.
inline constexpr double kCoincident = 1e-60;

/// Throws UnstableError naming the first point whose position or mass is not finite or whose mass is
/// negative, and std::invalid_argument when the spans do not fit together.
void check(const Points& points);

}  // namespace cairn::gravity
