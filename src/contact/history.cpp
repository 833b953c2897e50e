#include "contact/history.h"

#include "core/error.h"

namespace cairn {

void ContactList::rebuild(std::vector<Pair>& pairs, std::size_t spheres, const Features& features) {
  const std::vector<ContactRecord> kept = records();
  pairs_.swap(pairs);
  features_ = features;
  const std::size_t n = pairs_.size();

  row_.assign(spheres + 1, 0);
  second_begin.assign(spheres + 1, 0);
  for (const Pair& p : pairs_) {
    ++row_[p.i + 1];
    ++second_begin[p.j + 1];
  }
  for (std::size_t s = 0; s < spheres; ++s) {
    row_[s + 1] += row_[s];
    second_begin[s + 1] += second_begin[s];
  }
  second.resize(n);
  std::vector<std::uint32_t> cursor(second_begin.begin(), second_begin.end() - 1);
  for (std::size_t slot = 0; slot < n; ++slot)
    second[cursor[pairs_[slot].j]++] = static_cast<std::uint32_t>(slot);

  c_n.assign(n, -1.0);
  c_s.assign(n, 0.0);
  for (int k = 0; k < 3; ++k) {
    slide[k].assign(features.tangential ? n : 0, 0.0);
    roll[k].assign(features.rolling ? n : 0, 0.0);
  }
  twist.assign(features.twisting ? n : 0, 0.0);
  wrench.assign(n, ContactWrench{});
  restore(kept);
}

void ContactList::set_shifts(bool any, const std::function<Vec3(const Pair&)>& shift_of) {
  for (std::vector<double>& component : shift) component.assign(any ? slots() : 0, 0.0);
  if (!any) return;
  bool needed = false;
  for (std::size_t slot = 0; slot < slots(); ++slot) {
    const Vec3 steps = shift_of(pairs_[slot]);
    for (std::size_t k = 0; k < 3; ++k) shift[k][slot] = steps[static_cast<int>(k)];
    needed |= steps != Vec3::Zero();
  }
  if (!needed)
    for (std::vector<double>& component : shift) component.clear();
}

ContactMemory<double> ContactList::memory(std::size_t slot) const {
  ContactMemory<double> m{};
  m.c_n = c_n[slot];
  m.c_s = c_s[slot];
  if (features_.tangential) m.slide = {slide[0][slot], slide[1][slot], slide[2][slot]};
  if (features_.rolling) m.roll = {roll[0][slot], roll[1][slot], roll[2][slot]};
  if (features_.twisting) m.twist = twist[slot];
  return m;
}

void ContactList::set_memory(std::size_t slot, const ContactMemory<double>& m) {
  c_n[slot] = m.c_n;
  c_s[slot] = m.c_s;
  const double s[3] = {m.slide.x, m.slide.y, m.slide.z}, r[3] = {m.roll.x, m.roll.y, m.roll.z};
  for (int k = 0; k < 3; ++k) {
    if (features_.tangential) slide[k][slot] = s[k];
    if (features_.rolling) roll[k][slot] = r[k];
  }
  if (features_.twisting) twist[slot] = m.twist;
}

void ContactList::release(std::size_t slot) {
  set_memory(slot, {.c_n = -1.0, .c_s = 0.0, .slide = {}, .roll = {}, .twist = 0.0});
  wrench[slot] = ContactWrench{};
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
