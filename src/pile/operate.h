// Stages that change the bodies of a pile and take no time: carving, scaling, giving materials and densities.
#pragma once

#include <string>
#include <vector>

#include "io/scene.h"
#include "pile/region.h"
#include "sim/state.h"

namespace cairn {

/// The region of stage `index`, which carves or assigns. @throws InputError when it cannot be read.
Region region_of(const Scene& scene, std::size_t index);

/// Does what stage `index` of the scene asks for to the bodies of `state` and to their contacts, those in
/// `contacts` and with walls; returns in a few words what that was. Deterministic.
/// @throws InputError for a region that cannot be read, for no bodies left or met, and for no volume.
std::string operate(const Scene& scene, std::size_t index, State& state,
                    std::vector<ContactRecord>& contacts);

/// Reads the regions of all stages that operate, so that what is wrong with them is known before hours have
/// passed. @throws InputError for one that cannot be read.
void check_operations(const Scene& scene);

/// What stage `index` will do, in one line. @throws InputError for a region that cannot be read.
std::string describe_operation(const Scene& scene, std::size_t index);

}  // namespace cairn
