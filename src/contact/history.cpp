#include "contact/history.h"

#include <algorithm>

#include "core/error.h"

namespace cairn {

void ContactList::rebuild(std::vector<Pair>& pairs, std::size_t spheres, const Features& features) {
  const std::vector<ContactRecord> kept = records();
  pairs_.swap(pairs);
  features_ = features;
  const std::size_t n = pairs_.size();

  row_.assign(spheres + 1, 0);
  for (const Pair& p : pairs_) ++row_[p.i + 1];
  for (std::size_t s = 0; s < spheres; ++s) row_[s + 1] += row_[s];
  set_shares(spheres);

  c_n.assign(n, -1.0);
  springs.assign(features.tangential ? n : 0, ContactSprings{});
  restore(kept);
}

void ContactList::set_shares(std::size_t spheres) {
  share_of_j.resize(slots());
  first_share.clear();
  earlier_begin.assign(spheres + 1, 0);
  std::uint32_t share = 0;
  for (std::size_t begin = 0; begin < spheres; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, spheres);
    const std::uint32_t first = share;
    first_share.push_back(first);
    share += static_cast<std::uint32_t>(end - begin);
    for (std::uint32_t slot = row_[begin]; slot < row_[end]; ++slot) {
      const std::uint32_t j = pairs_[slot].j;
      const bool inside = j < end;
      share_of_j[slot] = inside ? first + j - static_cast<std::uint32_t>(begin) : share++;
      earlier_begin[j + 1] += !inside;
    }
  }
  first_share.push_back(share);
  shares.assign(share, WrenchShare(0.0));
  for (std::size_t s = 0; s < spheres; ++s) earlier_begin[s + 1] += earlier_begin[s];
  earlier.resize(earlier_begin[spheres]);
  std::vector<std::uint32_t> cursor(earlier_begin.begin(), earlier_begin.end() - 1);
  for (std::size_t slot = 0; slot < slots(); ++slot) {
    const Pair& p = pairs_[slot];
    if (p.i / kBlock != p.j / kBlock) earlier[cursor[p.j]++] = share_of_j[slot];
  }
}

void ContactList::set_shifts(bool any, const std::function<Vec3(const Pair&)>& shift_of) {
  shift.assign(any ? slots() : 0, {});
  is_shifted.assign(shift.size(), 0);
  bool needed = false;
  for (std::size_t slot = 0; slot < shift.size(); ++slot) {
    const Vec3 steps = shift_of(pairs_[slot]);
    shift[slot] = {steps.x(), steps.y(), steps.z()};
    is_shifted[slot] = steps != Vec3::Zero();
    needed |= is_shifted[slot] != 0;
  }
  if (needed) return;
  shift.clear();
  is_shifted.clear();
}

ContactMemory<double> ContactList::memory(std::size_t slot) const {
  ContactMemory<double> m{};
  m.c_n = c_n[slot];
  if (!features_.tangential) return m;
  const ContactSprings& s = springs[slot];
  m.c_s = s.c_s;
  m.slide = {s.slide[0], s.slide[1], s.slide[2]};
  if (features_.rolling) m.roll = {s.roll[0], s.roll[1], s.roll[2]};
  if (features_.twisting) m.twist = s.twist;
  return m;
}

void ContactList::set_memory(std::size_t slot, const ContactMemory<double>& m) {
  c_n[slot] = m.c_n;
  if (!features_.tangential) return;
  ContactSprings& s = springs[slot];
  s = {.slide = {m.slide.x, m.slide.y, m.slide.z}, .c_s = m.c_s, .roll = {}, .twist = 0.0};
  if (features_.rolling) s.roll[0] = m.roll.x, s.roll[1] = m.roll.y, s.roll[2] = m.roll.z;
  if (features_.twisting) s.twist = m.twist;
}

void ContactList::release(std::size_t slot) {
  set_memory(slot, {.c_n = -1.0, .c_s = 0.0, .slide = {}, .roll = {}, .twist = 0.0});
}

std::vector<ContactRecord> ContactList::records() const {
  std::vector<ContactRecord> out;
  for (std::size_t slot = 0; slot < slots(); ++slot)
    if (touching(slot)) out.push_back({pairs_[slot].i, pairs_[slot].j, memory(slot)});
  return out;
}

void ContactList::restore(const std::vector<ContactRecord>& records) {
  std::size_t slot = 0;
  for (const ContactRecord& record : records) {
    while (slot < slots() && (pairs_[slot].i != record.i || pairs_[slot].j != record.j)) ++slot;
    if (slot == slots())
      throw InputError("contact of spheres {} and {}: not a pair of neighbours in this order", record.i,
                       record.j);
    set_memory(slot, record.memory);
  }
}

}  // namespace cairn
