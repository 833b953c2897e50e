// Gravity held between renewals. Between two evaluations the force and torque on every group turn with the
// pile and are cleared of net force and net torque at the groups' present places, so that momentum and
// angular momentum are conserved to round-off at every step however rarely gravity is renewed.
#pragma once

#include <span>
#include <vector>

#include "core/math.h"

namespace cairn::gravity {

/// The last evaluation; persistent state, part of a checkpoint.
struct HeldGravity {
  std::vector<Vec3> force;    ///< on each group at `time`, N
  std::vector<Vec3> torque;   ///< about each group's centre of mass at `time`, N m
  double time = 0.0;          ///< of the evaluation, s
  Vec3 omega = Vec3::Zero();  ///< angular velocity of the pile at `time`, rad/s
  double scale = 0.0;         ///< rms acceleration of the spheres then, m/s^2
  double factor = 0.0;  ///< tolerance of the tree's interactions over `scale`; 0: by opening angle alone
  double error = 0.0;   ///< of the field, measured when the factor was chosen; 0: not measured
};

/// Clears forces (N) and torques (N m) on groups of their net force and of their net torque about the mass
/// centre, sum (X - X_cm) x F + T: by a translation and a rigid rotation field of the group centres, and,
/// along axes about which the centres have next to no inertia (one group; groups on a line), by torques in
/// proportion to mass.
void remove_net_wrench(std::span<const Vec3> group_positions, std::span<const double> group_masses,
                       std::span<Vec3> force, std::span<Vec3> torque);

/// Takes over an evaluation, cleared of its net force and net torque.
void renew(HeldGravity& held, std::span<const Vec3> group_positions, std::span<const double> group_masses,
           std::span<const Vec3> force, std::span<const Vec3> torque, double time, const Vec3& omega);

/// Force (N) and torque (N m) on the groups at `time` (s) and at their present positions (m): the held ones
/// turned by exp(omega (time - held.time)) and cleared of their net. At the time of the evaluation it returns
/// that.
void extrapolate(const HeldGravity& held, double time, std::span<const Vec3> group_positions,
                 std::span<const double> group_masses, std::span<Vec3> force, std::span<Vec3> torque);

}  // namespace cairn::gravity
