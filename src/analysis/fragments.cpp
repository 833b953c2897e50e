#include "analysis/fragments.h"

#include <algorithm>
#include <numeric>

#include "contact/near_pairs.h"

namespace cairn {
namespace {

// Disjoint sets whose root is their smallest member.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t root(std::uint32_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Where one set has nearly all bodies: links the others by looking from each of their spheres at all.
/// Returns whether that was so.
bool join_few(const Bodies& bodies, double gap, const Box& box, Sets& sets) {
  constexpr std::size_t kFew = 32;  // spheres: as much work as a search
  if (box.periodic() || bodies.size() == 0) return false;
  std::vector<std::uint32_t> count(bodies.size(), 0);
  for (std::uint32_t b = 0; b < bodies.size(); ++b) ++count[sets.root(b)];
  const auto most = static_cast<std::uint32_t>(std::max_element(count.begin(), count.end()) - count.begin());
  std::vector<std::uint32_t> apart;  // spheres
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    if (sets.root(b) == most || is_held(bodies, b)) continue;
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) apart.push_back(s);
    if (apart.size() > kFew) return false;
  }
  const Spheres& spheres = bodies.spheres;
  for (const std::uint32_t s : apart)
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
      const std::uint32_t own = spheres.body[s];
      if (sets.root(b) == sets.root(own) || is_held(bodies, b)) continue;
      Vec3 from = spheres.position[s];
      if (!bodies.cell.empty()) from += bodies.cell_edge * (bodies.cell[own] - bodies.cell[b]);
      for (std::uint32_t t = bodies.first_sphere[b]; t < bodies.first_sphere[b + 1]; ++t) {
        const Vec3 d = spheres.position[t] - from;
        if (!closer_than(d.x(), d.y(), d.z(), spheres.radius[s] + spheres.radius[t] + gap)) continue;
        sets.join(b, own);
        break;
      }
    }
  return true;
}

}  // namespace

std::vector<std::uint32_t> Fragments::members(std::uint32_t cluster) const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < label.size(); ++b)
    if (label[b] == cluster) result.push_back(b);
  return result;
}

Fragments find_fragments(const Bodies& bodies, double gap, const Box& box, const ContactList* contacts) {
  const std::vector<std::uint32_t>& body = bodies.spheres.body;
  Sets sets(bodies.size());
  const auto join = [&](const Pair& pair) {
    const std::uint32_t a = body[pair.i], b = body[pair.j];
    if (!is_held(bodies, a) && !is_held(bodies, b)) sets.join(a, b);
  };
  if (contacts != nullptr)
    for (std::size_t slot = 0; slot < contacts->slots(); ++slot)
      if (contacts->touching(slot)) join(contacts->pair(slot));
  if (!join_few(bodies, gap, box, sets)) {
    std::vector<Pair> pairs;
    NearPairs().find(bodies, box, gap, pairs);
    for (const Pair& pair : pairs) join(pair);
  }

  const auto count = static_cast<std::uint32_t>(bodies.size());
  std::vector<double> mass(count, 0.0);  // of the set of each root
  std::vector<std::uint32_t> roots;
  for (std::uint32_t b = 0; b < count; ++b) {
    if (is_held(bodies, b)) continue;
    const std::uint32_t root = sets.root(b);
    if (root == b) roots.push_back(b);
    mass[root] += bodies.mass[b];
  }
  std::stable_sort(roots.begin(), roots.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return mass[a] > mass[b]; });

  Fragments result;
  std::vector<std::uint32_t> label_of_root(count);
  for (const std::uint32_t root : roots) {
    label_of_root[root] = static_cast<std::uint32_t>(result.mass.size());
    result.mass.push_back(mass[root]);
  }
  result.count.assign(roots.size(), 0);
  result.label.assign(count, Fragments::kNone);
  for (std::uint32_t b = 0; b < count; ++b) {
    if (is_held(bodies, b)) continue;
    result.label[b] = label_of_root[sets.root(b)];
    ++result.count[result.label[b]];
  }
  return result;
}

}  // namespace cairn
