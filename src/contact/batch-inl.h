// Several contacts at once: their motions, springs and wrenches, from memory to registers and back.

#include <vector>

#include "contact/history.h"
#include "contact/kinematics.h"
#include "contact/law/law-inl.h"

#if defined(CAIRN_CONTACT_BATCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_CONTACT_BATCH_INL_H
#undef CAIRN_CONTACT_BATCH_INL_H
#else
#define CAIRN_CONTACT_BATCH_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {

/// The motions of kLanes spheres, transposed.
struct MotionBatch {
  Triple<Batch> position, velocity_mid, spin_mid, velocity, spin;
  Batch radius;
};

CAIRN_INLINE MotionBatch load_motions(const std::vector<SphereMotion>& motions,
                                      const std::uint32_t (&index)[kLanes]) {
  const double *low[kLanes], *high[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) {
    low[l] = motions[index[l]].position;
    high[l] = low[l] + 8;
  }
  Batch a[8], b[8];
  load_transposed(low, a);
  load_transposed(high, b);
  return {.position = {a[0], a[1], a[2]},
          .velocity_mid = {a[4], a[5], a[6]},
          .spin_mid = {a[7], b[0], b[1]},
          .velocity = {b[2], b[3], b[4]},
          .spin = {b[5], b[6], b[7]},
          .radius = a[3]};
}

/// The slots of kLanes contacts; in a quiet packing they usually follow each other.
struct Slots {
  std::uint32_t index[kLanes];
  bool consecutive;

  std::uint32_t operator[](std::size_t lane) const { return index[lane]; }
};

CAIRN_INLINE Batch gather(const std::vector<double>& from, const Slots& slot) {
  if (slot.consecutive) return Batch::load(&from[slot[0]]);
  Lanes out;
  for (std::size_t l = 0; l < kLanes; ++l) out[l] = from[slot[l]];
  return out.batch();
}

/// The springs of kLanes contacts; what F lacks is neither read nor written.
template <Features F>
CAIRN_INLINE void load_springs(const ContactList& contacts, const Slots& slot, ContactMemory<Batch>& m) {
  const double* rows[kLanes];
  Batch a[4];
  if constexpr (F.tangential) {
    for (std::size_t l = 0; l < kLanes; ++l) rows[l] = contacts.slide[slot[l]].length;
    load_transposed(rows, a);
    m.slide = {a[0], a[1], a[2]};
    m.c_s = a[3];
  }
  if constexpr (F.rolling || F.twisting) {
    for (std::size_t l = 0; l < kLanes; ++l) rows[l] = contacts.turn[slot[l]].roll;
    load_transposed(rows, a);
    m.roll = {a[0], a[1], a[2]};
    m.twist = a[3];
  }
}

template <Features F>
CAIRN_INLINE void store_springs(ContactList& contacts, const Slots& slot, const ContactMemory<Batch>& m) {
  double* rows[kLanes];
  if constexpr (F.tangential) {
    for (std::size_t l = 0; l < kLanes; ++l) rows[l] = contacts.slide[slot[l]].length;
    store_transposed({m.slide.x, m.slide.y, m.slide.z, m.c_s}, rows);
  }
  if constexpr (F.rolling || F.twisting) {
    for (std::size_t l = 0; l < kLanes; ++l) rows[l] = contacts.turn[slot[l]].roll;
    store_transposed({m.roll.x, m.roll.y, m.roll.z, m.twist}, rows);
  }
}

/// Wrenches of kLanes contacts on their spheres i, and less those on j.
struct WrenchBatch {
  Triple<Batch> force, torque_i, less_torque_j;

  /// That of each contact.
  CAIRN_INLINE void write(ContactWrench (&to)[kLanes]) const {
    const auto put = [](const Triple<Batch>& t, double sign, std::size_t l, double(&out)[3]) HWY_ATTR {
      out[0] = sign * Lanes(t.x)[l];
      out[1] = sign * Lanes(t.y)[l];
      out[2] = sign * Lanes(t.z)[l];
    };
    for (std::size_t l = 0; l < kLanes; ++l) {
      put(force, 1.0, l, to[l].force);
      put(torque_i, 1.0, l, to[l].torque_i);
      put(less_torque_j, -1.0, l, to[l].torque_j);
    }
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#endif
