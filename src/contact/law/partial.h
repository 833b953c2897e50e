// The two steps that a contact shares with its absence. Leapfrog gives a force half a step on either side of
// its evaluation; but a dashpot and cohesion jump at first touch and at parting, somewhere within a step. The
// impulses here make up the difference to the part of the step for which the contact was there; without them
// restitution depends on the phase of the step at first touch (0.548-0.561 for 0.55 at 50 steps a contact).
#pragma once

#include "contact/law/law.h"

namespace cairn {

/// How long before the end of the step the surfaces met (s), from the overlap (m), the normal velocity in
/// mid-step (m/s) and the step dt (s): dt where they are not moving against each other.
template <class T>
CAIRN_INLINE T age(T overlap, T u_n_mid, T dt) {
  const T speed = abs(u_n_mid);
  const auto moving = speed > T(0.0);
  return select(moving, min(dt, overlap / select(moving, speed, T(1.0))), dt);
}

/// First touch, `age` before the end of the step: the wrench evaluated at the end is to be given for
/// `wrench` seconds more than the closing half kick gives it, and i is to get the impulse `normal` (N s)
/// along n, because the spring has grown from nothing.
template <class T>
struct FirstTouch {
  T wrench, normal;
};
template <class T>
CAIRN_INLINE FirstTouch<T> first_touch(T k_n, T overlap, T age, T dt) {
  return {age - T(0.5) * dt, T(0.5) * age * k_n * overlap};
}

/// Parting within the step, which ends with a gap (m) that opens at u_n_mid > 0 (m/s).
struct Parting {
  double normal;      ///< N s, impulse on i along n beyond the opening half kick
  double dissipated;  ///< J, by the dashpot before the end
};
template <Features F>
Parting parting(const LawConstants<double>& law, double c_n, double radius, double gap, double u_n_mid,
                double dt) {
  if (!(u_n_mid > 0.0)) return {0.0, 0.0};
  const double after = min(dt, gap / u_n_mid), before = dt - after;
  double jump = c_n * u_n_mid;
  if constexpr (F.cohesion) jump += law.cohesion * radius * radius;
  return {(before - 0.5 * dt) * jump + 0.5 * law.k_n * u_n_mid * before * after,
          c_n * u_n_mid * u_n_mid * before};
}

}  // namespace cairn
