// Constants of a pair of materials, and the effective masses of two bodies at a contact.
#pragma once

#include <vector>

#include "contact/law/features.h"
#include "contact/law/material.h"
#include "contact/law/memory.h"
#include "core/math.h"

namespace cairn {

/// C / sqrt(k mu) of a dashpot with restitution e: -2 ln e / sqrt(pi^2 + ln^2 e) [Schwartz et al. 2012];
/// e = 0 is critical damping (2): such a contact ends only when other forces pull the surfaces apart.
double damping_ratio(double restitution);

/// Constants of the pair (a, b) where a material without a stiffness of its own has k_n (N/m). A material's
/// stiffness is that of two such surfaces; those of a pair act in series, k = 2 / (1/k_a + 1/k_b), k_S too.
PairLaw make_pair_law(const Material& a, const Material& b, double k_n);

/// What the contacts between these materials need.
Features required_features(const std::vector<Material>& materials, bool zhang_slip);

/// One side of a contact. `inverse_inertia` in the space frame; a wall has all zeros.
struct Inertia {
  double inverse_mass = 0.0;            ///< 1/kg
  Mat3 inverse_inertia = Mat3::Zero();  ///< 1/(kg m^2)
};

/// Normal and mean tangential effective mass (kg) of two bodies at a contact with unit normal n and lever
/// arms a, b from their centres of mass: 1/mu(e) = sum of 1/M + (a x e).I^-1 (a x e), mu_t = 2 / trace in the
/// plane.
struct EffectiveMass {
  double normal, tangential;
};
EffectiveMass effective_mass(const Inertia& i, const Vec3& arm_i, const Inertia& j, const Vec3& arm_j,
                             const Vec3& n);

}  // namespace cairn
