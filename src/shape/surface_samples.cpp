#include "shape/surface_samples.h"

#include <algorithm>
#include <cmath>

#include "core/elementary.h"
#include "core/random.h"

namespace cairn {

std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  std::vector<double> areas;  // up to and with each triangle
  double total = 0.0;
  const auto corner = [&](std::size_t t, std::size_t k) -> const Vec3& {
    return mesh.vertices[mesh.triangles[t][k]];
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    total += (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
    areas.push_back(total);
  }
  Random random(seed, 0);
  const double shift = random.uniform();
  double u = random.uniform(), v = random.uniform();
  std::vector<SurfaceSample> samples;
  samples.reserve(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double at = (static_cast<double>(n) + shift) / static_cast<double>(count) * total;
    const auto t =
        std::min(static_cast<std::size_t>(std::upper_bound(areas.begin(), areas.end(), at) - areas.begin()),
                 areas.size() - 1);
    u = std::fmod(u + 0.7548776662466927, 1.0);  // Roberts 2018, "R2"
    v = std::fmod(v + 0.5698402909980532, 1.0);
    const double s = std::sqrt(u);
    const Vec3 along = corner(t, 1) - corner(t, 0), across = corner(t, 2) - corner(t, 0);
    samples.push_back(
        {corner(t, 0) + s * (1.0 - v) * along + s * v * across, along.cross(across).normalized()});
  }
  return samples;
}

std::vector<Vec3> spiral_directions(std::size_t count) {
  const double turn = kPi * (3.0 - std::sqrt(5.0));
  std::vector<Vec3> directions;
  for (std::size_t n = 0; n < count; ++n) {
    const double z = 1.0 - (2.0 * static_cast<double>(n) + 1.0) / static_cast<double>(count);
    const double r = std::sqrt(1.0 - z * z), angle = turn * static_cast<double>(n);
    directions.push_back({r * sine_and_cosine(angle).cosine, r * sine_and_cosine(angle).sine, z});
  }
  return directions;
}

}  // namespace cairn
