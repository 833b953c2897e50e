// Taking bodies out of a scene.
#pragma once

#include <limits>
#include <vector>

#include "body/bodies.h"

namespace cairn {

/// Number of a sphere that is no longer there.
inline constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

/// Keeps the bodies marked in `keep`, in their order. Returns the new number of each former sphere, or kGone.
std::vector<std::uint32_t> select_bodies(Bodies& bodies, const std::vector<std::uint8_t>& keep);

}  // namespace cairn
