#include "contact/near_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"

namespace cairn {

void NearPairs::find(const Bodies& bodies, const Box& box, double gap, std::vector<Pair>& pairs) {
  std::vector<double> reach(bodies.spheres.radius.begin(), bodies.spheres.radius.end());
  for (double& r : reach) r += 0.5 * gap;
  find(bodies, box, reach, pairs);
}

void NearPairs::find(const Bodies& bodies, const Box& box, std::span<const double> reach,
                     std::vector<Pair>& pairs) {
  if (box.periodic())
    find_in_box(bodies, box, reach, pairs);
  else if (!bodies.cell.empty())
    find_across_cells(bodies, reach, pairs);
  else
    search_.find(bodies.spheres.position, reach, groups(bodies), 0.0, pairs);
}

const std::vector<std::uint32_t>& NearPairs::groups(const Bodies& bodies) {
  if (bodies.held.empty()) return bodies.spheres.body;
  groups_ = bodies.spheres.body;
  const auto count = static_cast<std::uint32_t>(bodies.size());
  for (std::uint32_t& b : groups_)
    if (is_held(bodies, b)) b = count;
  return groups_;
}

// Plain coordinates are good enough to look for neighbours with a little more gap; the verdict is exact.
void NearPairs::find_across_cells(const Bodies& bodies, std::span<const double> reach,
                                  std::vector<Pair>& pairs) {
  const Spheres& spheres = bodies.spheres;
  positions_.resize(spheres.size());
  double far = 0.0;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    positions_[s] = sphere_place(bodies, s);
    far = std::max(far, positions_[s].cwiseAbs().maxCoeff());
  }
  const double rounding = 8.0 * std::numeric_limits<double>::epsilon() * far;
  search_.find(positions_, reach, groups(bodies), std::isfinite(far) ? rounding : 0.0, pairs);
  std::erase_if(pairs, [&](const Pair& p) {
    const Vec3 d = (spheres.position[p.j] - spheres.position[p.i]) +
                   bodies.cell_edge * (bodies.cell[spheres.body[p.j]] - bodies.cell[spheres.body[p.i]]);
    return !closer_than(d.x(), d.y(), d.z(), reach[p.i] + reach[p.j]);
  });
}

// Every pair across the border is found once: of two images of a pair that are opposite to each other, only
// the one whose first step is positive is laid out.
void NearPairs::find_in_box(const Bodies& bodies, const Box& box, std::span<const double> reach,
                            std::vector<Pair>& pairs) {
  const Spheres& spheres = bodies.spheres;
  const std::size_t count = spheres.size();
  if (count == 0) return pairs.clear();
  const double longest = *std::max_element(reach.begin(), reach.end());
  for (const double edge : box.edge)
    if (edge > 0.0 && !(edge > 4.0 * longest))
      throw InputError("a periodic box {:g} m wide is too small to look {:g} m around every sphere", edge,
                       longest);
  positions_.resize(count);
  reach_.assign(reach.begin(), reach.end());
  body_ = groups(bodies);
  original_.resize(count);
  for (std::uint32_t s = 0; s < count; ++s) {
    original_[s] = s;
    Vec3& x = positions_[s] = spheres.position[s];
    for (int axis = 0; axis < 3; ++axis)
      if (box.edge[axis] > 0.0) x[axis] -= std::floor(x[axis] / box.edge[axis]) * box.edge[axis];
  }
  const auto near = [&](std::size_t s, int axis, int step) {
    const double width = (reach_[s] + longest) * (1.0 + 1e-12), x = positions_[s][axis];
    return step == 0 || (box.edge[axis] > 0.0 && (step > 0 ? x < width : x > box.edge[axis] - width));
  };
  for (std::uint32_t s = 0; s < count; ++s)
    for (int i = 0; i <= 1; ++i) {
      if (!near(s, 0, i)) continue;
      for (int j = i > 0 ? -1 : 0; j <= 1; ++j) {
        if (!near(s, 1, j)) continue;
        for (int k = i > 0 || j > 0 ? -1 : 1; k <= 1; ++k) {
          if (!near(s, 2, k)) continue;
          positions_.push_back(positions_[s] + box.edge.cwiseProduct(Vec3(i, j, k)));
          reach_.push_back(reach_[s]);
          body_.push_back(body_[s]);
          original_.push_back(s);
        }
      }
    }
  search_.find(positions_, reach_, body_, 0.0, pairs);
  std::erase_if(pairs, [&](const Pair& p) { return p.i >= count; });  // two images
  for (Pair& p : pairs) {
    const std::uint32_t i = p.i, j = original_[p.j];
    p = {std::min(i, j), std::max(i, j)};
  }
  std::sort(pairs.begin(), pairs.end());
}

}  // namespace cairn
