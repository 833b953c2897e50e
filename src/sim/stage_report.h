// What a stage has made of the pile: the summary blocks that build and run print and the file keeps.
#pragma once

#include <string>
#include <vector>

#include "io/fields.h"
#include "sim/state.h"

namespace cairn {

/// Measures of the pile at the end of a stage.
struct StageReport {
  std::string name, what;  ///< of the stage; what an operation has done, or why the stage ended
  double seconds = 0.0;    ///< of wall-clock time; not stored
  double held_bodies = 0.0, held_mass = 0.0;  ///< kg; not stored, both are of the constants of the bodies
  double time = 0.0;                          ///< s, at the end
  double bodies = 0.0, spheres = 0.0;
  double mass = 0.0;          ///< kg, of all bodies, held ones included
  double bulk_density = 0.0;  ///< kg/m^3, mass over the volume of the region last carved; NaN without one
  double eta_bulk = 0.0;      ///< volume of the bodies over that volume
  double interior = 0.0;      ///< m, radius within which eta_inter is measured
  double interior_bodies = 0.0;
  double eta_inter = 0.0;     ///< see Packing: total, plain cells
  double eta_radical = 0.0;   ///< total, radical cells
  double eta_mean = 0.0;      ///< mean, plain cells
  double coordination = 0.0;  ///< see Coordination
  double body_contacts = 0.0;
  double body_neighbours = 0.0;
  double free_bodies = 0.0, hanging_bodies = 0.0;
  double overlap = 0.0;  ///< largest now, over the smaller radius
  double groups = 0.0;   ///< of connected bodies
  double outside = 0.0;  ///< bodies that are not part of the largest group
  double speed = 0.0;    ///< m/s, rms, see agitation
  double period = 0.0;   ///< s
};

/// Measures the state; `link_gap` (m): bodies closer than this belong together; `interior` (m): see
/// OutputSpec.
StageReport measure(const State& state, double link_gap, double interior);

/// The reports as columns, one row per stage done.
struct StageColumns {
  std::vector<std::string> name, what;
  std::vector<std::vector<double>> values;  ///< in the order of the table

  StageColumns();
  void push_back(const StageReport& report);
  void pop_back();
  FieldTable table();
};

/// A few lines for people.
std::string describe(const StageReport& report);

/// What makes a pile unfit to start from, in a line each: overlaps above the limit, bodies that are not
/// connected with the rest. Places that are not finite have ended the run before.
std::vector<std::string> defects(const StageReport& report, double overlap_limit);

}  // namespace cairn
