// What stages that carve, scale or assign will find, judged before the run: lengths in a wrong unit are seen
// before hours have passed.
#pragma once

#include <string>
#include <vector>

#include "io/scene.h"
#include "sim/state.h"

namespace cairn {

/// For each stage of a scene that begins with this state, what looks wrong about its operation: a region
/// smaller than a body, one that holds only a few bodies or is a thousand times larger than the pile, a
/// density that changes masses or lengths by more than a factor of two. Bodies are taken where they are until
/// a stage has moved them, and then as a ball at 60 % packing.
/// @throws InputError for a region that cannot be read.
std::vector<std::vector<std::string>> operation_warnings(const Scene& scene, const State& state);

}  // namespace cairn
