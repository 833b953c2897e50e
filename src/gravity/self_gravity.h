// The held gravity at one moment.
#pragma once

#include <span>
#include <vector>

#include "gravity/renewal.h"

namespace cairn::gravity {

/// What the wrenches of one moment are made from.
struct HeldWrenches {
  const HeldGravity& held;
  std::span<const Vec3> positions;  ///< m
  std::span<const double> masses;   ///< kg
  Mat3 turned;                      ///< rotation to space
  double part;                      ///< of the interval that has passed; 0: nothing changes
};

/// Wrenches on groups at their present places, in space, balanced. It looks at what it is made from, which
/// has to stay.
class SelfGravity {
 public:
  /// At `time` (s), on groups at `positions` (m), of `masses` (kg).
  SelfGravity(const HeldGravity& held, double time, std::span<const Vec3> positions,
              std::span<const double> masses);

  /// Forces (N) and torques (N m) on groups [begin, end); torques of points are those of the balance.
  void get(std::size_t begin, std::size_t end, std::vector<Vec3>& force, std::vector<Vec3>& torque) const;

 private:
  HeldWrenches wrenches_;
  Balance balance_;
};

}  // namespace cairn::gravity
