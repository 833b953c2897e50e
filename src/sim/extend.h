// Runs made longer than their scenes were.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sim/run.h"

namespace cairn {

/// What a run shall do beyond its scene.
struct Continuation {
  std::optional<double> until;   ///< s, when its last stage shall end
  std::string stages = {};       ///< text of [[stage]] tables that follow; empty: none
  std::string stages_file = {};  ///< where they come from
};

/// The text of the scene so continued. `clock` is where the run is, `finished` whether it has come to its
/// end.
/// @throws InputError when the last stage has no end that could be put off, or an earlier one is asked for.
std::string continued_scene(const Scene& scene, const Clock& clock, bool finished, const Continuation& more);

}  // namespace cairn
