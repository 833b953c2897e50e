#include "sim/step.h"

#include <algorithm>

#include "analysis/spin_state.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/timer.h"
#include "gravity/conserve.h"
#include "motion/drift.h"
#include "motion/spin.h"

namespace cairn {

namespace {

double& time_of(Scratch& scratch, Phase phase) {
  return scratch.times[static_cast<std::size_t>(phase)];
}

gravity::Points points_of(const Bodies& bodies) {
  return {bodies.spheres.position, bodies.spheres.mass, bodies.first_sphere};
}

/// The rigid motion that carries the bodies' total momentum and angular momentum.
RigidMotion rigid_motion(const Bodies& bodies, double time) {
  const SpinState whole = spin_state(bodies, all_bodies(bodies));
  return {whole.center, whole.velocity, rotation_rate(whole), time};
}

/// Makes the list of candidate pairs good for the present positions.
void refresh_neighbours(const Physics& physics, State& state, Scratch& scratch) {
  ++scratch.list_age;
  if (!scratch.candidates.expired(state.bodies, state.clock.time())) return;
  scratch.candidates.adapt_skin(scratch.list_age);
  scratch.list_age = 0;
  scratch.candidates.rebuild(state.bodies, rigid_motion(state.bodies, state.clock.time()),
                             physics.contacts.features, state.contacts);
}

void check_overlap(const Physics& physics, const State& state, double pairs, const WallReport& walls) {
  const double overlap = std::max(pairs, walls.overlap_ratio);
  if (overlap <= physics.overlap_limit) return;
  const auto& body = state.bodies.spheres.body;
  std::string who;
  if (walls.overlap_ratio > pairs) {
    who = fmt::format("sphere {} of body {} and wall {}", walls.sphere, body[walls.sphere], walls.wall);
  } else {
    const Pair pair = deepest_pair(state.bodies, state.contacts);
    who = fmt::format("spheres {} and {} of bodies {} and {}", pair.i, pair.j, body[pair.i], body[pair.j]);
  }
  if (state.clock.total_steps == 0)
    throw InputError("{} overlap at the start by {:.3g} of the smaller radius; contact.overlap_limit is {:g}",
                     who, overlap, physics.overlap_limit);
  throw UnstableError(
      "t = {:.6g} s: {} overlap by {:.3g} of the smaller radius (contact.overlap_limit = {:g}): raise the "
      "stiffness "
      "(contact.stiffness, or stage.impact_speed for the automatic one) or shorten the time step",
      state.clock.time(), who, overlap, physics.overlap_limit);
}

void evaluate_contacts(const Physics& physics, const SweepSettings& settings, State& state,
                       Scratch& scratch) {
  const SweepReport pairs = sweep(state.bodies, scratch.motions, settings, state.contacts);
  std::fill(state.bodies.force.begin(), state.bodies.force.end(), Vec3::Zero());
  std::fill(state.bodies.torque.begin(), state.bodies.torque.end(), Vec3::Zero());
  gather_wrenches(state.contacts, state.bodies);
  apply_partial_kicks(state.contacts, state.bodies);
  WallReport walls;
  Ledger& ledger = state.ledger;
  if (!state.walls.empty()) {
    walls = state.walls.sweep(scratch.motions, settings, state.clock.time(), scratch.wall_candidates,
                              state.bodies);
    // A wrench acts for half a step on either side of its evaluation.
    ledger.wall_work += 0.5 * settings.dt * (ledger.wall_power + walls.power) + walls.kicked;
    ledger.wall_power = walls.power;
  }
  ledger.dissipated += pairs.dissipated + walls.dissipated;
  const double overlap = std::max(pairs.overlap_ratio, walls.overlap_ratio);
  ledger.recent_overlap = std::max(ledger.recent_overlap, overlap);
  ledger.largest_overlap = std::max(ledger.largest_overlap, overlap);
  check_overlap(physics, state, pairs.overlap_ratio, walls);
}

/// Accelerations of all spheres by the method of the stage, and potentials when asked for.
void attract(const Physics& physics, const Bodies& bodies, Scratch& scratch,
             std::span<double> potential = {}) {
  scratch.acceleration.resize(bodies.spheres.size());
  if (physics.gravity == GravityMethod::direct)
    scratch.direct.evaluate(points_of(bodies), scratch.acceleration, potential);
  else
    scratch.tree.evaluate(points_of(bodies), scratch.acceleration, potential);
}

/// Forces and torques of self-gravity, evaluated every few steps and turned with the pile between.
void add_gravity(const Physics& physics, State& state, Scratch& scratch) {
  Bodies& bodies = state.bodies;
  const double time = state.clock.time();
  scratch.force.resize(bodies.size());
  scratch.torque.resize(bodies.size());
  if (state.clock.step % physics.gravity_interval == 0) {
    attract(physics, bodies, scratch);
    gravity::sum_groups(bodies.spheres.position, bodies.spheres.mass, bodies.first_sphere,
                        scratch.acceleration, bodies.position, scratch.force, scratch.torque);
    gravity::renew(state.gravity, bodies.position, bodies.mass, scratch.force, scratch.torque, time,
                   rigid_motion(bodies, time).spin);
  }
  gravity::extrapolate(state.gravity, time, bodies.position, bodies.mass, scratch.force, scratch.torque);
  parallel_for(bodies.size(), [&](std::size_t b) {
    bodies.force[b] += scratch.force[b];
    bodies.torque[b] += scratch.torque[b];
  });
}

void add_fields(const Physics& physics, State& state, Scratch& scratch) {
  if (physics.gravity != GravityMethod::none) add_gravity(physics, state, scratch);
  if (physics.field != Vec3::Zero())
    parallel_for(state.bodies.size(),
                 [&](std::size_t b) { state.bodies.force[b] += state.bodies.mass[b] * physics.field; });
}

void control_spin(const Physics& physics, State& state, Scratch& scratch) {
  if (!state.control.active || state.clock.step % physics.control_steps != 0) return;
  const double period = period_at(physics.spin->path, state.clock.stage_time());
  const SpinCorrection done =
      impose_period(state.bodies, physics.spin->include_shed ? scratch.everyone : state.remnant, period);
  state.ledger.control_momentum += done.momentum;
  state.ledger.control_work += done.work;
  Control& control = state.control;
  control.shortest_period =
      control.shortest_period == 0.0 ? period : std::min(control.shortest_period, period);
}

}  // namespace

void prepare_scratch(const Physics& physics, State& state, Scratch& scratch) {
  state.walls.set_laws(physics.materials, physics.wall_materials, physics.k_n);
  scratch.candidates.rebuild(state.bodies, rigid_motion(state.bodies, state.clock.time()),
                             physics.contacts.features, state.contacts);
  scratch.list_age = 0;
  scratch.everyone.assign(state.bodies.size(), 1);
  if (physics.gravity == GravityMethod::tree) scratch.tree = gravity::Fmm(physics.tree);
}

void begin_stage(const Physics& physics, const std::vector<ContactRecord>& inherited, State& state,
                 Scratch& scratch) {
  Bodies& bodies = state.bodies;
  place_spheres(bodies);
  // Springs keep their forces: their lengths scale with the inverse of the stiffness.
  const double ratio = state.k_n > 0.0 ? state.k_n / physics.k_n : 1.0;
  const auto rescale = [ratio](auto& contacts) {
    for (auto& c : contacts) {
      c.memory.slide = ratio * c.memory.slide;
      c.memory.roll = ratio * c.memory.roll;
      c.memory.twist *= ratio;
    }
  };
  std::vector<ContactRecord> contacts = inherited;
  rescale(contacts);
  rescale(state.walls.contacts);
  state.contacts = ContactList{};
  prepare_scratch(physics, state, scratch);
  state.contacts.restore(contacts);
  for (std::size_t slot = 0; slot < state.contacts.slots(); ++slot)
    if (state.contacts.touching(slot)) set_damping(bodies, physics.contacts, state.contacts, slot);
  state.walls.renew_damping(bodies, physics.contacts, state.clock.time());
  state.k_n = physics.k_n;

  // A sweep of no duration: no spring grows, dashpots see the present velocities.
  SweepSettings still = physics.contacts;
  still.dt = 0.0;
  scratch.spin_mid.resize(bodies.size());
  parallel_for(bodies.size(), [&](std::size_t b) { scratch.spin_mid[b] = angular_velocity(bodies, b); });
  compute_motions(bodies, scratch.spin_mid, 0.0, scratch.motions);
  evaluate_contacts(physics, still, state, scratch);
  add_fields(physics, state, scratch);
}

void step(const Physics& physics, State& state, Scratch& scratch) {
  const double dt = physics.contacts.dt;
  Bodies& bodies = state.bodies;
  {
    ScopedTimer timer(time_of(scratch, Phase::motion));
    kick(bodies, 0.5 * dt);
    drift(bodies, dt, scratch.spin_mid);
    ++state.clock.step;
    ++state.clock.total_steps;
    place_spheres(bodies);
  }
  {
    ScopedTimer timer(time_of(scratch, Phase::search));
    refresh_neighbours(physics, state, scratch);
  }
  {
    ScopedTimer timer(time_of(scratch, Phase::contacts));
    compute_motions(bodies, scratch.spin_mid, dt, scratch.motions);
    evaluate_contacts(physics, physics.contacts, state, scratch);
  }
  {
    ScopedTimer timer(time_of(scratch, Phase::gravity));
    add_fields(physics, state, scratch);
  }
  {
    ScopedTimer timer(time_of(scratch, Phase::motion));
    kick(bodies, 0.5 * dt);
  }
  if (physics.spin) {
    ScopedTimer timer(time_of(scratch, Phase::control));
    control_spin(physics, state, scratch);
  }
}

double gravitational_energy(const Physics& physics, const Bodies& bodies, Scratch& scratch) {
  if (physics.gravity == GravityMethod::none) return 0.0;
  const std::size_t n = bodies.spheres.size();
  std::vector<double> potential(n);
  attract(physics, bodies, scratch, potential);
  return 0.5 * parallel_sum(n, 0.0, [&](std::size_t s) { return bodies.spheres.mass[s] * potential[s]; });
}

}  // namespace cairn
