#include "contact/history.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace cairn {

namespace {

constexpr double kNoMargin = -std::numeric_limits<double>::min();  // in place of c_n

}  // namespace

void ContactList::rebuild(std::vector<Pair>& pairs, std::size_t spheres, const Features& features) {
  pairs_.swap(pairs);  // `pairs` are the former ones now
  features_ = features;
  moved.assign(spheres, std::numeric_limits<float>::infinity());

  row_.assign(spheres + 1, 0);
  for (const Pair& p : pairs_) ++row_[p.i + 1];
  for (std::size_t s = 0; s < spheres; ++s) row_[s + 1] += row_[s];
  set_shares(spheres);

  std::vector<std::uint32_t> from, to;  // slots of the touching pairs
  std::size_t slot = 0;
  for (std::size_t former = 0; former < c_n.size(); ++former) {
    if (!touching(former)) continue;
    slot = find_from(slot, pairs[former]);
    from.push_back(static_cast<std::uint32_t>(former));
    to.push_back(static_cast<std::uint32_t>(slot));
  }
  // One column after the other, so that there is only one of them twice.
  const auto carry = [&]<class T>(std::vector<T>& column, bool needed, const T& none) {
    const std::vector<T> former = std::exchange(column, std::vector<T>(needed ? slots() : 0, none));
    if (!former.empty() && needed)
      for (std::size_t k = 0; k < to.size(); ++k) column[to[k]] = former[from[k]];
  };
  carry(c_n, true, kNoMargin);
  carry(slide, features.tangential, SlideSpring{});
  carry(turn, features.rolling || features.twisting, TurnSpring{});
}

std::size_t ContactList::find_from(std::size_t slot, const Pair& pair) const {
  while (slot < slots() && pairs_[slot] != pair) ++slot;
  if (slot == slots())
    throw InputError("contact of spheres {} and {}: not a pair of neighbours in this order", pair.i, pair.j);
  return slot;
}

void ContactList::set_shares(std::size_t spheres) {
  block_bits_ = std::clamp(static_cast<unsigned>(std::bit_width(spheres / 8)), 9u, 11u) - 1;
  share_of_j.resize(slots());
  first_share.clear();
  earlier_begin.assign(spheres + 1, 0);
  std::vector<std::uint32_t> share_outside(spheres, 0);  // of a sphere, in the last block that has one for it
  struct Outside {
    std::uint32_t sphere, share;
  };
  std::vector<Outside> outside;  // all such shares, in order
  std::uint32_t share = 0;
  for (std::size_t begin = 0; begin < spheres; begin += block()) {
    const std::size_t end = std::min(begin + block(), spheres);
    const std::uint32_t first = share;
    first_share.push_back(first);
    share += static_cast<std::uint32_t>(end - begin);
    for (std::uint32_t slot = row_[begin]; slot < row_[end]; ++slot) {
      const std::uint32_t j = pairs_[slot].j;
      if (j < end) {
        share_of_j[slot] = first + j - static_cast<std::uint32_t>(begin);
        continue;
      }
      if (share_outside[j] <= first) {
        share_outside[j] = share++;
        outside.push_back({j, share_outside[j]});
        ++earlier_begin[j + 1];
      }
      share_of_j[slot] = share_outside[j];
    }
  }
  first_share.push_back(share);
  shares.assign(share, WrenchShare(0.0));
  for (std::size_t s = 0; s < spheres; ++s) earlier_begin[s + 1] += earlier_begin[s];
  earlier.resize(earlier_begin[spheres]);
  std::vector<std::uint32_t> cursor(earlier_begin.begin(), earlier_begin.end() - 1);
  for (const auto& [sphere, share_there] : outside) earlier[cursor[sphere]++] = share_there;
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

void ContactList::set_margins(const Spheres& spheres) {
  constexpr double kCaution = 0.9;  // places and displacements are rounded
  parallel_for(slots(), [&](std::size_t slot) {
    if (touching(slot)) return;
    const Pair& p = pairs_[slot];
    const double distance = (spheres.position[p.j] - spheres.position[p.i] + shift_of(slot)).norm();
    const double gap = kCaution * (distance - spheres.radius[p.i] - spheres.radius[p.j]);
    if (gap > 0.0) c_n[slot] = std::min(-0.5 * gap * gap, kNoMargin);  // (a + b)^2 <= 2 (a^2 + b^2)
  });
}

ContactMemory<double> ContactList::memory(std::size_t slot) const {
  ContactMemory<double> m{};
  m.c_n = c_n[slot];
  if (!slide.empty()) {
    const SlideSpring& s = slide[slot];
    m.c_s = s.c_s;
    m.slide = {s.length[0], s.length[1], s.length[2]};
  }
  if (!turn.empty()) {
    const TurnSpring& t = turn[slot];
    if (features_.rolling) m.roll = {t.roll[0], t.roll[1], t.roll[2]};
    if (features_.twisting) m.twist = t.twist;
  }
  return m;
}

void ContactList::set_memory(std::size_t slot, const ContactMemory<double>& m) {
  c_n[slot] = m.c_n;
  if (!slide.empty()) slide[slot] = {.length = {m.slide.x, m.slide.y, m.slide.z}, .c_s = m.c_s};
  if (!turn.empty()) {
    TurnSpring& t = turn[slot] = {};
    if (features_.rolling) t.roll[0] = m.roll.x, t.roll[1] = m.roll.y, t.roll[2] = m.roll.z;
    if (features_.twisting) t.twist = m.twist;
  }
}

void ContactList::release(std::size_t slot) {
  set_memory(slot, {.c_n = kNoMargin, .c_s = 0.0, .slide = {}, .roll = {}, .twist = 0.0});
}

std::size_t ContactList::contacts() const {
  return static_cast<std::size_t>(std::count_if(c_n.begin(), c_n.end(), [](double c) { return c >= 0.0; }));
}

std::vector<ContactRecord> ContactList::records() const {
  std::vector<ContactRecord> out;
  out.reserve(contacts());
  for (std::size_t slot = 0; slot < slots(); ++slot)
    if (touching(slot)) out.push_back(record(slot));
  return out;
}

void ContactList::restore(const std::vector<ContactRecord>& records) {
  std::size_t slot = 0;
  for (const ContactRecord& record : records) {
    slot = find_from(slot, {record.i, record.j});
    set_memory(slot, record.memory);
  }
}

}  // namespace cairn
