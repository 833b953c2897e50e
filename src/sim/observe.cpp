#include "sim/observe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/axes.h"
#include "analysis/budget.h"
#include "analysis/fragments.h"
#include "analysis/spin_state.h"
#include "contact/stiffness.h"
#include "sim/agitation.h"
#include "sim/spin_control.h"

namespace cairn {

namespace {

struct Column {
  double Observation::*value;
  const char *name, *unit, *help;
};

using O = Observation;
constexpr Column kColumns[] = {
    {&O::time, "time", "s", "since the start of the run"},
    {&O::stage, "stage", "", "number of the stage, from 0"},
    {&O::period, "period", "s",
     "2 pi I_zz / L_z of the largest remnant about its mass centre; infinite without spin"},
    {&O::spin_target, "spin_target", "s",
     "period asked for by the spin path; NaN without one, infinite where a ramp starts at rest"},
    {&O::axis_a, "axis_a", "m", "longest full extent of the remnant along its principal axes"},
    {&O::axis_b, "axis_b", "m", "middle extent"},
    {&O::axis_c, "axis_c", "m", "shortest extent"},
    {&O::b_over_a, "b_over_a", "", "axis ratio of the remnant"},
    {&O::c_over_a, "c_over_a", "", "axis ratio of the remnant"},
    {&O::all_b_over_a, "all_b_over_a", "", "axis ratio of all bodies together"},
    {&O::all_c_over_a, "all_c_over_a", "", "axis ratio of all bodies together"},
    {&O::wobble, "wobble", "rad", "angle between the remnant's axis of largest inertia and its L"},
    {&O::kinetic, "kinetic_energy", "J", "of the bodies' mass centres; held ones have none"},
    {&O::rotational, "rotational_energy", "J", "of the bodies about their mass centres"},
    {&O::agitation, "agitation", "J",
     "kinetic and rotational energy less, without walls and held bodies, that of the rigid motion with the "
     "same momenta"},
    {&O::gravitational, "gravitational_energy", "J", "between spheres of different bodies"},
    {&O::field, "field_energy", "J", "of what is not held in the uniform field, 0 at the origin"},
    {&O::elastic, "elastic_energy", "J", "in the springs of the contacts, less the work of cohesion"},
    {&O::dissipated, "dissipated_work", "J", "lost in contacts since the start"},
    {&O::wall_work, "wall_work", "J", "done by moving walls and held bodies since the start"},
    {&O::control_work, "control_work", "J", "done by spin control since the start"},
    {&O::relaxed_work, "relaxed_work", "J", "taken out by stages that relax, since the start"},
    {&O::stage_work, "stage_work", "J",
     "given to the springs of contacts by changes of stiffness, materials and walls from stage to stage, "
     "since "
     "the start"},
    {&O::perturber_work, "perturber_work", "J", "done by perturbers since the start"},
    {&O::perturber_distance, "perturber_distance", "m", "of the nearest from the mass centre; NaN without"},
    {&O::momentum_x, "momentum_x", "kg m/s", "total"},
    {&O::momentum_y, "momentum_y", "kg m/s", "total"},
    {&O::momentum_z, "momentum_z", "kg m/s", "total"},
    {&O::angular_x, "angular_momentum_x", "kg m^2/s", "total about the mass centre, spins included"},
    {&O::angular_y, "angular_momentum_y", "kg m^2/s", "total about the mass centre, spins included"},
    {&O::angular_z, "angular_momentum_z", "kg m^2/s", "total about the mass centre, spins included"},
    {&O::momentum_drift, "momentum_drift", "",
     "|P - P_start - given by fields| over the larger of the sum of |P_b| and, with self-gravity, M v, v the "
     "escape speed sqrt(2 G M / R) of the bodies packed to a ball of radius R; NaN with walls, held bodies "
     "or "
     "a strain"},
    {&O::angular_drift, "angular_momentum_drift", "",
     "|L - L_start - given by control and perturbers| over the larger of the sum of |X x P| + |spin| and, "
     "with self-gravity, M R v (see momentum_drift); NaN with walls, held bodies or a box"},
    {&O::contacts, "contacts", "", "touching pairs of spheres, and of a sphere and a wall"},
    {&O::coordination, "coordination", "", "mean contacts of a sphere, with walls and held bodies included"},
    {&O::touching_bodies, "touching_bodies", "", "pairs of bodies that touch, each once"},
    {&O::largest_overlap, "largest_overlap", "", "over the smaller radius of its pair, since the row before"},
    {&O::remnant_mass_fraction, "remnant_mass_fraction", "", "mass of the largest remnant over all"},
    {&O::shed_bodies, "shed_bodies", "", "bodies that are not part of the largest remnant"},
    {&O::fragments, "fragments", "", "groups of connected bodies"},
    {&O::packing, "packing", "",
     "volume of the bodies over that of the periodic box; NaN without a closed one"},
    {&O::control_active, "control_active", "", "1 while the spin is controlled"},
    {&O::gravity_interval, "gravity_interval", "s", "between evaluations of self-gravity, now; 0: none"},
    {&O::gravity_miss, "gravity_miss", "",
     "of the last forecast of self-gravity: rms difference to the evaluation, relative"},
};

std::size_t touching_body_pairs(const State& state) {
  std::vector<std::uint64_t> pairs;
  const auto& body = state.bodies.spheres.body;
  for (std::size_t slot = 0; slot < state.contacts.slots(); ++slot)
    if (state.contacts.touching(slot)) {
      const Pair& p = state.contacts.pair(slot);
      pairs.push_back(std::uint64_t{body[p.i]} << 32 | body[p.j]);  // i < j, so body i < body j
    }
  std::sort(pairs.begin(), pairs.end());
  return static_cast<std::size_t>(std::unique(pairs.begin(), pairs.end()) - pairs.begin());
}

/// Contacts of the spheres that are not held over their number.
double contacts_per_sphere(const State& state) {
  const Bodies& bodies = state.bodies;
  std::size_t sides = 2 * state.contacts.contacts() + state.walls.contacts.size(),
              spheres = bodies.spheres.size();
  if (!state.held.empty()) {
    const std::vector<std::uint32_t>& body = bodies.spheres.body;
    for (std::size_t slot = 0; slot < state.contacts.slots(); ++slot)
      if (state.contacts.touching(slot)) {
        const Pair& p = state.contacts.pair(slot);
        sides -= is_held(bodies, body[p.i]) || is_held(bodies, body[p.j]);
      }
    for (const WallContact& c : state.walls.contacts) sides -= is_held(bodies, body[c.sphere]);
    for (const std::uint32_t b : state.held.body) spheres -= bodies.sphere_count(b);
  }
  return static_cast<double>(sides) / static_cast<double>(spheres);
}

}  // namespace

double elastic_energy(const Physics& physics, const State& state) {
  return stored_energy(state.bodies, physics.contacts, state.contacts) +
         state.walls.stored_energy(state.bodies, physics.contacts, state.clock.time());
}

void observe_remnant(const State& state, double link_gap, Observation& o) {
  const Bodies& bodies = state.bodies;
  const Fragments fragments = find_fragments(bodies, link_gap, state.box, &state.contacts);
  const std::vector<std::uint32_t> remnant = fragments.members(0);
  o.remnant.assign(bodies.size(), 0);
  for (std::uint32_t b : remnant) o.remnant[b] = 1;

  const SpinState spin = spin_state(bodies, remnant);
  const AxisLengths axes = axis_lengths(bodies, remnant);
  const AxisLengths all = axis_lengths(bodies, all_bodies(bodies));
  double mass = 0.0;
  for (double m : fragments.mass) mass += m;
  o.period = spin_period(spin, Vec3::UnitZ());
  o.wobble = wobble(spin);
  o.axis_a = axes.a;
  o.axis_b = axes.b;
  o.axis_c = axes.c;
  o.b_over_a = axes.b_over_a();
  o.c_over_a = axes.c_over_a();
  o.all_b_over_a = all.b_over_a();
  o.all_c_over_a = all.c_over_a();
  o.remnant_mass_fraction = fragments.mass[0] / mass;
  o.shed_bodies = static_cast<double>(bodies.size() - state.held.body.size() - remnant.size());
  o.fragments = static_cast<double>(fragments.size());
}

std::vector<SeriesColumn> series_columns() {
  std::vector<SeriesColumn> out;
  for (const Column& c : kColumns) out.push_back({c.name, c.unit, c.help});
  return out;
}

std::vector<double> row(const Observation& observation) {
  std::vector<double> out;
  for (const Column& c : kColumns) out.push_back(observation.*c.value);
  return out;
}

double link_gap(const Scene& scene, const Bodies& bodies) {
  const std::vector<double>& radii = bodies.spheres.radius;
  return scene.output.remnant_gap * *std::min_element(radii.begin(), radii.end());
}

Observation observe(const Physics& physics, const State& state, Scratch& scratch, double link_gap) {
  const Bodies& bodies = state.bodies;
  const Ledger& ledger = state.ledger;
  Observation o;
  o.time = state.clock.time();
  o.stage = static_cast<double>(state.clock.stage);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  o.spin_target = target_period(physics, state.control, state.clock.stage_time());
  observe_remnant(state, link_gap, o);

  const Budget total = budget(bodies);
  o.kinetic = total.translational_energy;
  o.rotational = total.rotational_energy;
  o.agitation = agitation(state, total);
  o.gravitational = gravitational_energy(physics, state, scratch);
  o.elastic = elastic_energy(physics, state);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (!is_held(bodies, b)) o.field -= bodies.mass[b] * physics.field.dot(place(bodies, b));
  o.dissipated = ledger.dissipated;
  o.wall_work = ledger.wall_work;
  o.control_work = ledger.control_work;
  o.relaxed_work = ledger.relaxed;
  o.stage_work = ledger.stage_work;
  o.perturber_work = ledger.perturbers.work;
  o.perturber_distance = perturber_distance(physics, state, total.center);
  const Vec3& p = total.momentum;
  const Vec3& l = total.angular_momentum_about_center;
  o.momentum_x = p.x();
  o.momentum_y = p.y();
  o.momentum_z = p.z();
  o.angular_x = l.x();
  o.angular_y = l.y();
  o.angular_z = l.z();
  const bool anchored = state.anchored();
  const auto relative = [](double drift, double moving, double falling) {
    const double scale = std::max(moving, falling);
    return scale > 0.0 ? drift / scale : drift;
  };
  // Of a pile at rest, what its bodies carry is as small as what drifts; what gravity could give them is not.
  const bool falls = physics.gravity != GravityMethod::none;
  const double speed = falls ? escape_speed(bodies) : 0.0;
  const double radius = falls ? 2.0 * kGravitationalConstant * total.mass / (speed * speed) : 0.0;
  const Vec3 given = ledger.perturbers.momentum + ledger.field_momentum +
                     total.mass * state.clock.stage_time() * physics.field;
  o.momentum_drift =
      anchored || physics.strain_rate != Vec3::Zero()
          ? none
          : relative((p - ledger.start_momentum - given).norm(), total.momentum_scale, total.mass * speed);
  const Vec3 turned = ledger.control_momentum + ledger.perturbers.angular_momentum;
  o.angular_drift = anchored || state.box.periodic()
                        ? none
                        : relative((l - ledger.start_angular_momentum - turned).norm(),
                                   total.angular_scale_about_center, total.mass * radius * speed);

  o.coordination = contacts_per_sphere(state);
  o.contacts = static_cast<double>(state.contacts.contacts() + state.walls.contacts.size());
  o.touching_bodies = static_cast<double>(touching_body_pairs(state));
  o.largest_overlap = ledger.recent_overlap;
  o.packing = state.box.closed() ? packing_fraction(physics, state.box) : none;
  o.control_active = state.control.active ? 1.0 : 0.0;
  o.gravity_interval = state.gravity.interval;
  o.gravity_miss = state.gravity.miss;
  return o;
}

}  // namespace cairn
