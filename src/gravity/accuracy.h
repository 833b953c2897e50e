// From the error that the user asks for to the settings of the fast method, on the points themselves.
#pragma once

#include "gravity/fmm.h"

namespace cairn::gravity {

/// Settings that meet an error, and what they were found to do.
struct Accuracy {
  FmmSettings settings;
  double factor = 0.0;  ///< tolerance of an interaction over the rms acceleration
  double scale = 0.0;   ///< m/s^2, rms acceleration of the sample
  double error = 0.0;   ///< measured
};

/// The settings that are quickest for an error of the field sqrt(sum |da|^2 / sum |a|^2), in any
/// distribution.
FmmSettings settings_for(double error);

/// Finds the factor by trial: the fast method against the pair sum on a sample of at most 500 points.
/// Deterministic. Throws as `check` does.
Accuracy choose_accuracy(const Points& points, double error);

/// Root mean square of accelerations (m/s^2); sums run in a fixed order.
double rms(std::span<const Vec3> acceleration);

}  // namespace cairn::gravity
