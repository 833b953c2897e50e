#include "contact/history.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace cairn {

namespace {

constexpr double kNoMargin = -std::numeric_limits<double>::min();  // in place of c_n

}  // namespace

std::size_t ContactList::block_size(std::size_t spheres) {
  return std::size_t{1} << (std::clamp(static_cast<unsigned>(std::bit_width(spheres / 8)), 9u, 11u) - 1);
}

void ContactList::rebuild(std::vector<Pair>& pairs, const Bodies& bodies, const Features& features) {
  pairs_.swap(pairs);  // `pairs` are the former ones now
  features_ = features;
  moved.assign(bodies.spheres.size(), std::numeric_limits<float>::infinity());
  set_blocks(bodies);
  set_shares();

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

void ContactList::set_blocks(const Bodies& bodies) {
  const std::size_t size = block_size(bodies.spheres.size());
  const std::vector<std::uint32_t>& first_sphere = bodies.first_sphere;
  blocks.clear();
  std::uint32_t body = 0, slot = 0;
  const auto add = [&] {
    while (slot < slots() && pairs_[slot].i < first_sphere[body]) ++slot;
    blocks.push_back(
        {.body = body, .sphere = first_sphere[body], .slot = slot, .share = 0, .source = 0, .balls = true});
  };
  add();
  while (body < bodies.size()) {
    ContactBlock& block = blocks.back();
    for (; body < bodies.size() && first_sphere[body] < block.sphere + size; ++body)
      block.balls &= is_ball(bodies, body);
    add();
  }
}

void ContactList::set_shares() {
  const std::uint32_t spheres = blocks.back().sphere;
  share_of_j.resize(slots());
  sources.clear();
  earlier_begin.assign(spheres + 1, 0);
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  struct Outside {
    std::uint32_t block, share;
  };
  std::vector<Outside> latest(spheres, {kNone, 0});  // of a sphere, the last block that has a share for it
  struct Share {
    std::uint32_t sphere, block;
  };
  std::vector<Share> outside;
  for (std::uint32_t k = 0; k < block_count(); ++k) {
    const ContactBlock &block = blocks[k], &next = blocks[k + 1];
    const std::uint32_t own = next.sphere - block.sphere;
    for (std::uint32_t slot = block.slot; slot < next.slot; ++slot) {
      const std::uint32_t j = pairs_[slot].j;
      if (j < next.sphere) {
        share_of_j[slot] = j - block.sphere;
        continue;
      }
      if (latest[j].block != k) {
        latest[j] = {k, static_cast<std::uint32_t>(outside.size())};
        outside.push_back({j, k});
        ++earlier_begin[j + 1];
      }
      share_of_j[slot] = own + latest[j].share - block.share;
    }
    blocks[k + 1].share = static_cast<std::uint32_t>(outside.size());
  }
  give_back(latest);
  shares.assign(outside.size(), WrenchShare{});
  for (std::size_t s = 0; s < spheres; ++s) earlier_begin[s + 1] += earlier_begin[s];
  earlier.resize(outside.size());
  std::vector<std::uint32_t> cursor(earlier_begin.begin(), earlier_begin.end() - 1);
  for (std::uint32_t share = 0; share < outside.size(); ++share)
    earlier[cursor[outside[share].sphere]++] = share;
  for (std::uint32_t k = 0; k < block_count(); ++k) {
    const auto first = static_cast<std::ptrdiff_t>(sources.size());
    for (std::uint32_t e = earlier_begin[blocks[k].sphere]; e < earlier_begin[blocks[k + 1].sphere]; ++e)
      sources.push_back(outside[earlier[e]].block);
    std::sort(sources.begin() + first, sources.end());
    sources.erase(std::unique(sources.begin() + first, sources.end()), sources.end());
    blocks[k + 1].source = static_cast<std::uint32_t>(sources.size());
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
