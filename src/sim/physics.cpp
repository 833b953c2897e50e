#include "sim/physics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "contact/stiffness.h"
#include "core/error.h"
#include "gravity/accuracy.h"
#include "sim/make_perturbers.h"
#include "sim/make_walls.h"

namespace cairn {

namespace {

double default_impact_speed(const Scene& scene, std::size_t stage, const Bodies& bodies,
                            const std::vector<Wall>& walls) {
  double speed = closing_speed(bodies);
  if (gravity_of(scene, stage) != GravityMethod::none) speed = std::max(speed, escape_speed(bodies));
  const Vec3 field = field_of(scene, stage);
  if (field != Vec3::Zero())
    speed = std::max(speed, std::sqrt(2.0 * field.norm() * drop_height(bodies, walls, field)));
  return speed + greatest_wall_speed(bodies, walls);
}

std::uint64_t whole_steps(double interval, double dt) {
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(interval / dt)));
}

/// The material of that name; the scene has been checked, so it exists.
const Material& named(const Scene& scene, const std::string& name) {
  return *std::find_if(scene.materials.begin(), scene.materials.end(),
                       [&](const Material& m) { return m.name == name; });
}

/// Materials of the bodies during the stage: all of the scene, or the one that replaces them.
std::vector<Material> body_materials(const Scene& scene, const StageSpec& stage) {
  return stage.material.empty() ? scene.materials : std::vector<Material>{named(scene, stage.material)};
}

std::vector<Material> wall_materials(const Scene& scene, std::size_t stage) {
  std::vector<Material> out;
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    if (has_wall(scene, stage, w)) out.push_back(named(scene, scene.walls[w].material));
  return out;
}

/// The least stiffness (N/m) of the materials that bodies and walls have in the stage; none: one of these has
/// no stiffness of its own.
std::optional<double> softest_of_own(const Scene& scene, std::size_t index, const Bodies& bodies) {
  const StageSpec& stage = scene.stages[index];
  std::vector<Material> touching = wall_materials(scene, index);
  if (stage.material.empty())
    for (const std::uint16_t m : std::set(bodies.material.begin(), bodies.material.end()))
      touching.push_back(scene.materials[m]);
  else
    touching.push_back(named(scene, stage.material));
  return std::min_element(touching.begin(), touching.end(),
                          [](const Material& a, const Material& b) { return a.stiffness < b.stiffness; })
      ->stiffness;
}

/// What cohesion and walls ask of the contacts.
ContactDemand demand_of(const std::vector<Material>& materials, const std::vector<Material>& walls) {
  ContactDemand demand{.walls = !walls.empty()};
  const auto strongest = [](double& pull, const Material& a, const Material& b) {
    pull = std::max(pull, make_pair_law(a, b, 1.0).cohesion);
  };
  for (const Material& a : materials) {
    for (const Material& b : materials) strongest(demand.cohesion, a, b);
    for (const Material& b : walls) strongest(demand.wall_cohesion, a, b);
  }
  return demand;
}

/// The wall of the least mass under a load; none: there is none.
std::optional<std::size_t> lightest_wall(const Scene& scene, std::size_t stage) {
  std::optional<std::size_t> lightest;
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    if (has_wall(scene, stage, w) && scene.walls[w].load &&
        (!lightest || scene.walls[w].load_mass < scene.walls[*lightest].load_mass))
      lightest = w;
  return lightest;
}

/// What is wrong with a stage, at the key that decides it: the stage's own, or else that of [contact], or
/// else none but the stage.
template <class... Args>
InputError error(const Scene& scene, std::size_t index, const char* name, fmt::format_string<Args...> what,
                 Args&&... args) {
  std::string key = fmt::format("stage[{}].{}", index, name);
  const std::string of_all = std::string("contact.") + name;
  if (!scene.sources.has(key)) key = scene.sources.has(of_all) ? of_all : fmt::format("stage[{}]", index);
  return scene.sources.error(key, fmt::format("stage '{}': {}", scene.stages[index].name,
                                              fmt::format(what, std::forward<Args>(args)...)));
}

