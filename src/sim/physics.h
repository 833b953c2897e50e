// What one stage of a scene requires, resolved: models, stiffness, time step. Absent models cost nothing.
#pragma once

#include <optional>
#include <string>

#include "contact/sweep.h"
#include "gravity/fmm.h"
#include "gravity/perturber.h"
#include "io/scene.h"
#include "sim/state.h"

namespace cairn {

struct Physics {
  bool can_touch = true;                 ///< otherwise there is no search, no law and no stiffness
  SweepSettings contacts;                ///< with the time step of the stage
  std::vector<Material> materials;       ///< of the bodies; settings.material indexes these
  std::vector<Material> wall_materials;  ///< of each wall
  std::vector<std::string> wall_names;   ///< of each, as messages call it
  double k_n = 0.0;                      ///< N/m, of materials without a stiffness of their own
  double softest = 0.0, stiffest = 0.0;  ///< N/m, k_N of the contacts that these bodies can have
  double contact_time = 0.0;             ///< s, shortest any contact can last; 0 where nothing can touch
  std::string shortest_contact;          ///< which that is, in words
  std::string light_wall;                ///< what a wall of little load_mass does to it; empty: not much
  double overlap_limit = 0.1;
  std::uint64_t steps = 0;  ///< of the stage
  GravityMethod gravity = GravityMethod::none;
  gravity::FmmSettings tree;
  std::optional<double> gravity_error;  ///< asked of the tree; absent: opening angle and order by hand
  std::uint64_t gravity_steps = 1;      ///< between evaluations; 0: as few as `error` needs
  double error = 0.0;                   ///< of the field, asked for
  double fall_time = 0.0;               ///< s, 1/sqrt(4 pi G rho / 3) of the densest body
  Vec3 field = Vec3::Zero();            ///< m/s^2
  std::vector<gravity::Perturber> perturbers;
  double body_mass = 0.0;       ///< kg, of all bodies that are not held
  double largest_radius = 0.0;  ///< m, of a sphere
  std::optional<SpinSpec> spin;
  std::optional<RelaxSpec> relax;
  Vec3 strain_rate = Vec3::Zero();                  ///< 1/s, of the periodic box
  std::optional<double> packing;                    ///< the strain ends there
  double body_volume = 0.0;                         ///< m^3, of all bodies
  std::optional<double> quiet_energy, quiet_speed;  ///< the stage ends below these
  double duration = 0.0;                            ///< s, of the stage, at most, without its extension
  double least_edge = 0.0;                          ///< m, of a periodic box
  std::uint64_t control_steps = 1;                  ///< steps between spin corrections
  double link_gap = 0.0;                            ///< m, up to which bodies belong to the pile that is spun
  std::uint64_t quiet_steps = 1;                    ///< between looks whether all is quiet
  double series_interval = 0.0;                     ///< s, between rows of the series
  double snapshot_interval = 0.0;                   ///< s; 0: only at the end of the stage
};

/// Whether anything can touch in stage `index`: it has contacts, and two bodies, a wall or images in a box.
bool can_touch(const Scene& scene, std::size_t index, const Bodies& bodies);

/// Resolves the contacts of stage `index` at stiffness k_n (N/m), and nothing else: materials, laws, models.
Physics resolve_laws(const Scene& scene, std::size_t index, const Bodies& bodies, double k_n);

/// How many times as stiff contacts of the bodies are under the laws `now` as under those `before`, where
/// that is most; 1 where either has none. Of bodies that have come since nothing is said.
double stiffening(const SweepSettings& before, const SweepSettings& now);

/// A normal stiffness and where it comes from.
struct Stiffness {
  double k_n = 0.0;  ///< N/m, of materials without their own
  std::string why;   ///< in words; of a chosen one the bodies that ask for it, and what would change it
};

/// Normal stiffness of stage `index` with its walls: given by the scene, or chosen for the bodies as
/// they are now. Where nothing but self-gravity is to be borne, it stays what contacts have `held` so far (0:
/// none): stiffer ones would push a settled pile apart; and so where nothing can touch.
/// @throws InputError when nothing loads the contacts and none is given.
Stiffness resolve_stiffness(const Scene& scene, std::size_t index, const Bodies& bodies, const Walls& walls,
                            double held);

/// Resolves stage `index` of the scene for these bodies at stiffness k_n. Depends on their motion only where
/// nothing can touch and no time step is given: this follows from their spins at the start of the stage, and
/// within it from the time step `held` (s; 0: the stage begins).
/// @throws InputError when the time step is longer than the longest safe one, or cohesion too strong for k_n.
Physics resolve_physics(const Scene& scene, std::size_t index, const Bodies& bodies, double k_n,
                        double held = 0.0);

/// Largest speed (m/s) at which two bodies meet at the start, were they to meet.
double closing_speed(const Bodies& bodies);

/// The part of the box that the bodies fill; those glued of overlapping spheres count by their mass model.
double packing_fraction(const Physics& physics, const Box& box);

/// A short list of the models in the step, e.g. "tangential + rolling + twisting + cohesion, tree gravity".
std::string describe_models(const Physics& physics, const Bodies& bodies, bool walls, bool box);

}  // namespace cairn
