#include "sim/spin_control.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/axes.h"
#include "analysis/budget.h"
#include "analysis/fragments.h"
#include "analysis/spin_state.h"
#include "contact/stiffness.h"
#include "sim/agitation.h"

namespace cairn {

namespace {

constexpr double kAtRest = 1e-3;           // agitation over gravitational energy
constexpr double kJump = 0.05;             // centrifugal over gravitational pull at the surface
constexpr double kPeriodResolution = 3.6;  // s, of the failure period: 0.001 h

/// Agitation over the pile's gravitational energy as that of a uniform ball, or the energy of its rotation
/// where that is more.
double relative_agitation(const Physics& physics, const State& state) {
  const SpinState whole = spin_state(state.bodies, all_bodies(state.bodies));
  double scale = 0.5 * rotation_rate(whole).dot(whole.angular_momentum);
  if (physics.gravity != GravityMethod::none)
    scale = std::max(scale, 0.3 * whole.mass * squared(escape_speed(state.bodies)));
  const double energy = agitation(state, budget(state.bodies));
  return energy > 0.0 ? energy / scale : 0.0;
}

/// How the pile turns about z (rad/s).
double spin_rate(const State& state) {
  std::vector<std::uint32_t> pile;
  for (std::uint32_t b = 0; b < state.bodies.size(); ++b)
    if (state.remnant[b]) pile.push_back(b);
  return 2.0 * kPi / spin_period(spin_state(state.bodies, pile), Vec3::UnitZ());
}

/// Time (s) from t on in which the period of the path changes by the resolution, `most` at most.
double time_of_change(const std::vector<SpinPoint>& path, double t, double most) {
  const double start = period_at(path, t);
  double from = t, period = start;
  const auto reaches = [&](double to) -> std::optional<double> {
    const double there = period_at(path, to);
    if (std::abs(there - start) < kPeriodResolution) return std::nullopt;
    const double bound = there > start ? start + kPeriodResolution : start - kPeriodResolution;
    return from + (to - from) * (bound - period) / (there - period) - t;
  };
  for (const SpinPoint& point : path) {
    if (point.time <= t || point.time >= t + most) continue;
    if (const auto found = reaches(point.time)) return *found;
    from = point.time;
    period = point.period;
  }
  return reaches(t + most).value_or(most);
}

/// Time (s) between two looks at the pile, at most.
double longest_interval(const Physics& physics) {
  return physics.spin->check_interval.value_or(physics.fall_time / 20.0);
}

std::uint64_t steps_to_check(const Physics& physics, double stage_time) {
  const double interval = physics.spin->check_interval.value_or(
      time_of_change(physics.spin->path, stage_time, longest_interval(physics)));
  return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(interval / physics.contacts.dt), 1,
                                   longest_check(physics));
}

/// Sets the reference, or judges against it.
void judge(const Physics& physics, double ratio, State& state) {
  Control& control = state.control;
  const double time = state.clock.time(), period = target_period(physics, control, state.clock.stage_time());
  if (!control.settled) {
    control.start_ratio = ratio;
    control.limit_ratio = ratio * (1.0 - physics.spin->axis_drop);
    control.start_time = time;
    control.settled =
        state.clock.stage_time() >= physics.spin->ramp && relative_agitation(physics, state) <= kAtRest;
    return;
  }
  if (ratio >= control.limit_ratio) {
    control.fall_time = -1.0;
    return;
  }
  if (control.fall_time < 0.0) {
    control.fall_time = time;
    control.fall_period = period;
    control.fall_ratio = ratio;
  }
  if (time - control.fall_time < control.hold) return;
  control.failed = true;
  state.region_volume = 0.0;  // the pile no longer fills it
  control.failure_time = control.fall_time;
  control.failure_period = control.fall_period;
  control.failure_ratio = control.fall_ratio;
  control.active = physics.spin->on_failure == OnFailure::keep;
}

void look_at_pile(const Physics& physics, State& state) {
  const Bodies& bodies = state.bodies;
  const std::vector<std::uint32_t> pile =
      find_fragments(bodies, physics.link_gap, state.box, &state.contacts).members(0);
  std::fill(state.remnant.begin(), state.remnant.end(), std::uint8_t{0});
  for (const std::uint32_t b : pile) state.remnant[b] = 1;
  if (!state.control.failed) judge(physics, axis_lengths(bodies, pile).c_over_a(), state);
  state.control.next_check = state.clock.step + steps_to_check(physics, state.clock.stage_time());
}

double hours(double seconds) {
  return seconds / 3600.0;
}

}  // namespace

