// The point masses at sphere centres that gravity pulls.
#pragma once

#include <vector>

#include "core/math.h"

namespace cairn {

/// Mass fractions at `offsets` (from the centre of mass) with sum 1 and zero first moment, nearest to the
/// given weights (sum 1): least sum of (m - w)^2 / w with every m at least a thousandth of its w. Empty when
/// no such masses exist: the centre of mass then lies outside the hull of the offsets, or at its edge.
std::vector<double> gravity_masses(const std::vector<Vec3>& offsets, const std::vector<double>& weights);

}  // namespace cairn
