// One stage of a scene, driven step by step: what the physics tests measure.
#pragma once

#include <string>

#include "pile/assemble.h"
#include "stage.h"

namespace cairn {

/// The first stage of a scene with the bodies it asks for.
struct Experiment : Stage {
  explicit Experiment(const std::string& text) : Stage(text) {
    Setup setup = assemble(scene);
    Walls walls = std::move(state.walls);
    walls.sets = touching_walls(scene, setup.wall_sets);
    state = first_state(std::move(setup));
    state.walls = std::move(walls);
    place_spheres(state.bodies);
  }
};

}  // namespace cairn
