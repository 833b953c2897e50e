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
    state.box = setup.box;
    place_spheres(state.bodies);
  }

  bool touching() const {
    for (std::size_t slot = 0; slot < state.contacts.slots(); ++slot)
      if (state.contacts.touching(slot)) return true;
    return !state.walls.contacts.empty();
  }

  double kinetic_energy() const {
    const Bodies& bodies = state.bodies;
    double energy = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      energy += 0.5 * bodies.mass[b] * bodies.velocity[b].squaredNorm() +
                0.5 * bodies.spin[b].dot(angular_velocity(bodies, b));
    return energy;
  }

  double spring_energy() const {
    return stored_energy(state.bodies, physics.contacts, state.contacts) +
           state.walls.stored_energy(state.bodies, physics.contacts, state.clock.time());
  }
};

}  // namespace cairn
