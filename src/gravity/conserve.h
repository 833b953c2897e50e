// What makes self-gravity conserve momentum and angular momentum to round-off: the little that a method or a
// hold leaves of net force and net torque is taken away, as the smallest (mass-weighted) change that does it.
#pragma once

#include <span>

#include "core/math.h"

namespace cairn::gravity {

/// Mass (kg) and centre of mass (m) of points; the mean position of massless ones.
struct MassCentre {
  double mass;
  Vec3 centre;
};
MassCentre mass_centre(std::span<const Vec3> positions, std::span<const double> masses);

/// A torque (N m) on point masses as the angular acceleration (rad/s^2) that rigid points would take from it;
/// the rest is what they cannot take: the part along the line of collinear points, and all of it in one
/// place.
struct Turn {
  Vec3 acceleration, rest;
};

/// Principal moments below `smallest` times the largest count as none. Inertia (kg m^2) about the mass
/// centre.
Turn turn(const Mat3& inertia, const Vec3& torque, double smallest);

/// Inertia (kg m^2) of point masses about `centre`.
Mat3 inertia(std::span<const Vec3> positions, std::span<const double> masses, const Vec3& centre);

/// Subtracts from accelerations (m/s^2) the translation and the rigid rotation field that leave no net force
/// and no net torque. Sums run in a fixed order, in parallel.
void remove_net(std::span<const Vec3> positions, std::span<const double> masses,
                std::span<Vec3> acceleration);

/// Force (N) on and torque (N m) about `centres` of every group: points [first[g], first[g+1]).
void sum_groups(std::span<const Vec3> positions, std::span<const double> masses,
                std::span<const std::uint32_t> first, std::span<const Vec3> acceleration,
                std::span<const Vec3> centres, std::span<Vec3> force, std::span<Vec3> torque);

}  // namespace cairn::gravity
