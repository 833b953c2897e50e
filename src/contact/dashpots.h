// Effective masses of touching pairs, and the dashpot constants that follow from them.
#pragma once

#include "contact/history.h"
#include "contact/settings.h"

namespace cairn {

/// How body b gives way: a held one does not.
Inertia inertia_of(const Bodies& bodies, std::size_t b);

/// Effective masses (kg) of the bodies of a pair at its contact, at the present poses.
EffectiveMass effective_mass(const Bodies& bodies, const ContactList& contacts, std::size_t slot);

/// Sets the dashpot constants of a pair from its effective masses at the present poses. Returns the one along
/// the normal (kg).
double set_damping(const Bodies& bodies, const SweepSettings& settings, ContactList& contacts,
                   std::size_t slot);

/// Makes the dashpot constants of a contact those of another law at the same effective masses, which are kept
/// from first touch on. Returns false, and changes nothing, where the law `before` does not tell them.
bool carry_damping(const PairLaw& before, const PairLaw& now, double& c_n, double& c_s);
/// Whether dashpots under both settings have the same effective masses.
bool same_masses(const SweepSettings& before, const SweepSettings& now);

/// Dashpot constants of all touching pairs as a stage begins; `before`: the settings of the one that the
/// contacts come from, null where bodies may have changed since.
void renew_damping(const Bodies& bodies, const SweepSettings* before, const SweepSettings& settings,
                   ContactList& contacts);

}  // namespace cairn
