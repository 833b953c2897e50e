#include "contact/gather.h"

#include <algorithm>

namespace cairn {

namespace {

/// Adds the wrenches of contacts to those of bodies [begin, end).
template <bool balls>
void add_contacts(const ContactList& contacts, const WrenchShare* own, std::size_t begin, std::size_t end,
                  Bodies& bodies) {
  const Spheres& spheres = bodies.spheres;
  const std::vector<std::uint32_t>& earlier = contacts.earlier;
  for (std::size_t b = begin; b < end; ++b) {
    Vec3 force = bodies.force[b], torque = bodies.torque[b];
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      WrenchShare sum = *own++;
      for (std::uint32_t k = contacts.earlier_begin[s]; k < contacts.earlier_begin[s + 1]; ++k) {
        constexpr std::size_t kAhead = 16;  // shares of other blocks are scattered in memory
        __builtin_prefetch(&contacts.shares[earlier[std::min(k + kAhead, earlier.size() - 1)]]);
        sum += contacts.shares[earlier[k]];
      }
      const Vec3 f(sum[0], sum[1], sum[2]);
      force += f;
      torque += Vec3(sum[4], sum[5], sum[6]);
      if constexpr (!balls) torque += (spheres.position[s] - bodies.position[b]).cross(f);
    }
    bodies.force[b] = force;
    bodies.torque[b] = torque;
  }
}

}  // namespace

void BodyWork::before_contacts(Bodies& bodies, std::size_t begin, std::size_t end) const {
  for (std::size_t b = begin; b < end; ++b) {
    bodies.force[b].setZero();
    bodies.torque[b].setZero();
  }
}

void gather_block(const ContactList& contacts, std::size_t k, const std::vector<WrenchShare>& own,
                  const BodyWork& work, Bodies& bodies) {
  const ContactBlock &block = contacts.blocks[k], &next = contacts.blocks[k + 1];
  for (std::size_t begin = block.body; begin < next.body; begin += kBodyBlock) {
    const std::size_t end = std::min<std::size_t>(begin + kBodyBlock, next.body);
    work.before_contacts(bodies, begin, end);
    const WrenchShare* first = &own[bodies.first_sphere[begin] - block.sphere];
    if (block.balls)
      add_contacts<true>(contacts, first, begin, end, bodies);
    else
      add_contacts<false>(contacts, first, begin, end, bodies);
    work.after_contacts(bodies, begin, end);
  }
}

}  // namespace cairn
