#include "sim/start_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/law/law.h"
#include "core/parallel.h"
#include "sim/relax.h"

namespace cairn {

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
  while (index-- > 0 && scene.stages[index].operates()) {
    const StageSpec& stage = scene.stages[index];
    if (stage.scale || (stage.assign && (stage.assign->density || stage.assign->density_factor)))
      return false;
  }
  return true;
}

/// The law that the contacts obeyed before stage `index`, at the stiffness they had.
SweepSettings former_law(const Scene& scene, std::size_t index, const Physics& physics, const State& state) {
  while (index-- > 0)
    if (!scene.stages[index].operates())
      return resolve_physics(scene, index, state.bodies, state.k_n).contacts;
  SweepSettings law = physics.contacts;  // of a pile from a file only the stiffness is known
  for (PairLaw& pair : law.laws) {
    pair.k_n *= state.k_n / physics.k_n;
    pair.k_s *= state.k_n / physics.k_n;
  }
  return law;
}

}  // namespace

double StartEnergy::ratio() const {
  constexpr double kRoundOff = 1e-9;  // an overlap that is none
  if (excess <= 0.0 || overlap < kRoundOff) return 0.0;
  return scale > 0.0 ? excess / scale : std::numeric_limits<double>::infinity();
}

double held_energy(const Scene& scene, std::size_t index, const Physics& physics, const State& state,
                   const std::vector<ContactRecord>& contacts) {
  if (!(state.k_n > 0.0) || (contacts.empty() && state.walls.contacts.empty()) || !in_balance(scene, index))
    return 0.0;
  const Bodies& bodies = state.bodies;
  const SweepSettings law = former_law(scene, index, physics, state);
  double energy = with_features(law.features, [&]<Features F>() {
    return parallel_sum(contacts.size(), 0.0, [&](std::size_t k) {
      const ContactRecord& c = contacts[k];
      const std::uint16_t a = law.material[bodies.spheres.body[c.i]],
                          b = law.material[bodies.spheres.body[c.j]];
      const double ri = bodies.spheres.radius[c.i], rj = bodies.spheres.radius[c.j];
      return stored_energy<F>(LawConstants<double>(law.laws[a * law.materials + b]), overlap(state, c.i, c.j),
                              ri * rj / (ri + rj), c.memory);
    });
  });
  if (!state.walls.contacts.empty()) {
    Walls walls = state.walls;
    walls.set_laws(physics.materials, physics.wall_materials, state.k_n);
    energy += walls.stored_energy(bodies, physics.contacts, state.clock.time());
  }
  return energy;
}

StartEnergy start_energy(const Physics& physics, const State& state, const Observation& observation,
                         double held, double former) {
  const Bodies& bodies = state.bodies;
  StartEnergy out{.excess = observation.elastic - held, .relaxes = physics.relax.has_value()};
  if (former > 0.0) out.stiffer = physics.k_n / former;
  if (observation.gravitational < 0.0) {
    out.scale = -observation.gravitational;
    out.of = "gravitational energy";
  } else {
    double work = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      work += bodies.mass[b] * physics.field.norm() * std::cbrt(bodies.volume[b] / (4.0 / 3.0 * kPi));
    out.scale = std::max(work, observation.agitation);
    out.of = work > observation.agitation ? "work that the field does over a radius"
                                          : "kinetic energy of the motion in the pile";
  }
  out.deepest = deepest_pair(bodies, state.contacts);
  if (const auto [i, j] = out.deepest; i != j)
    out.overlap = overlap(state, i, j) / std::min(bodies.spheres.radius[i], bodies.spheres.radius[j]);
  out.duration = 50.0 / relaxation_rate(RelaxSpec{}, physics.k_n, physics.body_mass, bodies.size());
  if (physics.gravity != GravityMethod::none)  // what has been pushed apart falls together again
    out.duration = std::max(out.duration, 10.0 * physics.fall_time);
  return out;
}

std::string describe(const StartEnergy& energy, const Bodies& bodies) {
  std::string text = "at the start its contacts hold ";
  text += energy.scale > 0.0
              ? fmt::format("{:.3g} times the {}", energy.ratio(), energy.of)
              : fmt::format("{:.3g} J, and nothing that could hold the bodies together", energy.excess);
  if (energy.stiffer > 1.0 + 1e-9)
    text += fmt::format(" beyond what they held, being {:.3g} times stiffer than before", energy.stiffer);
  if (const auto [i, j] = energy.deepest; i != j)
    text += fmt::format("; deepest: spheres {} and {} of bodies {} and {}, by {:.3g} of the smaller radius",
                        i, j, bodies.spheres.body[i], bodies.spheres.body[j], energy.overlap);
  if (energy.relaxes) return text + "; the stage takes it out";
  return text + fmt::format(
                    "; it will push the bodies apart: put a stage before this one that takes it out, with "
                    "relax = {{}} and a duration of up to {:.2g} s",
                    energy.duration);
}

}  // namespace cairn
