// Motion through tabulated places.
#pragma once

#include <vector>

#include "gravity/kepler.h"

namespace cairn::gravity {

/// A cubic between each two rows of a table. With velocities in the table the Hermite cubic; without, the
/// not-a-knot spline, whose acceleration is continuous too [de Boor 1978, A Practical Guide to Splines,
/// chapter IV]. Both are of fourth order in the distance of the rows.
class Track {
 public:
  static constexpr std::size_t kLeastSpline = 4, kLeastHermite = 2;  ///< rows

  /// Times (s) increase; places in m. At least kLeastSpline rows.
  Track(std::vector<double> times, std::vector<Vec3> places);
  /// With velocities (m/s). At least kLeastHermite rows.
  Track(std::vector<double> times, std::vector<Vec3> places, std::vector<Vec3> velocities);

  /// Place and velocity at `time` (s); beyond the ends the first and the last cubic go on.
  Motion at(double time) const;

  /// Shortest distance of a row from the zero (m).
  double closest() const;

 private:
  std::vector<double> times_;
  std::vector<Vec3> places_, velocities_;
};

}  // namespace cairn::gravity