/// Cohesion alone must not press two spheres, or a sphere and a wall, together beyond the limit.
void check_cohesion(const Scene& scene, std::size_t index, const Physics& p,
                    const std::vector<PairLaw>& wall_laws, const Bodies& bodies) {
  ContactDemand demand{.walls = !wall_laws.empty()};  // over the stiffness of the pair
  for (const PairLaw& law : p.contacts.laws)
    demand.cohesion = std::max(demand.cohesion, law.cohesion / law.k_n);
  for (const PairLaw& law : wall_laws)
    demand.wall_cohesion = std::max(demand.wall_cohesion, law.cohesion / law.k_n);
  const double overlap = greatest_pull(bodies, demand);  // over the smaller radius
  if (overlap <= p.overlap_limit) return;
  const auto own = [](const Material& m) { return m.stiffness.has_value(); };
  const double more = overlap / p.overlap_limit;
  throw error(
      scene, index, "stiffness",
      "cohesion presses spheres together by {:.3g} of their radius, overlap_limit is {:g}; {} is needed",
      overlap, p.overlap_limit,
      std::any_of(p.materials.begin(), p.materials.end(), own) ||
              std::any_of(p.wall_materials.begin(), p.wall_materials.end(), own)
          ? fmt::format("a stiffness of the contacts, contact.stiffness or material.stiffness, of at least "
                        "{:.3g} times what they have",
                        more)
          : fmt::format("a contact.stiffness of at least {:.3g} N/m", p.k_n * more));
}

/// "body 3 (size 2 m)"
std::string name_body(const Bodies& bodies, std::uint32_t b) {
  return fmt::format("body {} (size {:.4g} m)", b, bodies.length[b]);
}

/// "body 3 (size 2 m) and body 0 (size 400 m)"
std::string name_both(const Bodies& bodies, const Encounter& encounter) {
  const std::string body = name_body(bodies, encounter.body);
  if (!encounter.other) return body + " and a wall";
  if (*encounter.other == encounter.body) return body + " and one like it";
  return body + " and " + name_body(bodies, *encounter.other);
}

std::string explain(const StiffnessChoice& choice, const ContactDemand& demand, const Bodies& bodies) {
  const double radius = bodies.spheres.radius[choice.sphere];
  const std::string both = name_both(bodies, choice.encounter);
  if (choice.cause == StiffnessChoice::Cause::wall_fall)
    return fmt::format(
        "for the {:.3g} J with which a load lets its wall fall on {}, which press sphere {} in by {:g} of "
        "its radius, {:.4g} m; put the wall nearer, or give impact_speed or contact.stiffness for another",
        demand.wall_fall, both, choice.sphere, demand.max_overlap, radius);
  if (choice.cause == StiffnessChoice::Cause::impact)
    return fmt::format(
        "for a blow of {} at {:.3g} m/s that presses sphere {} in by {:g} of its radius, {:.4g} m; "
        "change impact_speed, contact.max_overlap or contact.stiffness for another",
        both, demand.impact_speed, choice.sphere, demand.max_overlap, radius);
  return fmt::format(
      "for the load at rest between {}, which presses sphere {} in by {:g} of its radius, {:.4g} m; "
      "change contact.max_overlap or contact.stiffness for another",
      both, choice.sphere, demand.max_overlap, radius);
}

/// "normal mode of body 3 (size 2 m) and a wall"
std::string explain(const ShortestContact& shortest, const Bodies& bodies) {
  using Mode = ShortestContact::Mode;
  return fmt::format("{} mode of {}",
                     shortest.mode == Mode::normal    ? "normal"
                     : shortest.mode == Mode::sliding ? "sliding"
                                                      : "rolling",
                     name_both(bodies, shortest.encounter));
}

