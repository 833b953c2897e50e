// Whether the contacts hold more energy at the start of a stage than the bodies can take: spheres that were
// put into each other, or that have settled with softer contacts, push a pile apart.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/former_stage.h"
#include "sim/observe.h"
#include "sim/physics.h"
#include "sim/state.h"

namespace cairn {

/// What the contacts hold at the start of a stage beyond what they held before.
struct StartEnergy {
  double excess = 0.0;  ///< J
  double scale = 0.0;   ///< J, what it is compared with
  const char* of = "";  ///< which that is
  Pair deepest{0, 0};   ///< spheres with the greatest overlap; i == j: none touch, or it is on a wall
  std::optional<std::uint32_t> wall;  ///< by its number in the scene, where the greatest overlap is
  double overlap = 0.0;               ///< of them, over the smaller radius
  double stiffer = 1.0;               ///< the stiffness over that of the contacts before, at most
  bool relaxes = false;               ///< the stage takes it out
  double duration = 0.0;              ///< s, that a stage which takes it out will need, roughly

  /// excess over scale; 0 for contacts that hold no more than before.
  double ratio() const;
  /// Whether that is worth a warning.
  bool counts() const { return ratio() > 0.01; }
};

/// What the contacts that a stage inherits were before.
struct HeldBefore {
  double energy = 0.0;  ///< J, that they held in balance, at the places now; 0 for bodies put together anew,
                        ///< or changed since
  SweepSettings contacts;  ///< with the laws that they obeyed; no laws: there were none
};

/// That of stage `index` with `physics`. `state` is as before begin_stage, and `contacts` as leave_stiffness
/// has left them under the laws `former`; null: these are not known, and taken for those of the stage at the
/// stiffness of then.
HeldBefore held_before(const Scene& scene, std::size_t index, const Physics& physics, const State& state,
                       const std::vector<ContactRecord>& contacts, const Physics* former);

/// Energy (J) in the springs that stage `index` forgets: those on walls that it lacks, all of them where it
/// has no contacts; 0 for bodies changed since the stage `former`. `state` is as before set_walls, its
/// contacts with walls by the numbers of these in the scene; all contacts are as leave_stiffness has left
/// them.
double forgotten_energy(const Scene& scene, std::size_t index, const FormerStage& former, const State& state,
                        const std::vector<ContactRecord>& contacts);

/// What is beyond that `held` before, compared with the gravitational energy, or where there is no
/// self-gravity with the energy of the motion in the pile or the work of the field over a radius, the larger
/// of them. `state` and its observation are as after begin_stage.
StartEnergy start_energy(const Physics& physics, const State& state, const Observation& observation,
                         const HeldBefore& held);

/// One line for people: what the contacts hold, the deepest pair, and what to do.
std::string describe(const StartEnergy& energy, const Scene& scene, const Bodies& bodies);

}  // namespace cairn
