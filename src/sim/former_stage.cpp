#include "sim/former_stage.h"

#include "sim/make_walls.h"

namespace cairn {

std::optional<std::size_t> last_timed_stage(const Scene& scene, std::size_t end) {
  while (end-- > 0)
    if (!scene.stages[end].operates()) return end;
  return {};
}

std::optional<FormerStage> former_stage(const Scene& scene, std::size_t index, const State& state,
                                        const std::vector<Wall>& walls) {
  const std::optional<std::size_t> stage = last_timed_stage(scene, index);
  if (!stage) return {};
  FormerStage former{resolve_laws(scene, *stage, state.bodies, state.k_n), {}, *stage + 1 == index, *stage};
  set_walls(scene, *stage, walls, state.stage_starts, former.walls);
  former.walls.set_laws(former.physics.materials, former.physics.wall_materials, state.k_n);
  return former;
}

}  // namespace cairn