/// Time step (s) of a stage in which nothing touches, when none is given: a hundredth of the shortest time in
/// which motion changes; at this part leapfrog errs by 4e-6 of an orbit's angle. No longer than a thousandth
/// of the stage, for the series.
double free_step(const Scene& scene, std::size_t index, const Physics& p, const Bodies& bodies) {
  const StageSpec& stage = scene.stages[index];
  constexpr double kPart = 0.01, kLongest = 1e-3;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (!is_ball(bodies, b)) shortest = std::min(shortest, bodies.inertia[b][0] / bodies.spin[b].norm());
  const Spheres& spheres = bodies.spheres;
  if (p.gravity != GravityMethod::none && bodies.size() > 1)  // no two can be faster while they are apart
    for (std::size_t s = 0; s < spheres.size(); ++s)
      shortest = std::min(shortest,
                          std::sqrt(cubed(spheres.radius[s]) / (kGravitationalConstant * spheres.mass[s])));
  for (const gravity::Perturber& q : p.perturbers) {
    const double nearest = std::max(q.radius, q.tidal ? closest(q.orbit) : 0.0);
    if (nearest == 0.0)
      throw error(scene, index, "time_step",
                  "no time step can be chosen, because perturber '{}' has no radius and bodies may come as "
                  "near as they like; give contact.time_step",
                  q.name);
    shortest = std::min(shortest, std::sqrt(cubed(nearest) / q.gm));
  }
  if (stage.spin)
    for (const SpinPoint& point : stage.spin->path) shortest = std::min(shortest, point.period / (2.0 * kPi));
  if (const double rate = stage.strain_rate.cwiseAbs().maxCoeff(); rate > 0.0)
    shortest = std::min(shortest, 1.0 / rate);
  return std::min(kPart * shortest, kLongest * stage.duration);
}

/// Finds the softest and the stiffest contacts of the bodies with each other and with walls.
void find_stiffnesses(const std::vector<PairLaw>& walls, Physics& p) {
  const SweepSettings& contacts = p.contacts;
  const std::set<std::uint16_t> kinds(contacts.material.begin(), contacts.material.end());
  p.softest = std::numeric_limits<double>::infinity();
  const auto take = [&](const PairLaw& law) {
    p.softest = std::min(p.softest, law.k_n);
    p.stiffest = std::max(p.stiffest, law.k_n);
  };
  for (const std::uint16_t a : kinds) {
    for (const std::uint16_t b : kinds) take(contacts.laws[a * contacts.materials + b]);
    for (std::size_t w = a; w < walls.size(); w += contacts.materials) take(walls[w]);
  }
}

/// Looks at the contacts of the laws, and finds the shortest that there can be.
void resolve_contacts(const Scene& scene, std::size_t index, const Bodies& bodies, Physics& p) {
  std::vector<PairLaw> walls;
  for (const Material& wall : p.wall_materials)
    for (const Material& material : p.materials) walls.push_back(make_pair_law(material, wall, p.k_n));
  check_cohesion(scene, index, p, walls, bodies);
  find_stiffnesses(walls, p);
  const SweepSettings& contacts = p.contacts;
  ContactLaws laws{.materials = contacts.materials,
                   .material = contacts.material,
                   .bodies = contacts.laws,
                   .walls = walls,
                   .rolling = contacts.features.rolling};
  ShortestContact shortest = shortest_contact(bodies, laws);
  if (const std::optional<std::size_t> w = lightest_wall(scene, index)) {
    const ShortestContact unyielding = shortest;
    laws.lightest_wall = scene.walls[*w].load_mass;
    shortest = shortest_contact(bodies, laws);
    constexpr double kMuchShorter = 0.2;
    if (shortest.time < kMuchShorter * unyielding.time)
      p.light_wall = fmt::format(
          "{} is so light that the shortest contact lasts {:.3g} s, and would last {:.3g} s were it heavy; "
          "its load_mass is {:g} kg, expected one of {:.3g} kg or more",
          describe_wall(scene, *w), shortest.time, unyielding.time, laws.lightest_wall,
          bodies.mass[shortest.encounter.body]);
  }
  p.contact_time = shortest.time;
  p.shortest_contact = explain(shortest, bodies);
}

}  // namespace

