// What is measured on a pile while it runs: the rows of the result file's series.
#pragma once

#include <vector>

#include "io/results.h"
#include "sim/step.h"

namespace cairn {

/// One row of the series. Every number is documented in the column table (observe.cpp).
struct Observation {
  double time = 0.0, stage = 0.0, period = 0.0, spin_target = 0.0, axis_a = 0.0, axis_b = 0.0, axis_c = 0.0,
         b_over_a = 0.0, c_over_a = 0.0, all_b_over_a = 0.0, all_c_over_a = 0.0, wobble = 0.0;
  double kinetic = 0.0, rotational = 0.0, gravitational = 0.0, elastic = 0.0, dissipated = 0.0,
         wall_work = 0.0, control_work = 0.0, relaxed_work = 0.0, stage_work = 0.0, field = 0.0,
         perturber_work = 0.0, perturber_distance = 0.0;
  double momentum_x = 0.0, momentum_y = 0.0, momentum_z = 0.0, angular_x = 0.0, angular_y = 0.0,
         angular_z = 0.0;
  double agitation = 0.0;
  double momentum_drift = 0.0, angular_drift = 0.0;
  double contacts = 0.0, coordination = 0.0, touching_bodies = 0.0, largest_overlap = 0.0;
  double remnant_mass_fraction = 0.0, shed_bodies = 0.0, fragments = 0.0, packing = 0.0, control_active = 0.0,
         gravity_interval = 0.0, gravity_miss = 0.0;
  std::vector<std::uint8_t> remnant;  ///< of each body: 1 when part of the largest remnant; not in the row
};

/// Name, unit and meaning of each column, in the order of `row`.
std::vector<SeriesColumn> series_columns();
std::vector<double> row(const Observation& observation);

/// Gap (m) up to which bodies belong together, as the scene asks for it.
double link_gap(const Scene& scene, const Bodies& bodies);

/// Measures the state. `link_gap` (m): bodies closer than this belong together.
Observation observe(const Physics& physics, const State& state, Scratch& scratch, double link_gap);

/// Energy (J) in the springs of all contacts, less the work of cohesion.
double elastic_energy(const Physics& physics, const State& state);

/// Only what concerns the largest remnant.
void observe_remnant(const State& state, double link_gap, Observation& o);

}  // namespace cairn
