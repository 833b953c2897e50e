// From a scene to the bodies it starts with.
#pragma once

#include "io/scene.h"
#include "sim/setup.h"

namespace cairn {

/// Bodies of the scene: those of its pile file, its clouds, and those put by hand, in this order.
/// @throws InputError for a shape that cannot be loaded, a pile that cannot be read, or a cloud that does not
/// fit.
Setup assemble(const Scene& scene);

}  // namespace cairn
