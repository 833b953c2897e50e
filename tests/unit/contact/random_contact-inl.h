// Contacts in random states, for tests of the law.

#include "contact/law/law-inl.h"
#include "core/random.h"
#include "core/vector.h"

#if defined(CAIRN_TEST_RANDOM_CONTACT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_TEST_RANDOM_CONTACT_INL_H
#undef CAIRN_TEST_RANDOM_CONTACT_INL_H
#else
#define CAIRN_TEST_RANDOM_CONTACT_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {

/// One state of a contact: everything `evaluate` takes.
struct State {
  ContactGeometry<double> geometry;
  ContactMotion<double> motion;
  ContactMemory<double> memory;
};

inline Vec3 flat(const Vec3& v, const Vec3& n) {
  return v - v.dot(n) * n;
}

/// A pressed contact with springs both within and beyond their limits.
inline State random_state(Random& random) {
  const Vec3 n = random.direction(), n_mid = (n + 1e-3 * random.in_ball()).normalized();
  const double reach = random.uniform(0.0, 5e-3);
  State s;
  s.geometry = {triple(n), triple(n_mid), random.uniform(1e-4, 2e-3), random.uniform(0.3, 0.7),
                random.uniform(-0.2, 0.2)};
  s.motion = {triple(0.2 * random.in_ball()), triple(random.in_ball()), triple(0.2 * random.in_ball()),
              triple(random.in_ball()),       triple(random.in_ball()), random.uniform(1e-4, 1e-3)};
  s.memory = {random.uniform(0.0, 3e3), random.uniform(0.0, 2e3),
              triple(reach * flat(random.in_ball(), n_mid)), triple(reach * flat(random.in_ball(), n_mid)),
              random.uniform(-reach, reach)};
  return s;
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#endif
