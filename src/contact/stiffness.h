// Choice of the normal stiffness and of the time step from what a scene asks of its contacts.
#pragma once

#include "body/bodies.h"
#include "contact/law/material.h"

namespace cairn {

/// What the contacts must bear.
struct ContactDemand {
  double max_overlap = 0.01;  ///< aimed at, of the smallest sphere radius
  double impact_speed = 0.0;  ///< m/s
  double field = 0.0;         ///< m/s^2, magnitude of the uniform field
  bool self_gravity = false;
  double cohesion = 0.0;      ///< Pa, strongest
  double shape_factor = 0.5;  ///< beta, largest
};

/// Smallest normal stiffness (N/m) that keeps overlaps near the aim: k >= M (v / x)^2 for impacts and k >= F
/// / x for the static load: pressure at the centre of the pile, 8 times for force chains, and cohesion [Zhang
/// et al. 2017, section 2.2]. 0 when nothing loads the contacts.
double choose_stiffness(const Bodies& bodies, const ContactDemand& demand);

/// Escape speed (m/s) from the surface of the pile the bodies would make at 60 % packing.
double escape_speed(const Bodies& bodies);

/// Half the period (s) of the fastest undamped contact mode any two of the bodies, or a body and a wall, can
/// have: normal, tangential, rolling or twisting, in the worst direction. No mode of a contact is faster than
/// this over pi. Exact for two equal bodies in the worst position, an upper bound on the frequency otherwise.
double shortest_contact_time(const Bodies& bodies, double k_n, double shape_factor, bool rolling, bool walls);

/// A pile's coordination adds stiffnesses on one light body; steps longer than this part of the shortest
/// contact time are refused.
inline constexpr double kLongestSafeStep = 0.1;

}  // namespace cairn
