// The pull of perturbers on every sphere's centre, and the ledger of what it gives.
#pragma once

#include "sim/physics.h"
#include "sim/state.h"

namespace cairn {

/// What add_perturbers makes afresh at every call.
struct PerturberScratch {
  std::vector<Vec3> places, pulls;  ///< of spheres, m and m/s^2
};

/// Adds the wrenches of perturbers, as the last of all, to those held in the bodies, and books what they
/// give: a wrench acts for half of `dt` (s) on either side of its evaluation; velocities are those of half a
/// step before.
/// @throws UnstableError when a sphere touches a perturber, or InputError before the first step.
void add_perturbers(const Physics& physics, double dt, State& state, PerturberScratch& scratch);

/// From the bodies' mass centre to the nearest perturber (m); NaN without any.
double perturber_distance(const Physics& physics, const State& state, const Vec3& center);

}  // namespace cairn
