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

}  // namespace

std::vector<std::uint32_t> Fragments::members(std::uint32_t cluster) const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < label.size(); ++b)
    if (label[b] == cluster) result.push_back(b);
  return result;
}

Fragments find_fragments(const Bodies& bodies, double gap, const Box& box) {
  const Spheres& spheres = bodies.spheres;
  std::vector<Pair> pairs;
  NearPairs().find(bodies, box, gap, pairs);
  Sets sets(bodies.size());
  for (const Pair& pair : pairs) sets.join(spheres.body[pair.i], spheres.body[pair.j]);

  const auto count = static_cast<std::uint32_t>(bodies.size());
  std::vector<double> mass(count, 0.0);  // of the set of each root
  std::vector<std::uint32_t> roots;
  for (std::uint32_t b = 0; b < count; ++b) {
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
  result.label.resize(count);
  for (std::uint32_t b = 0; b < count; ++b) {
    result.label[b] = label_of_root[sets.root(b)];
    ++result.count[result.label[b]];
  }
  return result;
}

}  // namespace cairn
