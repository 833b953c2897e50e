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

}  // namespace cairn
