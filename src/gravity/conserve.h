// What makes self-gravity conserve momentum and angular momentum to round-off: the little that a method or a
// forecast leaves of net force and net torque is taken away, by the smallest change relative to what each
// group feels. Groups far from the others, which feel little, are changed little.
#pragma once

#include <span>
#include <vector>

#include "core/math.h"

namespace cairn::gravity {

/// Forces (N) on groups and torques (N m) about their centres of mass; no torques where all groups are
/// points.
struct Wrenches {
  std::vector<Vec3> force, torque;

  bool operator==(const Wrenches&) const = default;
};

/// Force (N) on and torque (N m) about `centres` of every group: points [first[g], first[g+1]).
void sum_groups(std::span<const Vec3> positions, std::span<const double> masses,
                std::span<const std::uint32_t> first, std::span<const Vec3> acceleration,
                std::span<const Vec3> centres, Wrenches& out);

/// A torque (N m) on weighted points as the rotation a that weight (a x arm) makes of it; the rest is what
/// has no lever: the part along the line of collinear points, and all of it in one place.
struct Turn {
  Vec3 rotation, rest;
};

/// `inertia`: of the weights about their centre. Principal moments below `smallest` times the largest count
/// as none.
Turn turn(const Mat3& inertia, const Vec3& torque, double smallest);

/// Sums over groups that tell what a balance takes. A group's weight is |F|^2 / m, roughly.
struct NetWrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();  ///< about the origin
  double mass = 0.0, weight = 0.0;
  Vec3 first = Vec3::Zero();   ///< of the weight
  Mat3 second = Mat3::Zero();  ///< of the weight

  NetWrench& operator+=(const NetWrench& other);
};

/// The change of wrenches that leaves no net force and no net torque: of forces by weight (shift + rotation x
/// X), which is the smallest change relative to |F| / sqrt(m) that does it; what torque they have no lever
/// for is taken from the groups' own torques, in proportion to mass.
struct Balance {
  Vec3 origin = Vec3::Zero();  ///< m; a pile far from the zero keeps its digits
  Vec3 shift = Vec3::Zero(), rotation = Vec3::Zero();
  Vec3 torque = Vec3::Zero();  ///< over mass
};

/// That for groups whose wrenches, with places from `origin`, sum up to `net`.
Balance balance(const NetWrench& net, const Vec3& origin);

}  // namespace cairn::gravity
