// The wrenches of bodies from those of their contacts and from what else acts on them.
#pragma once

#include <algorithm>

#include "body/bodies.h"
#include "contact/history.h"
#include "core/parallel.h"

namespace cairn {

/// Sets the bodies' wrenches to what others(b, count, force, torque) says for the `count` <= kLanes bodies
/// from b on, plus forces and torques of the last sweep, in the order of sphere ids. `then(begin, end)` goes
/// on with the bodies of a block while they are in the cache.
template <class Others, class Then>
void gather_wrenches(const ContactList& contacts, const Others& others, Bodies& bodies, const Then& then) {
  const Spheres& spheres = bodies.spheres;
  const std::vector<std::uint32_t>& earlier = contacts.earlier;
  const auto add_contacts = [&](std::size_t b, Vec3& force, Vec3& torque) {
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      WrenchShare sum = contacts.shares[contacts.share_of(s)];
      for (std::uint32_t k = contacts.earlier_begin[s]; k < contacts.earlier_begin[s + 1]; ++k) {
        constexpr std::size_t kAhead = 16;  // shares of other blocks are scattered in memory
        __builtin_prefetch(&contacts.shares[earlier[std::min(k + kAhead, earlier.size() - 1)]]);
        sum += contacts.shares[earlier[k]];
      }
      const Vec3 f(sum[0], sum[1], sum[2]);
      force += f;
      torque += Vec3(sum[4], sum[5], sum[6]) + (spheres.position[s] - bodies.position[b]).cross(f);
    }
  };
  parallel_blocks(bodies.size(), kBodyBlock, [&](std::size_t begin, std::size_t end) {
    Vec3 force[kLanes], torque[kLanes];
    for (std::size_t b = begin; b < end; b += kLanes) {
      const std::size_t count = std::min(kLanes, end - b);
      others(b, count, force, torque);
      for (std::size_t k = 0; k < count; ++k) {
        add_contacts(b + k, force[k], torque[k]);
        bodies.force[b + k] = force[k];
        bodies.torque[b + k] = torque[k];
      }
    }
    then(begin, end);
  });
}

}  // namespace cairn
