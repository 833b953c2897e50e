// Spin control of a stage: keeps the pile on its path, knows which bodies are the pile, and judges whether it
// has failed, on a clock of its own in the step. Nothing that is written or measured takes part in it.
#pragma once

#include <string>
#include <vector>

#include "sim/physics.h"
#include "sim/state.h"

namespace cairn {

/// Period (s) asked for now: that of the path, or within the ramp the one on the way to it. NaN without a
/// path.
double target_period(const Physics& physics, const Control& control, double stage_time);

/// Steps from one look at the pile to the next, at most; the stage has a path.
std::uint64_t longest_check(const Physics& physics);

/// Begins control with the stage, or ends that of the stage before.
void begin_control(const Physics& physics, State& state);

/// What makes a verdict doubtful when control begins: a pile that is not at rest, a jump of its spin. In a
/// line each.
std::vector<std::string> control_warnings(const Physics& physics, const State& state);

/// After a step: imposes the period where a correction is due. Looks at the pile where that is due: finds the
/// bodies that belong to it, and its failure. The pile has failed when its c/a has been below that of the
/// pile at rest by more than `axis_drop` for `axis_hold`; failure is when that fall began [Zhang et al. 2021,
/// section 2.3: 1 %]. Until the pile has been at rest under control (agitation below 1e-3 of its
/// gravitational energy) the reference follows its shape, and no fall counts.
void control_spin(const Physics& physics, const std::vector<std::uint8_t>& everyone, State& state);

/// Whether the stage is to end, for it has gone on for `after_failure` since failure.
bool failed_long_ago(const Physics& physics, const State& state);

/// A line about the failure that control has found, and what makes it doubtful, in a line each.
std::string describe_failure(const State& state);
std::vector<std::string> failure_warnings(const Physics& physics, const State& state);

}  // namespace cairn
