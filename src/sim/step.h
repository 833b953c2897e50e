// One step: kick, drift, neighbours, gravity, contacts, kick, control.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "contact/candidates.h"
#include "gravity/direct.h"
#include "gravity/fmm.h"
#include "sim/former_stage.h"
#include "sim/perturbers.h"
#include "sim/state.h"

namespace cairn {

enum class Phase { motion, search, contacts, gravity, control, output };
inline constexpr std::array<std::string_view, 6> kPhaseNames{"motion",  "search",  "contacts",
                                                             "gravity", "control", "output"};

/// Wall-clock seconds by phase.
using PhaseTimes = std::array<double, kPhaseNames.size()>;

/// What is made afresh whenever needed: throwing it away at any step changes no bit of the result.
struct Scratch {
  Candidates candidates;
  std::uint64_t list_age = 0;  ///< steps since the candidates were found
  WallCandidates wall_candidates;
  std::vector<SphereMotion> motions;
  std::vector<std::uint8_t> everyone;  ///< marks all bodies
  gravity::DirectSum direct;
  gravity::Fmm tree;
  std::vector<Vec3> acceleration;                ///< of gravity, on spheres
  gravity::Wrenches wrenches;                    ///< of gravity, on bodies
  std::vector<Vec3> body_places, sphere_places;  ///< for gravity
  PerturberScratch perturbers;
  std::vector<std::vector<std::uint32_t>> piles;  ///< bodies of each pile that relaxes
  PhaseTimes times{};
};

/// Prepares a stage: the contacts it inherits, left as leave_stiffness does, take its stiffness and materials
/// (springs keep their forces, and dashpots the effective masses of first touch where `former` tells them),
/// wrenches are evaluated at the present poses and velocities.
/// @throws InputError when bodies overlap beyond the bound before the first step, when the box is too small
/// for them, and when its strain leads away from the packing fraction asked for.
void begin_stage(const Physics& physics, std::vector<ContactRecord> contacts, State& state, Scratch& scratch,
                 const FormerStage* former = nullptr);

/// Restores what a checkpoint does not hold, without changing the state.
void prepare_scratch(const Physics& physics, State& state, Scratch& scratch);

/// Advances the state by one step.
/// @throws UnstableError when an overlap passes the bound, a position is not finite or the box becomes too
/// small.
void step(const Physics& physics, State& state, Scratch& scratch);

/// Why the stage is over after the step just done; empty while it is not. Changes nothing.
std::string why_stage_ends(const Physics& physics, const State& state, Scratch& scratch);

/// Gravitational energy of the spheres of different bodies (J), by the method of the stage.
double gravitational_energy(const Physics& physics, const State& state, Scratch& scratch);

}  // namespace cairn
