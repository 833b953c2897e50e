// The perturbers of a scene.
#pragma once

#include "gravity/perturber.h"
#include "io/scene.h"

namespace cairn {

/// Fills `track` of the perturbers that have a track_file.
/// @throws InputError naming the key's place in the scene, the file and its line.
void load_tracks(Scene& scene);

/// The perturbers of the scene; an orbit without a gravitational parameter takes that of the perturber and
/// bodies of this mass (kg). Tracks have been loaded.
std::vector<gravity::Perturber> make_perturbers(const Scene& scene, double body_mass);

}  // namespace cairn