double closing_speed(const Bodies& bodies) {
  Vec3 momentum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    momentum += bodies.mass[b] * bodies.velocity[b];
    mass += bodies.mass[b];
  }
  const Vec3 drift = momentum / mass;
  double first = 0.0, second = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    double reach = 0.0;
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
      reach = std::max(reach, bodies.spheres.offset[s].norm() + bodies.spheres.radius[s]);
    const double speed = (bodies.velocity[b] - drift).norm() + reach * angular_velocity(bodies, b).norm();
    if (speed > first) {
      second = first;
      first = speed;
    } else {
      second = std::max(second, speed);
    }
  }
  return first + second;
}

bool can_touch(const Scene& scene, std::size_t index, const Bodies& bodies) {
  if (!contacts_of(scene, index)) return false;
  std::size_t b = 0;
  while (b < bodies.size() && is_held(bodies, b)) ++b;
  if (b == bodies.size()) return false;
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    if (has_wall(scene, index, w)) return true;
  return bodies.size() > 1 || scene.box;
}

Physics resolve_laws(const Scene& scene, std::size_t index, const Bodies& bodies, double k_n) {
  const ContactSpec& contact = scene.contact;
  Physics p;
  p.can_touch = can_touch(scene, index, bodies);
  p.k_n = k_n;
  if (!p.can_touch) return p;
  p.materials = body_materials(scene, scene.stages[index]);
  p.wall_materials = wall_materials(scene, index);
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    if (has_wall(scene, index, w)) p.wall_names.push_back(describe_wall(scene, w));
  p.contacts.material = bodies.material;
  if (p.materials.size() == 1)
    std::fill(p.contacts.material.begin(), p.contacts.material.end(), std::uint16_t{0});
  p.contacts.materials = p.materials.size();
  for (const Material& a : p.materials)
    for (const Material& b : p.materials) p.contacts.laws.push_back(make_pair_law(a, b, p.k_n));
  std::vector<Material> touching = p.materials;
  touching.insert(touching.end(), p.wall_materials.begin(), p.wall_materials.end());
  p.contacts.features = required_features(touching, contact.rolling_slip == RollingSlip::zhang2017);
  p.contacts.sphere_damping = contact.damping_mass == DampingMass::spheres;
  return p;
}

double stiffening(const SweepSettings& before, const SweepSettings& now) {
  if (before.laws.empty() || now.laws.empty()) return 1.0;
  std::map<std::pair<std::uint16_t, std::uint16_t>, std::size_t> kinds;  // materials before and now: bodies
  const std::size_t bodies = std::min(before.material.size(), now.material.size());
  for (std::size_t b = 0; b < bodies; ++b) ++kinds[{before.material[b], now.material[b]}];
  double most = 0.0;
  for (const auto& [a, count] : kinds)
    for (const auto& [b, unused] : kinds) {
      if (a == b && count == 1 && bodies > 1) continue;  // it meets only others
      most = std::max(most, now.laws[a.second * now.materials + b.second].k_n /
                                before.laws[a.first * before.materials + b.first].k_n);
    }
  return most;
}

