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
    state.bodies = std::move(setup.bodies);
    state.frame = setup.frame;
    state.shift = setup.shift;
    state.box = setup.box;
    place_spheres(state.bodies);
  }
};

}  // namespace cairn
