// Wrenches of bodies on which only their contacts act.
#pragma once

#include "contact/gather.h"

namespace cairn {

/// gather_wrenches where nothing else acts.
inline void gather_contacts(const ContactList& contacts, Bodies& bodies) {
  gather_wrenches(
      contacts,
      [](std::size_t, std::size_t count, Vec3* force, Vec3* torque) {
        std::fill_n(force, count, Vec3::Zero());
        std::fill_n(torque, count, Vec3::Zero());
      },
      bodies, [](std::size_t, std::size_t) {});
}

}  // namespace cairn
