// Gravity by the sum over all pairs: the reference, and the quickest method for a few thousand points.
#pragma once

#include "gravity/point_arrays.h"
#include "gravity/points.h"

namespace cairn::gravity {

class DirectSum {
 public:
  /// Acceleration (m/s^2) of every point by the points of other groups, to round-off, and its potential
  /// (J/kg) when `potential` is not empty. Same bits for any number of threads. Throws as `check` does.
  void evaluate(const Points& points, std::span<Vec3> acceleration, std::span<double> potential = {});
  /// Accelerations (m/s^2) of the points with these numbers only.
  void evaluate_at(std::span<const std::size_t> numbers, const Points& points, std::span<Vec3> acceleration);

 private:
  PointArrays arrays_;
};

}  // namespace cairn::gravity
