#include "sim/step.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/budget.h"
#include "analysis/spin_state.h"
#include "body/cells.h"
#include "core/elementary.h"
#include "core/error.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/timer.h"
#include "gravity/accuracy.h"
#include "gravity/self_gravity.h"
#include "motion/drift.h"
#include "sim/agitation.h"
#include "sim/relax.h"
#include "sim/spin_control.h"
#include "sim/springs.h"

namespace cairn {

namespace {

double& time_of(Scratch& scratch, Phase phase) {
  return scratch.times[static_cast<std::size_t>(phase)];
}

/// The rigid motion that carries the bodies' total momentum and angular momentum; images cannot turn, and
/// those among held ones do not.
RigidMotion rigid_motion(const State& state) {
  const SpinState whole = spin_state(state.bodies, all_bodies(state.bodies));
  if (state.box.periodic()) return {Vec3::Zero(), whole.velocity, Vec3::Zero(), state.clock.time()};
  if (!state.held.empty()) return {whole.center, Vec3::Zero(), Vec3::Zero(), state.clock.time()};
  return {whole.center, whole.velocity, rotation_rate(whole), state.clock.time()};
}

/// The box as it is at the end of a step of dt that ends now.
void strain_box(State& state, double dt) {
  const double t = state.clock.stage_time();
  const Strain& strain = state.strain;
  state.box.edge = strain.edge(t);
  state.box.rate = (std::min(t, strain.until) - std::min(t - dt, strain.until)) / dt * strain.rate;
}

void check_box(const Physics& physics, const State& state) {
  for (const double edge : state.box.edge) {
    if (edge == 0.0 || (edge > physics.least_edge && edge <= kWidestBox)) continue;
    const std::string what =
        edge > kWidestBox
            ? fmt::format("the periodic box is {:g} m wide; it may be {:g} m at most", edge, kWidestBox)
            : fmt::format("the periodic box is {:g} m wide; these bodies need more than {:g} m", edge,
                          physics.least_edge);
    if (state.clock.total_steps == 0) throw InputError("{}", what);
    throw UnstableError("t = {:.6g} s: {}", state.clock.time(), what);
  }
}

/// The strain of the stage, from the box as it is.
Strain begin_strain(const Physics& physics, const Box& box) {
  Strain strain{.start = box.edge, .rate = (box.edge.array() > 0.0).select(physics.strain_rate, 0.0)};
  if (!physics.packing) return strain;
  if (!box.closed()) throw InputError("stage.packing: the box is open, no packing fraction can be reached");
  const double now = packing_fraction(physics, box);
  const double growth = logarithm(now / *physics.packing);  // of the volume
  strain.until = std::abs(growth) > 1e-12 ? growth / strain.rate.sum() : 0.0;
  if (strain.until < 0.0)
    throw InputError("stage.packing: the bodies fill {:g} of the box, and strain_rate leads away from {:g}",
                     now, *physics.packing);
  return strain;
}

/// Makes the list of candidate pairs good for the present positions.
void refresh_neighbours(const Physics& physics, State& state, Scratch& scratch) {
  ++scratch.list_age;
  if (!scratch.candidates.too_wide(scratch.list_age) &&
      !scratch.candidates.expired(state.bodies, state.clock.time(), state.contacts, state.box)) {
    set_lattice(state.bodies, state.box, state.contacts);
    return;
  }
  scratch.candidates.adapt_skin(scratch.list_age, state.contacts);
  scratch.list_age = 0;
  scratch.candidates.rebuild(state.bodies, rigid_motion(state), physics.contacts.features, state.contacts,
                             state.box);
}

void check_overlap(const Physics& physics, const State& state, double pairs, const WallReport& walls) {
  const double overlap = std::max(pairs, walls.overlap_ratio);
  if (overlap <= physics.overlap_limit) return;
  const auto& body = state.bodies.spheres.body;
  std::string who;
  if (walls.overlap_ratio > pairs) {
    who = fmt::format("sphere {} of body {} and {}", walls.sphere, body[walls.sphere],
                      physics.wall_names[walls.wall]);
  } else {
    const Pair pair = deepest_pair(state.bodies, state.contacts);
    who = fmt::format("spheres {} and {} of bodies {} and {}", pair.i, pair.j, body[pair.i], body[pair.j]);
  }
  if (state.clock.total_steps == 0)
    throw InputError("{} overlap at the start by {:.3g} of the smaller radius; contact.overlap_limit is {:g}",
                     who, overlap, physics.overlap_limit);
  throw UnstableError(
      "t = {:.6g} s: {} overlap by {:.3g} of the smaller radius (contact.overlap_limit = {:g}): raise the "
      "stiffness (contact.stiffness, or stage.impact_speed for the automatic one) or shorten the time step",
      state.clock.time(), who, overlap, physics.overlap_limit);
}

/// Places from the pile's centre of mass in a frame turned with it. There a pile at rest in itself looks the
/// same at every evaluation, and so does what the tree makes of it.
void place_in_pile(const Bodies& bodies, const Vec3& centre, const Quat& attitude, Scratch& scratch) {
  const Mat3 back = attitude.conjugate().toRotationMatrix();
  scratch.body_places.resize(bodies.size());
  scratch.sphere_places.resize(bodies.spheres.size());
  parallel_for(bodies.size(), [&](std::size_t b) {
    scratch.body_places[b] = back * place(bodies, b, centre);
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
      scratch.sphere_places[s] =
          scratch.body_places[b] + back * (bodies.spheres.position[s] - bodies.position[b]);
  });
}

/// Accelerations of all spheres at their places in the pile by the method of the stage, and potentials when
/// asked for.
void attract(const Physics& physics, const Bodies& bodies, Scratch& scratch,
             std::span<double> potential = {}) {
  scratch.acceleration.resize(bodies.spheres.size());
  const gravity::Points points{scratch.sphere_places, bodies.spheres.mass, bodies.first_sphere};
  if (physics.gravity == GravityMethod::direct)
    scratch.direct.evaluate(points, scratch.acceleration, potential);
  else
    scratch.tree.evaluate(points, scratch.acceleration, potential);
}

/// Finds at the start of a stage what the error asked for takes with these bodies.
void choose_accuracy(const Physics& physics, State& state, Scratch& scratch) {
  if (!physics.gravity_error) return;
  place_in_pile(state.bodies, rigid_motion(state).center, Quat::Identity(), scratch);
  const gravity::Accuracy found = gravity::choose_accuracy(
      {scratch.sphere_places, state.bodies.spheres.mass, state.bodies.first_sphere}, *physics.gravity_error);
  state.gravity.factor = found.factor;
  state.gravity.scale = found.scale;
  state.gravity.error = found.error;
}

/// The tree's tolerance follows the field: it is what the last evaluation asks of the next.
void set_tolerance(const State& state, Scratch& scratch) {
  scratch.tree.set_tolerance(state.gravity.factor * state.gravity.scale);
}

/// The shortest time (s) in which the field can change on some body: that in which a body crosses the pile,
/// apart from its rigid motion, or a grain's own density would turn two grains about each other.
double shortest_change(const Physics& physics, const Bodies& bodies, const RigidMotion& pile) {
  struct Most {
    double value = 0.0;
    Most& operator+=(const Most& other) {
      value = std::max(value, other.value);
      return *this;
    }
  };
  const double radius2 = parallel_sum(bodies.size(), 0.0,
                                      [&](std::size_t b) {
                                        return bodies.mass[b] * place(bodies, b, pile.center).squaredNorm();
                                      }) /
                         physics.body_mass;
  const Most rate2 = parallel_sum(bodies.size(), Most{}, [&](std::size_t b) {
    const Vec3 x = place(bodies, b, pile.center), v = bodies.velocity[b] - pile.velocity - pile.spin.cross(x);
    const double size2 = std::max(x.squaredNorm(), radius2);
    return Most{size2 > 0.0 ? v.squaredNorm() / size2 : 0.0};
  });
  return std::min(physics.fall_time, 1.0 / std::sqrt(rate2.value));
}

/// Gives back what the next evaluation will need again.
void free_gravity(const Physics& physics, Scratch& scratch) {
  scratch.tree = gravity::Fmm(physics.tree);
  give_back(scratch.acceleration);
  scratch.wrenches = gravity::Wrenches();
  give_back(scratch.body_places);
  give_back(scratch.sphere_places);
}

/// Evaluates self-gravity anew; with an interval of its own choice only when something has moved.
void renew_gravity(const Physics& physics, State& state, Scratch& scratch) {
  const Bodies& bodies = state.bodies;
  gravity::HeldGravity& held = state.gravity;
  const double time = state.clock.time(), dt = physics.contacts.dt;
  const RigidMotion pile = rigid_motion(state);
  place_in_pile(bodies, pile.center, gravity::attitude_at(held, time), scratch);
  const bool automatic = physics.gravity_steps == 0;
  const std::uint64_t most =
      automatic ? gravity::most_steps(physics.error, shortest_change(physics, bodies, pile), dt) : 0;
  // Now and then all the same: a drift too slow to be seen leaves no trace of more than ten looks.
  const bool recent = time - held.evaluated_time < 10.0 * held.interval;
  if (automatic && recent &&
      gravity::rests(held, scratch.sphere_places,
                     gravity::reach_at_rest(physics.error, held.scale, physics.fall_time))) {
    gravity::hold_on(held, time, pile.spin, dt, std::min(2 * held.steps, most));
  } else {
    attract(physics, bodies, scratch);
    held.scale = gravity::rms(scratch.acceleration);
    if (physics.gravity == GravityMethod::tree) set_tolerance(state, scratch);
    gravity::sum_groups(scratch.sphere_places, bodies.spheres.mass, bodies.first_sphere, scratch.acceleration,
                        scratch.body_places, scratch.wrenches);
    const auto steps = [&] {
      return automatic ? gravity::automatic_steps(held, physics.error, most) : physics.gravity_steps;
    };
    gravity::renew(held, scratch.wrenches, bodies.mass, time, pile.spin, dt, physics.gravity_steps != 1,
                   std::ref(steps));
    if (automatic) std::swap(held.places, scratch.sphere_places);
  }
  if (bodies.spheres.size() > kManySpheres) free_gravity(physics, scratch);
  held.due = state.clock.step + held.steps;
}

/// Where bodies are for gravity: in one lattice of cells, from its middle.
std::span<const Vec3> body_places(const Bodies& bodies, Scratch& scratch) {
  if (bodies.cell.empty()) return bodies.position;
  scratch.body_places.resize(bodies.size());
  parallel_for(bodies.size(), [&](std::size_t b) { scratch.body_places[b] = place(bodies, b); });
  return scratch.body_places;
}

/// What acts beside contacts of bodies: self-gravity as it is held, and the field. Then the last kick, unless
/// `kick_dt` is 0.
class OtherForces : public BodyWork {
 public:
  OtherForces(const Physics& physics, double kick_dt, const State& state, Scratch& scratch)
      : field_(physics.field), kick_dt_(kick_dt) {
    if (physics.gravity != GravityMethod::none)
      pull_.emplace(state.gravity, state.clock.time(), body_places(state.bodies, scratch), state.bodies.mass);
  }
  void before_contacts(Bodies& bodies, std::size_t begin, std::size_t end) const override {
    if (pull_)
      pull_->get(begin, end, bodies.force, bodies.torque);
    else
      BodyWork::before_contacts(bodies, begin, end);
    for (std::size_t b = begin; b < end; ++b) bodies.force[b] += bodies.mass[b] * field_;
  }
  void after_contacts(Bodies& bodies, std::size_t begin, std::size_t end) const override {
    if (kick_dt_ > 0.0) kick(bodies, kick_dt_, begin, end);
  }

