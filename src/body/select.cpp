#include "body/select.h"

#include "body/columns.h"

namespace cairn {

namespace {

template <class T>
void keep_marked(std::vector<T>& values, const std::vector<std::uint8_t>& keep) {
  if (values.empty()) return;  // cells, or what else does not exist
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
  for_each_sphere_column([&](auto& values) { keep_marked(values, keep_sphere); }, spheres);
  for_each_body_column([&](auto& values) { keep_marked(values, keep); }, bodies);
  bodies.first_sphere = std::move(first);
  return number;
}

}  // namespace cairn
