#include "analysis/coordination.h"

#include <algorithm>

#include "body/cells.h"
#include "contact/near_pairs.h"

namespace cairn {

Coordination coordination(const Bodies& bodies, const Box& box, std::span<const WallContact> on_walls) {
  const Spheres& spheres = bodies.spheres;
  const double gap = 1e-9 * *std::min_element(spheres.radius.begin(), spheres.radius.end());
  std::vector<Pair> pairs;
  NearPairs search;
  search.find(bodies, box, gap, pairs);
  Coordination out;
  out.contacts = pairs.size() + on_walls.size();
  std::vector<std::uint32_t> touches(bodies.size(), 0);
  std::vector<std::uint64_t> body_pairs;
  for (const Pair& p : pairs) {
    const std::uint32_t a = spheres.body[p.i], b = spheres.body[p.j];
    ++touches[a];
    ++touches[b];
    body_pairs.push_back(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b));
    const Vec3 lever =
        (spheres.position[p.j] - bodies.position[b]) - (spheres.position[p.i] - bodies.position[a]);
    const Vec3 d = separation(bodies, a, b) + lever;
    const double distance = (d + box.nearest_image(d)).norm();
    const double overlap = (spheres.radius[p.i] + spheres.radius[p.j] - distance) /
                           std::min(spheres.radius[p.i], spheres.radius[p.j]);
    out.largest_overlap = std::max(out.largest_overlap, overlap);
  }
  for (const WallContact& c : on_walls) ++touches[spheres.body[c.sphere]];
  std::sort(body_pairs.begin(), body_pairs.end());
  out.body_pairs =
      static_cast<std::size_t>(std::unique(body_pairs.begin(), body_pairs.end()) - body_pairs.begin());
  const auto sides = static_cast<double>(2 * pairs.size() + on_walls.size());
  out.per_sphere = sides / static_cast<double>(spheres.size());
  out.per_body = sides / static_cast<double>(bodies.size());
  out.neighbours = 2.0 * static_cast<double>(out.body_pairs) / static_cast<double>(bodies.size());
  out.free_bodies = static_cast<std::size_t>(std::count(touches.begin(), touches.end(), 0u));
  out.hanging_bodies = static_cast<std::size_t>(std::count(touches.begin(), touches.end(), 1u));
  return out;
}

}  // namespace cairn
