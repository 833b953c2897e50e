// Motion on a conic about a point mass. One set of formulas, in the universal anomaly, serves ellipses,
// parabolas and hyperbolas, so nothing is lost where one passes into the other.
#pragma once

#include "core/math.h"

namespace cairn::gravity {

/// Where something is (m) and how it moves (m/s).
struct Motion {
  Vec3 position, velocity;
};

/// Orbital elements.
struct KeplerOrbit {
  double gm;              ///< m^3/s^2, of both masses together
  double periapsis;       ///< m, distance
  double eccentricity;    ///< below 1 an ellipse, above 1 a hyperbola
  double inclination;     ///< rad, of the plane to x y
  double node;            ///< rad, of the ascending node, from x
  double argument;        ///< rad, of the periapsis, from the node
  double periapsis_time;  ///< s
};

/// Place and velocity at `time` (s), relative to the focus, to a few units in the last place of the distance
/// and the speed at the time since periapsis as a double tells it.
Motion motion(const KeplerOrbit& orbit, double time);

/// Period (s); infinite unless the orbit is an ellipse.
double period(const KeplerOrbit& orbit);

/// Mean motion (rad/s), sqrt(gm / |a|^3); 0 for a parabola.
double mean_motion(const KeplerOrbit& orbit);

}  // namespace cairn::gravity