Stiffness resolve_stiffness(const Scene& scene, std::size_t index, const Bodies& bodies, const Walls& walls,
                            double held) {
  const StageSpec& stage = scene.stages[index];
  if (!can_touch(scene, index, bodies)) return {held, "that of the contacts so far"};
  if (stage.stiffness) return {*stage.stiffness, "given by the stage"};
  if (scene.contact.stiffness) return {*scene.contact.stiffness, "given by [contact]"};
  if (const auto own = softest_of_own(scene, index, bodies))
    return {*own, "the softest material's; all have their own"};
  const bool quiet = walls.empty() && field_of(scene, index) == Vec3::Zero() &&
                     closing_speed(bodies) <= 2.0 * escape_speed(bodies);  // as in a pile that turns
  if (held > 0.0 && quiet && !stage.impact_speed) return {held, "that of the contacts so far"};
  ContactDemand demand = demand_of(body_materials(scene, stage), wall_materials(scene, index));
  demand.max_overlap = scene.contact.max_overlap;
  demand.impact_speed = stage.impact_speed.value_or(default_impact_speed(scene, index, bodies, walls.walls));
  demand.field = field_of(scene, index).norm();
  demand.self_gravity = gravity_of(scene, index) != GravityMethod::none;
  demand.wall_mass = std::numeric_limits<double>::infinity();
  for (std::size_t w = 0; w < walls.walls.size(); ++w) {
    const std::optional<WallDrive>& drive = walls.walls[w].drive;
    if (!drive) continue;
    const double load = std::abs(drive->load);
    demand.wall_load = std::max(demand.wall_load, load);
    if (!stage.impact_speed)
      demand.wall_fall = std::max(demand.wall_fall, load * fall_of_wall(bodies, walls, w));
    demand.wall_mass = std::min(demand.wall_mass, drive->mass);
  }
  const StiffnessChoice choice = choose_stiffness(bodies, demand);
  if (!(choice.k_n > 0.0))
    throw error(scene, index, "stiffness",
                "nothing loads the contacts, so no stiffness can be chosen; expected contact.stiffness or an "
                "impact_speed");
  return {choice.k_n, explain(choice, demand, bodies)};
}

Physics resolve_physics(const Scene& scene, std::size_t index, const Bodies& bodies, double k_n,
                        double held) {
  const StageSpec& stage = scene.stages[index];
  const ContactSpec& contact = scene.contact;
  Physics p = resolve_laws(scene, index, bodies, k_n);

  p.overlap_limit = contact.overlap_limit;
  if (p.can_touch) resolve_contacts(scene, index, bodies, p);
  p.gravity = gravity_of(scene, index);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (!is_held(bodies, b)) p.body_mass += bodies.mass[b];
  p.perturbers = make_perturbers(scene, p.body_mass);
  const std::optional<double> given = stage.time_step ? stage.time_step : contact.time_step;
  const double longest = kLongestSafeStep * p.contact_time;
  const auto cause = [&] { return p.light_wall.empty() ? "" : "; " + p.light_wall; };
  if (p.can_touch && given && *given > longest && !contact.unsafe_time_step)
    throw error(scene, index, "time_step",
                "time_step {:.4g} s is too long; the longest safe one is {:.4g} s ({:.0f} per shortest "
                "contact){}",
                *given, longest, 1.0 / kLongestSafeStep, cause());
  const double aim = given         ? *given
                     : p.can_touch ? p.contact_time / contact.steps_per_contact
                     : held > 0.0  ? held
                                   : free_step(scene, index, p, bodies);
  if (const double steps = (stage.duration + stage.extension) / aim; !(steps < 1e15))
    throw error(scene, index, "duration", "{:.3g} steps of {:.3g} s are more than a run can make{}", steps,
                aim, cause());
  // Whole steps that end exactly with the stage.
  p.steps =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(stage.duration / aim * (1.0 - 1e-12))));
  const double dt = stage.duration / static_cast<double>(p.steps);
  p.contacts.dt = dt;
  p.steps += static_cast<std::uint64_t>(std::llround(stage.extension / dt));

  if (scene.gravity.opening_angle) {
    p.tree.theta = *scene.gravity.opening_angle;
    p.tree.order = static_cast<int>(scene.gravity.order);
  } else if (p.gravity == GravityMethod::tree) {
    p.gravity_error = scene.gravity.error;
    p.tree = gravity::settings_for(scene.gravity.error);
  }
  const Interval& interval = scene.gravity.interval;
  p.gravity_steps = interval.unit == Interval::Unit::automatic ? 0
                    : interval.unit == Interval::Unit::steps   ? static_cast<std::uint64_t>(interval.value)
                                                               : whole_steps(interval.value, dt);
  p.error = scene.gravity.error;
  double density = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    density = std::max(density, bodies.mass[b] / bodies.volume[b]);
  p.fall_time = 1.0 / std::sqrt(4.0 / 3.0 * kPi * kGravitationalConstant * density);
  p.field = field_of(scene, index);
  p.largest_radius = *std::max_element(bodies.spheres.radius.begin(), bodies.spheres.radius.end());
  p.spin = stage.spin;
  p.relax = stage.relax;
  p.strain_rate = stage.strain_rate;
  constexpr double most = 0.1;  // of an edge in a step
  if (const double strain = p.strain_rate.cwiseAbs().maxCoeff() * dt; strain > most)
    throw error(scene, index, "strain_rate",
                "strain_rate changes the box by a part of {:.3g} in a step of {:.3g} s; at most {:g} can be "
                "followed: give a smaller strain_rate or time_step",
                strain, dt, most);
  p.packing = stage.packing;
  p.quiet_energy = stage.quiet_energy;
  p.quiet_speed = stage.quiet_speed;
  p.duration = stage.duration;
  p.body_volume = std::accumulate(bodies.volume.begin(), bodies.volume.end(), 0.0);
  if (scene.box) p.least_edge = least_edge(bodies);
  constexpr double kStepsPerRow = 200.0;  // a row costs as much as some eight steps
  if (stage.spin) {
    if (stage.spin->control_interval > 0.0) p.control_steps = whole_steps(stage.spin->control_interval, dt);
    p.link_gap = stage.spin->remnant_gap *
                 *std::min_element(bodies.spheres.radius.begin(), bodies.spheres.radius.end());
  }
  p.quiet_steps = whole_steps(stage.quiet_interval.value_or(kStepsPerRow * dt), dt);
  p.series_interval = scene.output.series_interval > 0.0 ? scene.output.series_interval
                                                         : std::max(1e-3 * stage.duration, kStepsPerRow * dt);
  p.snapshot_interval = scene.output.snapshot_interval;
  return p;
}

