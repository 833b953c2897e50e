// Axis lengths of a pile.
#pragma once

#include <span>

#include "body/bodies.h"

namespace cairn {

/// Full lengths along the principal axes of inertia, sphere surfaces included, in decreasing order.
struct AxisLengths {
  double a = 0.0, b = 0.0, c = 0.0;  ///< m
  Mat3 axes = Mat3::Identity();      ///< columns: the directions of a, b, c

  double b_over_a() const { return b / a; }
  double c_over_a() const { return c / a; }
};

/// Axis lengths max(x.e + r) - min(x.e - r) of the given bodies, e the principal axes of that set [Zhang et
/// al. 2017, Icarus 294, 98]. Sphere centres must be up to date. @throws InputError for an empty set.
AxisLengths axis_lengths(const Bodies& bodies, std::span<const std::uint32_t> set);

}  // namespace cairn