 private:
  const Vec3 field_;
  const double kick_dt_;
  std::optional<gravity::SelfGravity> pull_;
};

/// Whether something acts beside contacts of bodies, gravity and the field.
bool more_acts(const Physics& physics, const State& state) {
  return !state.walls.empty() || !physics.perturbers.empty();
}

/// Contacts at the present poses; then the wrenches of all that acts. Where nothing more acts, the bodies are
/// kicked by `kick_dt` at once.
void evaluate_forces(const Physics& physics, const SweepSettings& settings, double kick_dt, State& state,
                     Scratch& scratch) {
  const OtherForces others(physics, more_acts(physics, state) ? 0.0 : kick_dt, state, scratch);
  if (!physics.can_touch) {
    parallel_blocks(state.bodies.size(), kBodyBlock, [&](std::size_t begin, std::size_t end) {
      others.before_contacts(state.bodies, begin, end);
      others.after_contacts(state.bodies, begin, end);
    });
    return;
  }
  const SweepReport pairs = sweep(scratch.motions, settings, state.contacts, state.bodies, others);
  apply_partial_kicks(state.contacts, state.bodies);
  WallReport walls;
  Ledger& ledger = state.ledger;
  if (!state.walls.empty()) {
    walls = state.walls.sweep(scratch.motions, settings, state.clock.time(), scratch.wall_candidates,
                              state.bodies);
  }
  if (state.anchored()) {
    const double time = state.clock.time();
    double power = walls.power, kicked = walls.kicked;
    if (!state.held.empty()) {
      power += state.held.power(time, physics.field, state.bodies);
      kicked += state.held.kicked(time, state.contacts, state.bodies);
    }
    // A wrench acts for half a step on either side of its evaluation.
    ledger.wall_work += 0.5 * settings.dt * (ledger.wall_power + power) + kicked;
    ledger.wall_power = power;
  }
  ledger.dissipated += pairs.dissipated + walls.dissipated;
  const double overlap = std::max(pairs.overlap_ratio, walls.overlap_ratio);
  ledger.recent_overlap = std::max(ledger.recent_overlap, overlap);
  ledger.largest_overlap = std::max(ledger.largest_overlap, overlap);
  check_overlap(physics, state, pairs.overlap_ratio, walls);
}

/// Kicks, drifts, and what follows from the new places for the spheres. A box grows by half_stretch before
/// and after the drift.
void advance(const Vec3& half_stretch, double dt, State& state, Scratch& scratch) {
  Bodies& bodies = state.bodies;
  const bool strained = half_stretch != Vec3::Ones();
  std::atomic<bool> left = false;
  scratch.motions.resize(bodies.spheres.size());
  parallel_blocks(bodies.size(), kBodyBlock, [&](std::size_t begin, std::size_t end) {
    std::array<Vec3, kBodyBlock> spin_mid;
    kick(bodies, 0.5 * dt, begin, end);
    if (strained) deform(bodies, half_stretch, begin, end);
    if (drift(bodies, dt, begin, end, spin_mid)) left.store(true, std::memory_order_relaxed);
    if (strained) deform(bodies, half_stretch, begin, end);
    place_spheres(bodies, begin, end);
    compute_motions(bodies, spin_mid, dt, state.box.rate, begin, end, scratch.motions);
  });
  if (!state.held.empty()) state.held.move(state.clock.time(), dt, bodies, scratch.motions);
  if (!left) return;
  settle_cells(bodies);
  place_spheres(bodies);
  move_motions(bodies.spheres, scratch.motions);
}

bool is_quiet(const Physics& physics, const State& state, Scratch& scratch) {
  if (!physics.quiet_energy && !physics.quiet_speed) return false;
  if (state.clock.step % physics.quiet_steps != 0 || state.clock.stage_time() < 0.1 * physics.duration)
    return false;
  ScopedTimer timer(time_of(scratch, Phase::control));
  const double energy = agitation(state, budget(state.bodies)) + state.walls.kinetic_energy();
  if (physics.quiet_speed && energy < 0.5 * physics.body_mass * *physics.quiet_speed * *physics.quiet_speed)
    return true;
  return physics.quiet_energy &&
         energy < *physics.quiet_energy * std::abs(gravitational_energy(physics, state, scratch));
}

}  // namespace

void prepare_scratch(const Physics& physics, State& state, Scratch& scratch) {
  if (physics.can_touch) {
    state.walls.set_laws(physics.materials, physics.wall_materials, physics.k_n);
    scratch.wall_candidates = WallCandidates{};  // those of other walls, perhaps
    scratch.candidates.rebuild(state.bodies, rigid_motion(state), physics.contacts.features, state.contacts,
                               state.box);
  }
  scratch.list_age = 0;
  scratch.everyone.assign(state.bodies.size(), 1);
  if (physics.gravity == GravityMethod::tree) {
    scratch.tree = gravity::Fmm(physics.tree);
    set_tolerance(state, scratch);
  }
}

void begin_stage(const Physics& physics, std::vector<ContactRecord> contacts, State& state, Scratch& scratch,
                 const FormerStage* former) {
  Bodies& bodies = state.bodies;
  place_spheres(bodies);
  if (state.box.periodic()) {
    check_box(physics, state);
    state.strain = begin_strain(physics, state.box);
    state.box.rate = state.strain.acts(0.0) ? state.strain.rate : Vec3::Zero();
  }
  if (!physics.can_touch) contacts.clear();  // what they held is forgotten
  enter_stiffness(physics, bodies, state.k_n > 0.0 ? state.k_n : physics.k_n, contacts, state.walls.contacts);
  state.contacts = ContactList{};
  state.gravity = gravity::HeldGravity{};
  state.gravity.time = state.clock.time();
  choose_accuracy(physics, state, scratch);
  prepare_scratch(physics, state, scratch);
  state.contacts.restore(contacts);
  give_back(contacts);  // gravity needs the room
  const bool known = former && former->same_bodies;
  const SweepSettings* before = known ? &former->physics.contacts : nullptr;
  renew_damping(bodies, before, physics.contacts, state.contacts);
  state.walls.renew_damping(bodies, known ? &former->walls : nullptr, before, physics.contacts,
                            state.clock.time());
  state.k_n = physics.k_n;

  // A sweep of no duration: no spring grows, dashpots see the present velocities.
  SweepSettings still = physics.contacts;
  still.dt = 0.0;
  std::vector<Vec3> spin(bodies.size());
  parallel_for(bodies.size(), [&](std::size_t b) { spin[b] = angular_velocity(bodies, b); });
  compute_motions(bodies, spin, 0.0, scratch.motions, state.box.rate);
  if (!state.held.empty()) state.held.move(state.clock.time(), 0.0, bodies, scratch.motions);
  if (physics.gravity != GravityMethod::none) renew_gravity(physics, state, scratch);
  evaluate_forces(physics, still, 0.0, state, scratch);
  add_perturbers(physics, 0.0, state, scratch.perturbers);
  begin_relaxation(physics, state, scratch);
}

void step(const Physics& physics, State& state, Scratch& scratch) {
  const double dt = physics.contacts.dt;
  Bodies& bodies = state.bodies;
  {
    ScopedTimer timer(time_of(scratch, Phase::motion));
    const bool strained = state.strain.acts(state.clock.stage_time());
    ++state.clock.step;
    ++state.clock.total_steps;
    Vec3 half_stretch = Vec3::Ones();
    state.box.rate.setZero();
    if (strained) {
      const Vec3 before = state.box.edge;
      strain_box(state, dt);
      check_box(physics, state);
      half_stretch = (before.array() > 0.0).select(state.box.edge.cwiseQuotient(before).cwiseSqrt(), 1.0);
    }
    advance(half_stretch, dt, state, scratch);
  }
  if (physics.can_touch) {
    ScopedTimer timer(time_of(scratch, Phase::search));
    refresh_neighbours(physics, state, scratch);
  }
  if (physics.gravity != GravityMethod::none && state.clock.step == state.gravity.due) {
    ScopedTimer timer(time_of(scratch, Phase::gravity));
    renew_gravity(physics, state, scratch);
  }
  {
    ScopedTimer timer(time_of(scratch, Phase::contacts));
    evaluate_forces(physics, physics.contacts, 0.5 * dt, state, scratch);
  }
  if (!physics.perturbers.empty()) {
    ScopedTimer timer(time_of(scratch, Phase::gravity));
    add_perturbers(physics, dt, state, scratch.perturbers);
  }
  if (more_acts(physics, state)) {
    ScopedTimer timer(time_of(scratch, Phase::motion));
    kick(bodies, 0.5 * dt);
  }
  if (!state.held.empty()) state.held.hold(state.clock.time(), bodies);
  if (physics.spin) {
    ScopedTimer timer(time_of(scratch, Phase::control));
    control_spin(physics, scratch.everyone, state);
  }
  if (physics.relax) {
    ScopedTimer timer(time_of(scratch, Phase::control));
    relax(physics, state, scratch);
  }
}

std::string why_stage_ends(const Physics& physics, const State& state, Scratch& scratch) {
  const Clock& clock = state.clock;
  if (clock.step >= clock.steps) return "the end of its duration";
  if (physics.relax && relaxed(physics, state, scratch))
    return fmt::format("relaxed after {:.6g} s", clock.stage_time());
  if (is_quiet(physics, state, scratch)) return fmt::format("quiet after {:.6g} s", clock.stage_time());
  if (failed_long_ago(physics, state)) return "some time after failure";
  return {};
}

double gravitational_energy(const Physics& physics, const State& state, Scratch& scratch) {
  if (physics.gravity == GravityMethod::none) return 0.0;
  const Bodies& bodies = state.bodies;
  const std::size_t n = bodies.spheres.size();
  std::vector<double> potential(n);
  place_in_pile(bodies, rigid_motion(state).center, gravity::attitude_at(state.gravity, state.clock.time()),
                scratch);
  attract(physics, bodies, scratch, potential);
  if (n > kManySpheres) free_gravity(physics, scratch);
  return 0.5 * parallel_sum(n, 0.0, [&](std::size_t s) { return bodies.spheres.mass[s] * potential[s]; });
}

}  // namespace cairn