double packing_fraction(const Physics& physics, const Box& box) {
  return physics.body_volume / box.volume();
}

std::string describe_models(const Physics& physics, const Bodies& bodies, bool walls, bool box) {
  const Features& f = physics.contacts.features;
  std::string text = bodies.size() == bodies.spheres.size() ? "loose spheres" : "aggregates";
  text += physics.can_touch    ? "; normal"
          : bodies.size() == 1 ? "; no contacts: nothing can touch"
                               : "; no contacts: bodies pass through each other";
  if (f.tangential) text += " + tangential";
  if (f.rolling) text += " + rolling";
  if (f.twisting) text += " + twisting";
  if (f.cohesion) text += " + cohesion";
  if (f.rolling_slip) text += " (rolling slip of Zhang 2017)";
  if (walls) text += "; walls";
  if (!bodies.held.empty()) text += "; held bodies";
  if (box) text += "; periodic box";
  if (physics.strain_rate != Vec3::Zero()) text += ", strained";
  if (physics.gravity == GravityMethod::direct) text += "; direct gravity";
  if (physics.gravity_error)
    text += fmt::format("; tree gravity to {:g}", *physics.gravity_error);
  else if (physics.gravity == GravityMethod::tree)
    text += fmt::format("; tree gravity, opening {:g}, order {}", physics.tree.theta, physics.tree.order);
  if (physics.gravity != GravityMethod::none && physics.gravity_steps != 1)
    text += physics.gravity_steps == 0 ? ", evaluated when needed"
                                       : fmt::format(", evaluated every {} steps", physics.gravity_steps);
  if (physics.field != Vec3::Zero()) text += "; uniform field";
  for (const gravity::Perturber& p : physics.perturbers)
    text += fmt::format("; perturber '{}' ({})", p.name, p.tidal ? "tide" : "whole pull");
  if (physics.spin) text += "; spin control";
  if (physics.relax) text += "; relaxes";
  if (physics.quiet_energy || physics.quiet_speed) text += "; ends when quiet";
  return text;
}

}  // namespace cairn
