// External fields: the uniform one, and the pull of perturbers on every sphere's centre.
#pragma once

#include "sim/physics.h"
#include "sim/state.h"

namespace cairn {

/// Sums over a block of bodies.
struct PerturberSums {
  PerturberRates rates;        ///< torque about the mass centre of body 0
  Vec3 moment = Vec3::Zero();  ///< kg m, of the masses about it
};

/// What add_external makes afresh at every call.
struct ExternalScratch {
  std::vector<Vec3> places, pulls;  ///< of spheres, m and m/s^2
  std::vector<PerturberSums> sums;  ///< of blocks of bodies
};

/// Adds the wrenches of external fields to those held in the bodies, as the last of all, and books what
/// perturbers give: a wrench acts for half of `dt` (s) on either side of its evaluation; velocities are those
/// of half a step before.
/// @throws UnstableError when a sphere touches a perturber, or InputError before the first step.
void add_external(const Physics& physics, double dt, State& state, ExternalScratch& scratch);

/// From the bodies' mass centre to the nearest perturber (m); NaN without any.
double perturber_distance(const Physics& physics, const State& state, const Vec3& center);

}  // namespace cairn
