// Gravity between evaluations. It is kept in a frame that turns with the pile, where it changes slowly: there
// the force and torque on every group run straight from where they are to a forecast for the next evaluation,
// made from the last two. They are smooth in time, and second order in the interval. At every step they are
// turned to space and balanced at the groups' present places, so that momentum and angular momentum are
// conserved to round-off however rarely gravity is evaluated. While nothing moves, nothing is evaluated.
#pragma once

#include <functional>

#include "gravity/conserve.h"

namespace cairn::gravity {

/// What is known of gravity between evaluations; persistent state, part of a checkpoint.
struct HeldGravity {
  Wrenches from;                     ///< at `time`, in the pile's frame
  Wrenches to;                       ///< forecast for the next evaluation; empty: `from` is held
  Wrenches evaluated;                ///< last evaluation, from which forecasts are made; empty: none are
  std::vector<Vec3> places;          ///< m, of the points at the last evaluation, in the pile's frame then
  double evaluated_time = 0.0;       ///< of the last evaluation, s
  double time = 0.0;                 ///< when gravity was last looked at: evaluated, or found at rest, s
  double interval = 0.0;             ///< from then to the next look, s
  std::uint64_t steps = 0;           ///< the same in steps; 0: there has been no evaluation
  std::uint64_t due = 0;             ///< step of the stage of the next look
  Quat attitude = Quat::Identity();  ///< pile's frame -> space, at `time`
  Vec3 omega = Vec3::Zero();         ///< angular velocity of the pile at `time`, rad/s
  double miss = 0.0;    ///< of the last forecast: |forecast - evaluation| / |evaluation|, rms by mass
  double scale = 0.0;   ///< rms acceleration of the spheres at `time`, m/s^2
  double factor = 0.0;  ///< tolerance of the tree's interactions over `scale`; 0: by opening angle alone
  double error = 0.0;   ///< of the field, measured when the factor was chosen; 0: not measured
};

/// Attitude of the pile's frame at `time` (s).
Quat attitude_at(const HeldGravity& held, double time);

/// Takes over an evaluation at `time` (s), in the pile's frame as it is then, while the pile turns by `omega`
/// (rad/s). `steps` is asked, after the miss is known, how many steps of `dt` (s) the next interval has.
/// Where a forecast has ended an interval of several steps, it goes on from there; else the evaluation counts
/// at once. Without `forecasts` nothing is kept for them.
void renew(HeldGravity& held, const Wrenches& now, std::span<const double> masses, double time,
           const Vec3& omega, double dt, bool forecasts, const std::function<std::uint64_t()>& steps);

/// Whether no point, now at `places` (m, in the pile's frame), has moved by more than `reach` (m) since the
/// last evaluation.
bool rests(const HeldGravity& held, std::span<const Vec3> places, double reach);

/// Instead of an evaluation at `time` (s), where the points rest: for the next `steps` steps of `dt` (s) what
/// has been reached goes back to the last evaluation, and stays there from the next rest on, in a frame that
/// turns by `omega` (rad/s).
void hold_on(HeldGravity& held, double time, const Vec3& omega, double dt, std::uint64_t steps);

/// How far a point may move (m) before the field on it, of grains that fall together in `fall_time` (s,
/// 1 / sqrt(4 pi G rho / 3)), changes by a twentieth of `error` times `scale` (m/s^2): beside a ball it
/// changes by up to 8 pi G rho / 3 per metre. What is held lags behind a slow drift by as much, always to one
/// side.
double reach_at_rest(double error, double scale, double fall_time);

/// The most steps of `dt` (s) between two looks: sqrt(error) times `shortest` (s, of the times in which the
/// field can change), since a forecast errs in second order, and what begins to fall goes that way.
std::uint64_t most_steps(double error, double shortest, double dt);

/// Steps to the next evaluation for the error asked for, at most `most`: the interval grows by at most twice,
/// and shrinks when the last forecast has missed by more than evaluations of that error differ.
std::uint64_t automatic_steps(const HeldGravity& held, double error, std::uint64_t most);

}  // namespace cairn::gravity
