#include "contact/near_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"

namespace cairn {

void NearPairs::find(const Bodies& bodies, const Box& box, double gap, std::vector<Pair>& pairs) {
  const Spheres& spheres = bodies.spheres;
  if (box.periodic())
    find_in_box(bodies, box, gap, pairs);
  else if (!bodies.cell.empty())
    find_across_cells(bodies, gap, pairs);
  else
    search_.find(spheres.position, spheres.radius, spheres.body, gap, pairs);
}

// Plain coordinates are good enough to look for neighbours with a little more gap; the verdict is exact.
void NearPairs::find_across_cells(const Bodies& bodies, double gap, std::vector<Pair>& pairs) {
  const Spheres& spheres = bodies.spheres;
  positions_.resize(spheres.size());
  double far = 0.0;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    positions_[s] = sphere_place(bodies, s);
    far = std::max(far, positions_[s].cwiseAbs().maxCoeff());
  }
  const double rounding = 8.0 * std::numeric_limits<double>::epsilon() * far;
  search_.find(positions_, spheres.radius, spheres.body, gap + (std::isfinite(far) ? rounding : 0.0), pairs);
  std::erase_if(pairs, [&](const Pair& p) {
    const Vec3 d = (spheres.position[p.j] - spheres.position[p.i]) +
                   bodies.cell_edge * (bodies.cell[spheres.body[p.j]] - bodies.cell[spheres.body[p.i]]);
    return !closer_than(d.x(), d.y(), d.z(), (spheres.radius[p.i] + spheres.radius[p.j]) + gap);
  });
}

// Every pair across the border is found once: of two images of a pair that are opposite to each other, only
// the one whose first step is positive is laid out.
void NearPairs::find_in_box(const Bodies& bodies, const Box& box, double gap, std::vector<Pair>& pairs) {
  const Spheres& spheres = bodies.spheres;
  const std::size_t count = spheres.size();
  if (count == 0) return pairs.clear();
  const double largest = *std::max_element(spheres.radius.begin(), spheres.radius.end());
  for (const double edge : box.edge)
    if (edge > 0.0 && !(edge > 4.0 * largest + 2.0 * gap))
      throw InputError(
          "a periodic box {:g} m wide is too small to look {:g} m far around spheres of up to {:g} m", edge,
          gap, largest);
  positions_.resize(count);
  radii_.assign(spheres.radius.begin(), spheres.radius.end());
  body_.assign(spheres.body.begin(), spheres.body.end());
  original_.resize(count);
  for (std::uint32_t s = 0; s < count; ++s) {
    original_[s] = s;
    Vec3& x = positions_[s] = spheres.position[s];
    for (int axis = 0; axis < 3; ++axis)
      if (box.edge[axis] > 0.0) x[axis] -= std::floor(x[axis] / box.edge[axis]) * box.edge[axis];
  }
  const auto near = [&](std::size_t s, int axis, int step) {
    const double reach = (radii_[s] + largest + gap) * (1.0 + 1e-12), x = positions_[s][axis];
    return step == 0 || (box.edge[axis] > 0.0 && (step > 0 ? x < reach : x > box.edge[axis] - reach));
  };
  for (std::uint32_t s = 0; s < count; ++s)
    for (int i = 0; i <= 1; ++i) {
      if (!near(s, 0, i)) continue;
      for (int j = i > 0 ? -1 : 0; j <= 1; ++j) {
        if (!near(s, 1, j)) continue;
        for (int k = i > 0 || j > 0 ? -1 : 1; k <= 1; ++k) {
          if (!near(s, 2, k)) continue;
          positions_.push_back(positions_[s] + box.edge.cwiseProduct(Vec3(i, j, k)));
          radii_.push_back(radii_[s]);
          body_.push_back(body_[s]);
          original_.push_back(s);
        }
      }
    }
  search_.find(positions_, radii_, body_, gap, pairs);
  std::erase_if(pairs, [&](const Pair& p) { return p.i >= count; });  // two images
  for (Pair& p : pairs) {
    const std::uint32_t i = p.i, j = original_[p.j];
    p = {std::min(i, j), std::max(i, j)};
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& a, const Pair& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; });
}

}  // namespace cairn
