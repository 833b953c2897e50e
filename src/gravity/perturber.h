// Point masses outside the bodies: planets, the Sun, the other half of a binary.
#pragma once

#include <span>
#include <string>
#include <variant>

#include "gravity/kepler.h"
#include "gravity/track.h"

namespace cairn::gravity {

/// A fixed point (m), a Kepler orbit or a table.
using Orbit = std::variant<Vec3, KeplerOrbit, Track>;

Motion motion(const Orbit& orbit, double time);

/// Shortest distance (m) of the orbit from the zero; of a table its nearest row's.
double closest(const Orbit& orbit);

struct Perturber {
  std::string name;
  double gm;      ///< m^3/s^2
  double radius;  ///< m; 0: a point
  bool tidal;     ///< the zero of the frame falls freely in its pull
  Orbit orbit;    ///< about the zero of the frame
};

/// What a perturber does now.
struct Pull {
  double gm;   ///< m^3/s^2
  Vec3 place;  ///< m
  bool tidal;  ///< less the pull on the zero
};

/// Adds the accelerations (m/s^2) at `positions` (m). With D the place and x a position,
///   tidal:  gm [(D - x)/|D - x|^3 - D/|D|^3],  else  gm (D - x)/|D - x|^3.
/// The difference is formed without cancellation [Battin 1999, An Introduction to the Mathematics and Methods
/// of Astrodynamics, section 8.4]: -gm/|D - x|^3 (x + f D), f = q (3 + 3q + q^2) / (1 + (1 + q)^(3/2)),
/// q = x.(x - 2D)/D^2; wherever x is, it is good to a few units in the last place of itself or of
/// gm |x|/|D - x|^3 if that is larger. Returns
/// the square of the least |D - x| (m^2). Bitwise independent of how positions are split between calls.
double add_pull(const Pull& pull, std::span<const Vec3> positions, std::span<Vec3> acceleration);

}  // namespace cairn::gravity
