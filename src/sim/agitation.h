// The motion of bodies that is not that of one rigid whole.
#pragma once

#include "analysis/budget.h"
#include "sim/state.h"

namespace cairn {

/// Kinetic and rotational energy (J) less that of the rigid motion with the same momentum and angular
/// momentum; images cannot turn, and where there are walls or held bodies no motion counts as rigid.
double agitation(const State& state, const Budget& total);

}  // namespace cairn
