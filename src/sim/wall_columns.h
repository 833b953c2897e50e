// The columns of the series: those of every run, and those of its scene's walls.
#pragma once

#include <vector>

#include "sim/observe.h"

namespace cairn {

/// Those of every run, then for each wall of the scene force and torque on it.
std::vector<SeriesColumn> run_columns(const Scene& scene);
/// Their values, in that order.
std::vector<double> run_row(const Scene& scene, const Observation& observation, const State& state);

}  // namespace cairn
