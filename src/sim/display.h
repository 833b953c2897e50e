// Where bodies and spheres are drawn.
#pragma once

#include "io/fields.h"
#include "sim/state.h"

namespace cairn {

/// Positions as a snapshot holds them.
struct Display {
  Vec3 origin = Vec3::Zero();     ///< m, from the zero of the frame
  std::vector<Vec3> bodies;       ///< m, from the origin; images of a box are followed
  std::vector<Vec3f> spheres;     ///< m, from the origin; bodies centred within the box
  std::vector<Vec3f> velocities;  ///< m/s, of the spheres' centres
};

/// The origin is the zero while the largest remnant is near it, and else the whole quarter of a cell nearest
/// to the remnant's mass centre: single precision is then good for 1e-4 of a radius in the remnant.
Display make_display(const State& state, const std::vector<std::uint8_t>& remnant);

}  // namespace cairn
