// The table of all keys of a scene.
#pragma once

#include "io/options.h"
#include "io/scene.h"

namespace cairn {

/// Name, type, unit, default, bounds and help of every key of a scene file.
const Keys<Scene>& scene_keys();

}  // namespace cairn
