#include "sim/start_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/law/law-inl.h"
#include "core/elementary.h"
#include "core/parallel.h"
#include "sim/make_walls.h"
#include "sim/relax.h"
#include "sim/springs.h"

namespace cairn {

using namespace HWY_NAMESPACE;  // the law of one contact

namespace {

/// Vector (m) from the centre of sphere i to that of j, in a periodic box of its nearest image.
Vec3 separation(const State& state, std::uint32_t i, std::uint32_t j) {
  const Bodies& bodies = state.bodies;
  const Spheres& spheres = bodies.spheres;
  Vec3 d = spheres.position[j] - spheres.position[i];
  if (!bodies.cell.empty())
    d += bodies.cell_edge * (bodies.cell[spheres.body[j]] - bodies.cell[spheres.body[i]]);
  for (int axis = 0; axis < 3; ++axis)
    if (const double edge = state.box.edge[axis]; edge > 0.0) d[axis] -= std::round(d[axis] / edge) * edge;
  return d;
}

double overlap(const State& state, std::uint32_t i, std::uint32_t j) {
  const std::vector<double>& radius = state.bodies.spheres.radius;
  return radius[i] + radius[j] - separation(state, i, j).norm();
}

/// Whether the bodies are as they were when their contacts were last in balance.
bool in_balance(const Scene& scene, std::size_t index) {
  const auto own = [](const Material& m) { return m.stiffness.has_value(); };
  const bool alike = std::none_of(scene.materials.begin(), scene.materials.end(), own);
  while (index-- > 0 && scene.stages[index].operates()) {
    const StageSpec& stage = scene.stages[index];
    if (stage.scale) return false;
    if (stage.assign && (stage.assign->density || stage.assign->density_factor)) return false;
    if (stage.assign && !stage.assign->material.empty() && !alike) return false;
  }
  return true;
}

/// Energy (J), at the places now, of contacts between bodies that were left at stiffness `k_n` (N/m).
double pair_energy(const SweepSettings& law, double k_n, const State& state,
                   const std::vector<ContactRecord>& contacts) {
  const Bodies& bodies = state.bodies;
  return with_features(law.features, [&]<Features F>() {
    return parallel_sum(contacts.size(), 0.0, [&](std::size_t k) {
      const ContactRecord& c = contacts[k];
      const PairLaw& pair = law.law(bodies, {c.i, c.j});
      ContactMemory<double> memory = c.memory;
      enter_stiffness(pair, k_n, memory);
      const double ri = bodies.spheres.radius[c.i], rj = bodies.spheres.radius[c.j];
      return stored_energy<F>(LawConstants<double>(pair), overlap(state, c.i, c.j), ri * rj / (ri + rj),
                              memory);
    });
  });
}

/// The same of contacts with walls, which the laws know by these numbers.
double wall_energy(const Physics& laws, Walls walls, const State& state) {
  std::vector<ContactRecord> none;
  enter_stiffness(laws, state.bodies, state.k_n, none, walls.contacts);
  walls.set_laws(laws.materials, laws.wall_materials, laws.k_n);
  return walls.stored_energy(state.bodies, laws.contacts, state.clock.time());
}

}  // namespace

double StartEnergy::ratio() const {
  constexpr double kRoundOff = 1e-9;  // an overlap that is none
  if (excess <= 0.0 || overlap < kRoundOff) return 0.0;
  return scale > 0.0 ? excess / scale : std::numeric_limits<double>::infinity();
}

HeldBefore held_before(const Scene& scene, std::size_t index, const Physics& physics, const State& state,
                       const std::vector<ContactRecord>& contacts, const Physics* former) {
  HeldBefore out;
  if (!(state.k_n > 0.0) || !physics.can_touch) return out;
  Physics law = former && former->can_touch ? *former : resolve_laws(scene, index, state.bodies, state.k_n);
  law.wall_materials = physics.wall_materials;  // the state has the walls of the stage that begins
  if (!(contacts.empty() && state.walls.contacts.empty()) && in_balance(scene, index)) {
    out.energy = pair_energy(law.contacts, state.k_n, state, contacts);
    if (!state.walls.contacts.empty()) out.energy += wall_energy(law, state.walls, state);
  }
  out.contacts = std::move(law.contacts);
  return out;
}

double forgotten_energy(const Scene& scene, std::size_t index, const FormerStage& former, const State& state,
                        const std::vector<ContactRecord>& contacts) {
  if (!(state.k_n > 0.0) || !former.physics.can_touch || !in_balance(scene, index)) return 0.0;
  Walls forgotten = former.walls;
  forgotten.driven = state.walls.driven;
  forgotten.contacts.clear();
  for (WallContact c : state.walls.contacts) {
    const auto acted = std::ranges::find(forgotten.number, c.wall);
    if (has_wall(scene, index, c.wall) || acted == forgotten.number.end()) continue;
    c.wall = static_cast<std::uint32_t>(acted - forgotten.number.begin());
    forgotten.contacts.push_back(c);
  }
  double energy = forgotten.contacts.empty() ? 0.0 : wall_energy(former.physics, forgotten, state);
  if (!can_touch(scene, index, state.bodies))
    energy += pair_energy(former.physics.contacts, state.k_n, state, contacts);
  return energy;
}

StartEnergy start_energy(const Physics& physics, const State& state, const Observation& observation,
                         const HeldBefore& held) {
  const Bodies& bodies = state.bodies;
  StartEnergy out{.excess = observation.elastic - held.energy,
                  .wall = {},
                  .stiffer = stiffening(held.contacts, physics.contacts),
                  .relaxes = physics.relax.has_value()};
  if (observation.gravitational < 0.0) {
    out.scale = -observation.gravitational;
    out.of = "gravitational energy";
  } else {
    double work = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      work += bodies.mass[b] * physics.field.norm() * cube_root(bodies.volume[b] / (4.0 / 3.0 * kPi));
    out.scale = std::max(work, observation.agitation);
    out.of = work > observation.agitation ? "work that the field does over a radius"
                                          : "kinetic energy of the motion in the pile";
  }
  out.deepest = deepest_pair(bodies, state.contacts);
  if (const auto [i, j] = out.deepest; i != j)
    out.overlap = overlap(state, i, j) / std::min(bodies.spheres.radius[i], bodies.spheres.radius[j]);
  if (const DeepestTouch touch = state.walls.deepest(bodies, state.clock.time()); touch.ratio > out.overlap) {
    out.overlap = touch.ratio;
    out.deepest = {touch.sphere, touch.sphere};
    out.wall = touch.wall;
  }
  out.duration = 50.0 / relaxation_rate(RelaxSpec{}, physics.softest, physics.body_mass, bodies.size());
  if (physics.gravity != GravityMethod::none)  // what has been pushed apart falls together again
    out.duration = std::max(out.duration, 10.0 * physics.fall_time);
  return out;
}

std::string describe(const StartEnergy& energy, const Scene& scene, const Bodies& bodies) {
  std::string text = "at the start its contacts hold ";
  text += energy.scale > 0.0
              ? fmt::format("{:.3g} times the {}", energy.ratio(), energy.of)
              : fmt::format("{:.3g} J, and nothing that could hold the bodies together", energy.excess);
  if (energy.stiffer > 1.0 + 1e-9)
    text += fmt::format(" beyond what they held, being {:.3g} times stiffer than before", energy.stiffer);
  if (energy.wall)
    text += fmt::format("; deepest: sphere {} of body {} in {}, by {:.3g} of its radius", energy.deepest.i,
                        bodies.spheres.body[energy.deepest.i], describe_wall(scene, *energy.wall),
                        energy.overlap);
  else if (const auto [i, j] = energy.deepest; i != j)
    text += fmt::format("; deepest: spheres {} and {} of bodies {} and {}, by {:.3g} of the smaller radius",
                        i, j, bodies.spheres.body[i], bodies.spheres.body[j], energy.overlap);
  if (energy.relaxes) return text + "; the stage takes it out";
  return text + fmt::format(
                    "; it will push the bodies apart: put a stage before this one that takes it out, with "
                    "relax = {{}} and a duration of up to {:.2g} s",
                    energy.duration);
}

}  // namespace cairn
