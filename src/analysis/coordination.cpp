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
  std::size_t held_bodies = 0, held_spheres = 0, of_held = 0;  // their contacts
  for (std::size_t b = 0; b < bodies.held.size(); ++b)
    if (is_held(bodies, b)) {
      ++held_bodies;
      held_spheres += bodies.sphere_count(b);
    }
  for (const Pair& p : pairs) {
    const std::uint32_t a = spheres.body[p.i], b = spheres.body[p.j];
    ++touches[a];
    ++touches[b];
    of_held += is_held(bodies, a) || is_held(bodies, b);
    body_pairs.push_back(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b));
    const Vec3 lever =
        (spheres.position[p.j] - bodies.position[b]) - (spheres.position[p.i] - bodies.position[a]);
    const Vec3 d = separation(bodies, a, b) + lever;
    const double distance = (d + box.nearest_image(d)).norm();
    const double overlap = (spheres.radius[p.i] + spheres.radius[p.j] - distance) /
                           std::min(spheres.radius[p.i], spheres.radius[p.j]);
    out.largest_overlap = std::max(out.largest_overlap, overlap);
  }
  for (const WallContact& c : on_walls) {
    ++touches[spheres.body[c.sphere]];
    of_held += is_held(bodies, spheres.body[c.sphere]);
  }
  std::sort(body_pairs.begin(), body_pairs.end());
  body_pairs.erase(std::unique(body_pairs.begin(), body_pairs.end()), body_pairs.end());
  out.body_pairs = body_pairs.size();
  std::size_t neighbours = 2 * out.body_pairs;
  if (held_bodies > 0)
    for (const std::uint64_t pair : body_pairs)
      neighbours -= is_held(bodies, pair >> 32) || is_held(bodies, pair & 0xffffffffu);
  const auto sides = static_cast<double>(2 * pairs.size() + on_walls.size() - of_held);
  const auto free_bodies = static_cast<double>(bodies.size() - held_bodies);
  out.per_sphere = sides / static_cast<double>(spheres.size() - held_spheres);
  out.per_body = sides / free_bodies;
  out.neighbours = static_cast<double>(neighbours) / free_bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (is_held(bodies, b)) continue;
    out.free_bodies += touches[b] == 0;
    out.hanging_bodies += touches[b] == 1;
  }
  return out;
}

}  // namespace cairn
