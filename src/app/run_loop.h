// Runs a simulation with a progress bar, stops it on SIGINT, SIGTERM and SIGHUP, prints the summary at the
// end.
#pragma once

#include "sim/run.h"

namespace cairn {

/// The run was stopped by the user; its checkpoint is written.
struct Interrupted {};

/// Runs to the end, and closes the run.
/// @throws Interrupted after such a signal, when the checkpoint is on disk.
void run_to_end(Run run);

}  // namespace cairn
