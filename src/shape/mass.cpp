// Mass properties of overlapping balls: summed, or of the volume that they cover together.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "shape/exposed_surface.h"
#include "shape/shape.h"
#include "shape/solid_moments.h"

namespace cairn {
namespace {

// The middle of the centres: sums about it lose least to cancellation, and nothing for a single sphere.
Vec3 middle_of(const Shape& shape) {
  Eigen::AlignedBox3d box;
  for (const Vec3& center : shape.centers) box.extend(center);
  return box.center();
}

SolidMoments ball_moments(const Vec3& center, double radius) {
  const double volume = 4.0 / 3.0 * kPi * radius * radius * radius;
  return {volume, volume * center,
          volume * (center * center.transpose() + radius * radius / 5.0 * Mat3::Identity())};
}

// Pairs of spheres closer than touching, as neighbour lists in index order; sweep along the longest
// direction.
std::vector<std::vector<std::size_t>> overlapping(const Shape& shape) {
  Eigen::AlignedBox3d box;
  for (const Vec3& center : shape.centers) box.extend(center);
  Eigen::Index direction = 0;
  box.sizes().maxCoeff(&direction);
  const auto low = [&](std::size_t i) { return shape.centers[i][direction] - shape.radii[i]; };
  std::vector<std::size_t> order(shape.centers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return low(i) < low(j); });

  std::vector<std::vector<std::size_t>> neighbours(shape.centers.size());
  for (std::size_t a = 0; a < order.size(); ++a) {
    const std::size_t i = order[a];
    const double high = shape.centers[i][direction] + shape.radii[i];
    for (std::size_t b = a + 1; b < order.size() && low(order[b]) <= high; ++b) {
      const std::size_t j = order[b];
      const double reach = shape.radii[i] + shape.radii[j];
      if ((shape.centers[i] - shape.centers[j]).squaredNorm() >= reach * reach) continue;
      neighbours[i].push_back(j);
      neighbours[j].push_back(i);
    }
  }
  for (auto& list : neighbours) std::sort(list.begin(), list.end());
  return neighbours;
}

// What sphere i's exposed surface adds to the union's moments about `origin`. By the divergence theorem a
// homogeneous f of degree k has volume integral 1 / (k + 3) times the surface integral of f x . n.
SolidMoments surface_contribution(const Shape& shape, std::size_t i,
                                  const std::vector<std::size_t>& neighbours, const Vec3& origin) {
  const double r = shape.radii[i];
  std::vector<Cap> caps;
  for (const std::size_t j : neighbours) {
    const Vec3 offset = shape.centers[j] - shape.centers[i];
    const double d = offset.stableNorm(), rj = shape.radii[j];
    const double larger = rj - r;
    const bool same = d == 0.0 && larger == 0.0;
    if (same && i < j) continue;  // of identical spheres the first one stands for all
    if (same || d <= larger) return {};
    if (d <= -larger) continue;
    // 1 -+ cosine of the cap's angular radius, in a form that keeps small caps and close centres accurate.
    const double below = (r + rj - d) * (d + larger) / (2.0 * d * r);
    const double above = (r + rj + d) * (d - larger) / (2.0 * d * r);
    if (below <= 0.0) continue;
    if (above <= 0.0) return {};
    caps.push_back({offset / d, below < above ? 1.0 - below : above - 1.0, std::sqrt(below * above)});
  }
  const SurfaceMoments exposed = exposed_moments(caps);

  const Vec3 c = shape.centers[i] - origin;
  const double flux = c.dot(exposed.first) + r * exposed.area;     // of x . n
  const Vec3 flux_first = exposed.second * c + r * exposed.first;  // of u (x . n)
  Mat3 flux_second = r * exposed.second;                           // of u u^T (x . n)
  for (int k = 0; k < 3; ++k) flux_second += c[k] * exposed.third[static_cast<std::size_t>(k)];
  const double r2 = r * r;
  const Mat3 mixed = c * flux_first.transpose();
  return {r2 * flux / 3.0, r2 * (flux * c + r * flux_first) / 4.0,
          r2 * (flux * c * c.transpose() + r * (mixed + mixed.transpose()) + r2 * flux_second) / 5.0};
}

}  // namespace

MassProperties sum_of_spheres(const Shape& shape) {
  const Vec3 origin = middle_of(shape);
  SolidMoments total;
  for (std::size_t i = 0; i < shape.centers.size(); ++i)
    total += ball_moments(shape.centers[i] - origin, shape.radii[i]);
  return about_centroid(total, origin);
}

MassProperties union_of_spheres(const Shape& shape) {
  const Vec3 origin = middle_of(shape);
  const auto neighbours = overlapping(shape);
  std::vector<SolidMoments> parts(shape.centers.size());
  parallel_blocks(parts.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      parts[i] = surface_contribution(shape, i, neighbours[i], origin);
  });
  SolidMoments total;
  for (const SolidMoments& part : parts) total += part;
  return about_centroid(total, origin);
}

}  // namespace cairn
