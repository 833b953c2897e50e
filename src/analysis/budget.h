// The conserved quantities of a scene, and the scales against which their drift is judged.
#pragma once

#include "body/bodies.h"

namespace cairn {

/// Totals over all bodies that are not held (compensated sums, in a fixed order).
struct Budget {
  double mass = 0.0;                                  ///< kg
  Vec3 center = Vec3::Zero();                         ///< m, centre of mass, from the frame's zero
  Vec3 momentum = Vec3::Zero();                       ///< kg m/s
  Vec3 angular_momentum_about_origin = Vec3::Zero();  ///< kg m^2/s, orbital and spins
  Vec3 angular_momentum_about_center = Vec3::Zero();  ///< kg m^2/s, in the frame of the centre of mass
  double momentum_scale = 0.0;                        ///< kg m/s, sum |P_b|
  double angular_scale_about_origin = 0.0;            ///< kg m^2/s, sum |X_b x P_b| + |spin_b|
  double angular_scale_about_center = 0.0;  ///< kg m^2/s, the same in the frame of the centre of mass
  double translational_energy = 0.0;        ///< J, sum M V^2 / 2
  double rotational_energy = 0.0;           ///< J, sum L.w / 2 of the bodies' spins
};

/// Totals; all zero for no bodies.
Budget budget(const Bodies& bodies);

/// Mass (kg) of the bodies that are held.
double held_mass(const Bodies& bodies);

}  // namespace cairn
