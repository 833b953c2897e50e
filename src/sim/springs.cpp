#include "sim/springs.h"

namespace cairn {

namespace {

/// k_S / k_N of a pair over that of most; exactly 1 where the pair is one of these.
double tangential_share(const PairLaw& law) {
  return law.k_s / (kTangentialRatio * law.k_n);
}

/// Multiplies the springs that k_N bears (rolling) and that k_S bears (sliding, twisting).
void stretch(ContactMemory<double>& memory, double normal, double tangential) {
  memory.roll = normal * memory.roll;
  memory.slide = tangential * memory.slide;
  memory.twist *= tangential;
}

/// Calls visit(law, memory) for each contact.
template <class Visit>
void for_each_contact(const Physics& physics, const Bodies& bodies, std::vector<ContactRecord>& contacts,
                      std::vector<WallContact>& walls, Visit&& visit) {
  const SweepSettings& settings = physics.contacts;
  if (settings.laws.empty() || !(physics.k_n > 0.0)) return;  // nothing has touched
  for (ContactRecord& c : contacts) visit(settings.law(bodies, {c.i, c.j}), c.memory);
  for (WallContact& c : walls) {
    const Material& of_body = physics.materials[settings.material[bodies.spheres.body[c.sphere]]];
    visit(make_pair_law(physics.wall_materials[c.wall], of_body, physics.k_n), c.memory);
  }
}

}  // namespace

void leave_stiffness(const Physics& physics, const Bodies& bodies, std::vector<ContactRecord>& contacts,
                     std::vector<WallContact>& walls) {
  for_each_contact(physics, bodies, contacts, walls, [&](const PairLaw& law, ContactMemory<double>& memory) {
    const double ratio = law.k_n / physics.k_n;
    stretch(memory, ratio, ratio * tangential_share(law));
  });
}

void enter_stiffness(const Physics& physics, const Bodies& bodies, double k_n,
                     std::vector<ContactRecord>& contacts, std::vector<WallContact>& walls) {
  for_each_contact(physics, bodies, contacts, walls, [&](const PairLaw& law, ContactMemory<double>& memory) {
    enter_stiffness(law, k_n, memory);
  });
}

void enter_stiffness(const PairLaw& law, double k_n, ContactMemory<double>& memory) {
  const double ratio = k_n / law.k_n;
  stretch(memory, ratio, ratio / tangential_share(law));
}

}  // namespace cairn
