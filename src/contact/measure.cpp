#include "contact/law/law-inl.h"
#include "contact/sweep.h"
#include "core/parallel.h"
#include "core/vector.h"

namespace cairn {

using namespace HWY_NAMESPACE;

Pair deepest_pair(const Bodies& bodies, const ContactList& contacts) {
  const Spheres& spheres = bodies.spheres;
  Pair deepest{0, 0};
  double ratio = 0.0;
  for (std::size_t slot = 0; slot < contacts.slots(); ++slot) {
    const Pair& p = contacts.pair(slot);
    const double ri = spheres.radius[p.i], rj = spheres.radius[p.j];
    const double overlap = ri + rj - contacts.separation(spheres, slot).norm();
    if (overlap > ratio * std::min(ri, rj)) {
      ratio = overlap / std::min(ri, rj);
      deepest = p;
    }
  }
  return deepest;
}

void apply_partial_kicks(const ContactList& contacts, Bodies& bodies) {
  const Spheres& spheres = bodies.spheres;
  for_each_kick(contacts, [&](std::uint32_t s, const Vec3& impulse, const Vec3& moment) {
    const std::uint32_t b = spheres.body[s];
    bodies.velocity[b] += impulse / bodies.mass[b];
    bodies.spin[b] += moment + (spheres.position[s] - bodies.position[b]).cross(impulse);
  });
}

double stored_energy(const Bodies& bodies, const SweepSettings& settings, const ContactList& contacts) {
  const Spheres& spheres = bodies.spheres;
  return with_features(settings.features, [&]<Features F>() {
    // By blocks, which do not depend on the candidates: these are others after a restart.
    return parallel_block_sum(contacts.block_count(), 1, 0.0, [&](std::size_t k, std::size_t) {
      double energy = 0.0;
      for (std::uint32_t slot = contacts.blocks[k].slot; slot < contacts.blocks[k + 1].slot; ++slot) {
        if (!contacts.touching(slot)) continue;
        const Pair& p = contacts.pair(slot);
        const double ri = spheres.radius[p.i], rj = spheres.radius[p.j];
        const double overlap = ri + rj - contacts.separation(spheres, slot).norm();
        energy += stored_energy<F>(LawConstants<double>(settings.law(bodies, p)), overlap,
                                   ri * rj / (ri + rj), contacts.memory(slot));
      }
      return energy;
    });
  });
}

}  // namespace cairn
