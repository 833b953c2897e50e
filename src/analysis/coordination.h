// How many neighbours spheres and bodies touch.
#pragma once

#include <span>

#include "body/bodies.h"
#include "contact/box.h"
#include "contact/walls.h"

namespace cairn {

/// Spheres touch whose surfaces are closer than a billionth of the smallest radius: a lattice of touching
/// spheres has rounded places.
struct Coordination {
  std::size_t contacts = 0;    ///< touching pairs of spheres of different bodies, and with walls
  std::size_t body_pairs = 0;  ///< touching pairs of bodies, each once
  // Of bodies that are not held:
  double per_sphere = 0.0;         ///< mean contacts of a sphere
  double per_body = 0.0;           ///< mean contacts of a body
  double neighbours = 0.0;         ///< mean number of bodies that a body touches
  std::size_t free_bodies = 0;     ///< that touch nothing
  std::size_t hanging_bodies = 0;  ///< that touch in one contact only
  double largest_overlap = 0.0;    ///< over the smaller radius of its pair; of bodies
};

/// Sphere centres must be up to date; `on_walls` are the contacts with walls.
Coordination coordination(const Bodies& bodies, const Box& box = {},
                          std::span<const WallContact> on_walls = {});

}  // namespace cairn
