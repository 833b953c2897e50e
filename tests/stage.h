// The first stage of a scene given as text, driven step by step.
#pragma once

#include <string>

#include "sim/make_walls.h"
#include "sim/spin_control.h"
#include "sim/step.h"

namespace cairn {

/// Bodies are put into `state` by hand, or by Experiment as the scene says.
struct Stage {
  Scene scene;
  State state;
  Physics physics;
  Scratch scratch;

  explicit Stage(const std::string& text) : scene(parse_scene(text, "stage.toml", ".")) {
    state.walls.walls = make_walls(scene);
    state.walls.resize(scene.walls.size());
    if (scene.box) state.box.edge = scene.box->size;
  }

  /// Resolves the stage for the bodies as they are now and evaluates the first wrenches.
  void begin(const std::vector<ContactRecord>& inherited = {}) {
    state.remnant.resize(state.bodies.size(), 1);
    physics = resolve_physics(scene, 0, state.bodies,
                              resolve_stiffness(scene, 0, state.bodies, state.walls, state.k_n).k_n);
    begin_stage(physics, inherited, state, scratch);
    state.clock.steps = physics.steps;
    state.clock.dt = physics.contacts.dt;
    begin_control(physics, state);
  }

  void advance(std::uint64_t steps) {
    for (std::uint64_t k = 0; k < steps; ++k) step(physics, state, scratch);
  }

  bool touching() const {
    for (std::size_t slot = 0; slot < state.contacts.slots(); ++slot)
      if (state.contacts.touching(slot)) return true;
    return !state.walls.contacts.empty();
  }

  double kinetic_energy() const {
    const Bodies& bodies = state.bodies;
    double energy = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (is_held(bodies, b)) continue;
      energy += 0.5 * bodies.mass[b] * bodies.velocity[b].squaredNorm() +
                0.5 * bodies.spin[b].dot(angular_velocity(bodies, b));
    }
    return energy;
  }

  double spring_energy() const {
    return stored_energy(state.bodies, physics.contacts, state.contacts) +
           state.walls.stored_energy(state.bodies, physics.contacts, state.clock.time());
  }
};

}  // namespace cairn
