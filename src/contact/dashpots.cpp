#include "contact/dashpots.h"

#include <cmath>

namespace cairn {

Inertia inertia_of(const Bodies& bodies, std::size_t b) {
  if (is_held(bodies, b)) return {};
  return {1.0 / bodies.mass[b], inverse_inertia(bodies, b)};
}

EffectiveMass effective_mass(const Bodies& bodies, const ContactList& contacts, std::size_t slot) {
  const Spheres& spheres = bodies.spheres;
  const Pair& pair = contacts.pair(slot);
  const std::uint32_t bi = spheres.body[pair.i], bj = spheres.body[pair.j];
  const Vec3 d = contacts.separation(spheres, slot);
  const double distance = d.norm();
  const Vec3 n = d / distance;
  const double ri = spheres.radius[pair.i], rj = spheres.radius[pair.j];
  const double lever = 0.5 * (distance + (ri - rj) * (ri + rj) / distance);
  const Vec3 arm_i = spheres.position[pair.i] - bodies.position[bi] + lever * n;
  const Vec3 arm_j = spheres.position[pair.j] - bodies.position[bj] - (distance - lever) * n;
  return effective_mass(inertia_of(bodies, bi), arm_i, inertia_of(bodies, bj), arm_j, n);
}

double set_damping(const Bodies& bodies, const SweepSettings& settings, ContactList& contacts,
                   std::size_t slot) {
  const Spheres& spheres = bodies.spheres;
  const Pair& pair = contacts.pair(slot);
  const PairLaw& law = settings.law(bodies, pair);
  const EffectiveMass mass = effective_mass(bodies, contacts, slot);
  EffectiveMass mu = mass;
  if (settings.sphere_damping) {
    const auto mobility = [&](std::uint32_t s) {
      return is_held(bodies, spheres.body[s]) ? 0.0 : 1.0 / spheres.mass[s];
    };
    mu.normal = 1.0 / (mobility(pair.i) + mobility(pair.j));
    mu.tangential = kTangentialRatio * mu.normal;
  }
  contacts.c_n[slot] = law.damping_n * std::sqrt(law.k_n * mu.normal);
  if (settings.features.tangential)
    contacts.slide[slot].c_s = law.damping_s * std::sqrt(law.k_s * mu.tangential);
  return mass.normal;
}

bool carry_damping(const PairLaw& before, const PairLaw& now, double& c_n, double& c_s) {
  const auto is_told = [](double damping_before, double damping) {
    return damping_before > 0.0 || damping == 0.0;
  };
  if (!is_told(before.damping_n, now.damping_n) || !is_told(before.damping_s, now.damping_s)) return false;
  const auto carry = [](double& c, double damping_before, double k_before, double damping, double k) {
    if (damping_before == damping && k_before == k) return;
    c = damping > 0.0 ? c * (damping / damping_before * std::sqrt(k / k_before)) : 0.0;
  };
  carry(c_n, before.damping_n, before.k_n, now.damping_n, now.k_n);
  carry(c_s, before.damping_s, before.k_s, now.damping_s, now.k_s);
  return true;
}

bool same_masses(const SweepSettings& before, const SweepSettings& now) {
  return before.sphere_damping == now.sphere_damping &&
         (before.features.tangential || !now.features.tangential);  // otherwise c_s has not been kept
}

void renew_damping(const Bodies& bodies, const SweepSettings* before, const SweepSettings& settings,
                   ContactList& contacts) {
  const bool known = before != nullptr && same_masses(*before, settings);
  for (std::size_t slot = 0; slot < contacts.slots(); ++slot) {
    if (!contacts.touching(slot)) continue;
    const Pair& pair = contacts.pair(slot);
    double unused = 0.0;
    if (!known || !carry_damping(before->law(bodies, pair), settings.law(bodies, pair), contacts.c_n[slot],
                                 settings.features.tangential ? contacts.slide[slot].c_s : unused))
      set_damping(bodies, settings, contacts, slot);
  }
}

}  // namespace cairn
