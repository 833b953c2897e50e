#include "body/select.h"

namespace cairn {

namespace {

template <class T>
void keep_marked(std::vector<T>& values, const std::vector<std::uint8_t>& keep) {
  if (values.empty()) return;  // cells that do not exist
  std::size_t end = 0;
  for (std::size_t k = 0; k < keep.size(); ++k)
    if (keep[k]) values[end++] = values[k];
  values.resize(end);
}

}  // namespace

std::vector<std::uint32_t> select_bodies(Bodies& bodies, const std::vector<std::uint8_t>& keep) {
  Spheres& spheres = bodies.spheres;
  std::vector<std::uint8_t> keep_sphere(spheres.size());
  std::vector<std::uint32_t> number(spheres.size(), kGone), first{0};
  std::uint32_t next = 0, body = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!keep[b]) continue;
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      keep_sphere[s] = 1;
      number[s] = next++;
      spheres.body[s] = body;
    }
    first.push_back(next);
    ++body;
  }
  keep_marked(spheres.radius, keep_sphere);
  keep_marked(spheres.mass, keep_sphere);
  keep_marked(spheres.offset, keep_sphere);
  keep_marked(spheres.body, keep_sphere);
  keep_marked(spheres.position, keep_sphere);
  keep_marked(bodies.mass, keep);
  keep_marked(bodies.volume, keep);
  keep_marked(bodies.inertia, keep);
  keep_marked(bodies.shape, keep);
  keep_marked(bodies.length, keep);
  keep_marked(bodies.material, keep);
  keep_marked(bodies.position, keep);
  keep_marked(bodies.remainder, keep);
  keep_marked(bodies.velocity, keep);
  keep_marked(bodies.orientation, keep);
  keep_marked(bodies.spin, keep);
  keep_marked(bodies.cell, keep);
  keep_marked(bodies.force, keep);
  keep_marked(bodies.torque, keep);
  bodies.first_sphere = std::move(first);
  return number;
}

}  // namespace cairn