std::uint64_t longest_check(const Physics& physics) {
  return std::max<std::uint64_t>(1,
                                 static_cast<std::uint64_t>(longest_interval(physics) / physics.contacts.dt));
}

double target_period(const Physics& physics, const Control& control, double stage_time) {
  if (!physics.spin) return std::numeric_limits<double>::quiet_NaN();
  const double period = period_at(physics.spin->path, stage_time);
  if (stage_time >= physics.spin->ramp) return period;
  const double u = stage_time / physics.spin->ramp, part = u * u * (3.0 - 2.0 * u);
  return 2.0 * kPi / (control.start_rate + part * (2.0 * kPi / period - control.start_rate));
}

void begin_control(const Physics& physics, State& state) {
  Control& control = state.control;
  control.active = physics.spin.has_value();
  if (!control.active) return;
  control = Control{.active = true,
                    .hold = physics.spin->axis_hold.value_or(0.25 * physics.fall_time),
                    .shortest_period = control.shortest_period};
  look_at_pile(physics, state);
  control.start_rate = spin_rate(state);
}

std::vector<std::string> control_warnings(const Physics& physics, const State& state) {
  std::vector<std::string> out;
  if (!physics.spin) return out;
  if (const double agitated = relative_agitation(physics, state); agitated > kAtRest)
    out.push_back(
        fmt::format("the pile is not at rest when control of its spin begins (agitation {:.2g} of its "
                    "gravitational energy, "
                    "{:g} at rest): no fall of c/a counts as failure until it is; let it settle first, at "
                    "the period of the "
                    "path's start",
                    agitated, kAtRest));
  const double first = 2.0 * kPi / period_at(physics.spin->path, 0.0), rate = state.control.start_rate;
  if (physics.spin->ramp == 0.0 &&
      std::abs(first * first - rate * rate) * physics.fall_time * physics.fall_time > kJump)
    out.push_back(
        fmt::format("control of the spin begins with a jump, from {} to {:.4g} h in one step: give "
                    "spin.ramp, the time for "
                    "it (s), some {:.2g}",
                    std::abs(rate) > 1e-3 * first ? fmt::format("{:.4g} h", hours(2.0 * kPi / rate)) : "rest",
                    hours(2.0 * kPi / first), 2.0 * physics.fall_time));
  return out;
}

void control_spin(const Physics& physics, const std::vector<std::uint8_t>& everyone, State& state) {
  Control& control = state.control;
  if (!control.active) return;
  const double time = state.clock.stage_time();
  if (state.clock.step % physics.control_steps == 0) {
    const double period = target_period(physics, control, time);
    const SpinCorrection done =
        impose_period(state.bodies, physics.spin->include_shed ? everyone : state.remnant, period);
    state.ledger.control_momentum += done.momentum;
    state.ledger.control_work += done.work;
    if (time >= physics.spin->ramp)
      control.shortest_period =
          control.shortest_period == 0.0 ? period : std::min(control.shortest_period, period);
  }
  if (state.clock.step >= control.next_check) look_at_pile(physics, state);
}

bool failed_long_ago(const Physics& physics, const State& state) {
  const auto& spin = physics.spin;
  return spin && spin->after_failure && state.control.failed &&
         state.clock.time() - state.control.failure_time >= *spin->after_failure;
}

std::string describe_failure(const State& state) {
  const Control& c = state.control;
  return fmt::format(
      "the pile has failed at a period of {:.4f} h, t = {:.6g} s: its c/a fell from {:.4f} at rest to {:.4f} "
      "and "
      "stayed below {:.4f} for {:.4g} s; {}",
      hours(c.failure_period), c.failure_time, c.start_ratio, c.failure_ratio, c.limit_ratio, c.hold,
      c.active ? "its spin stays prescribed" : "it is left to itself");
}

std::vector<std::string> failure_warnings(const Physics& physics, const State& state) {
  const auto& path = physics.spin->path;
  const double since = state.control.failure_time - state.clock.stage_start - path.front().time,
               length = path.back().time - path.front().time;
  if (since >= 0.01 * length) return {};
  return {fmt::format(
      "failure came within the first percent of the path: was the pile settled at {:.4g} h before?",
      hours(path.front().period))};
}

}  // namespace cairn
