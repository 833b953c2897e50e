// The numbers of finished runs, side by side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/run.h"

namespace cairn {

/// A time in seconds, minutes, hours or days, whichever suits its size.
std::string duration_text(double seconds);

/// Prints one column per result file: what was reached, shed, conserved.
/// @throws InputError for a file that is not a result file.
void print_summary(const std::vector<std::filesystem::path>& files);

/// Prints wall-clock time by phase and the rate of a run just made.
void print_phase_times(const Run& run, double seconds, std::uint64_t steps);

}  // namespace cairn
