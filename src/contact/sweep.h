// One pass over the candidate pairs: which touch, what force and couple they exert.
#pragma once

#include <algorithm>
#include <vector>

#include "contact/dashpots.h"
#include "contact/gather.h"
#include "contact/kinematics.h"
#include "core/vector.h"

namespace cairn {

/// What a sweep reports.
struct SweepReport {
  double dissipated = 0.0;     ///< J, lost in this step
  double overlap_ratio = 0.0;  ///< greatest overlap over the smaller radius of its pair

  SweepReport& operator+=(const SweepReport& other) {
    dissipated += other.dissipated;
    overlap_ratio = std::max(overlap_ratio, other.overlap_ratio);
    return *this;
  }
};

/// Evaluates every touching pair, histories in place, and sets the bodies' wrenches; `work` is done with them
/// on the way.
/// Two spheres with one centre have no normal: their overlap ratio is 2, the wrench meaningless.
SweepReport sweep(const std::vector<SphereMotion>& motions, const SweepSettings& settings,
                  ContactList& contacts, Bodies& bodies, const BodyWork& work = BodyWork());

/// The touching pair with the greatest overlap over its smaller radius; i == j when nothing touches.
Pair deepest_pair(const Bodies& bodies, const ContactList& contacts);

/// Gives the bodies the impulses of contacts that began or ended within the step of the last sweep.
void apply_partial_kicks(const ContactList& contacts, Bodies& bodies);

/// Calls give(sphere, impulse (N s), moment about its centre (N m s)) for both spheres of each of these
/// kicks, in their order.
template <class Give>
void for_each_kick(const ContactList& contacts, const Give& give) {
  for (const std::vector<PartialKick>& block : contacts.kicks)
    for (const PartialKick& kick : block) {
      const Vec3 impulse = vector(kick.impulse.force);
      give(kick.pair.i, impulse, vector(kick.impulse.torque_i));
      give(kick.pair.j, Vec3(-impulse), vector(kick.impulse.torque_j));
    }
}

/// Energy stored in all springs (J), at the spheres' present positions.
double stored_energy(const Bodies& bodies, const SweepSettings& settings, const ContactList& contacts);

}  // namespace cairn
