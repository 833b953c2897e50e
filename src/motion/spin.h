// Prescribed spin: the path T(t) and the rigid rotation that keeps a pile on it [Zhang et al. 2021,
// section 2.3].
#pragma once

#include <span>
#include <vector>

#include "body/bodies.h"

namespace cairn {

/// A point of the spin path: time since the start of the stage (s), spin period (s).
struct SpinPoint {
  double time, period;
};

/// Period (s) at time t, linear between points, constant outside them.
double period_at(std::span<const SpinPoint> path, double t);

/// What a spin correction did to the whole.
struct SpinCorrection {
  double period = 0.0;           ///< s, after the correction
  Vec3 momentum = Vec3::Zero();  ///< kg m^2/s, angular momentum added
  double work = 0.0;             ///< J
};

/// Adds the rigid rotation about the z axis through the members' mass centre that gives them the period
/// T = 2 pi I_zz / L_z exactly: dw x (X - X_cm) to velocities, I dw to spins. Members are bodies with a
/// non-zero mark.
SpinCorrection impose_period(Bodies& bodies, std::span<const std::uint8_t> members, double period);

}  // namespace cairn
