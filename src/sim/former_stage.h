// The stage that the contacts of another one come from.
#pragma once

#include <optional>
#include <vector>

#include "sim/physics.h"

namespace cairn {

/// The last stage that has taken time.
struct FormerStage {
  Physics physics;          ///< its laws at its stiffness, see resolve_laws
  Walls walls;              ///< with their laws
  bool same_bodies = true;  ///< no operation has changed them since
  std::size_t number = 0;   ///< in its scene
};

/// The last stage before stage `end` that takes time; none: there is none.
std::optional<std::size_t> last_timed_stage(const Scene& scene, std::size_t end);

/// That before stage `index`, whose stiffness is still state.k_n, with those of the scene's `walls` that it
/// had; none: no stage of this run has taken time yet.
std::optional<FormerStage> former_stage(const Scene& scene, std::size_t index, const State& state,
                                        const std::vector<Wall>& walls);

}  // namespace cairn
