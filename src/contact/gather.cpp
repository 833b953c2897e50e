#include "contact/gather.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/gather.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>

#include "core/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {
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
      Octet sum = Octet::load((own++)->v);
      for (std::uint32_t k = contacts.earlier_begin[s]; k < contacts.earlier_begin[s + 1]; ++k) {
        constexpr std::size_t kAhead = 16;  // shares of other blocks are scattered in memory
        __builtin_prefetch(&contacts.shares[earlier[std::min(k + kAhead, earlier.size() - 1)]]);
        sum = sum + Octet::load(contacts.shares[earlier[k]].v);
      }
      WrenchShare total;
      sum.store(total.v);
      const Vec3 f(total.v[0], total.v[1], total.v[2]);
      force += f;
      torque += Vec3(total.v[4], total.v[5], total.v[6]);
      if constexpr (!balls) torque += (spheres.position[s] - bodies.position[b]).cross(f);
    }
    bodies.force[b] = force;
    bodies.torque[b] = torque;
  }
}

}  // namespace

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

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn {

HWY_EXPORT(gather_block);

void BodyWork::before_contacts(Bodies& bodies, std::size_t begin, std::size_t end) const {
  for (std::size_t b = begin; b < end; ++b) {
    bodies.force[b].setZero();
    bodies.torque[b].setZero();
  }
}

void gather_block(const ContactList& contacts, std::size_t k, const std::vector<WrenchShare>& own,
                  const BodyWork& work, Bodies& bodies) {
  HWY_DYNAMIC_DISPATCH(gather_block)(contacts, k, own, work, bodies);
}

}  // namespace cairn
#endif
