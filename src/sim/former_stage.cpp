#include "sim/former_stage.h"

#include "sim/make_walls.h"

namespace cairn {

std::optional<FormerStage> former_stage(const Scene& scene, std::size_t index, const State& state,
                                        const std::vector<Wall>& walls) {
  std::size_t stage = index;
  while (stage > 0 && scene.stages[stage - 1].operates()) --stage;
  if (stage-- == 0) return {};
  FormerStage former{resolve_laws(scene, stage, state.bodies, state.k_n), {}, stage + 1 == index};
  set_walls(scene, stage, walls, state.stage_starts, former.walls);
  former.walls.set_laws(former.physics.materials, former.physics.wall_materials, state.k_n);
  return former;
}

}  // namespace cairn
