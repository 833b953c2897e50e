#include "shape/union_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "shape/surface_samples.h"

namespace cairn {

UnionSurface::UnionSurface(const Shape& balls) : balls_(balls), neighbours_(balls.radii.size()) {
  const std::size_t count = balls.radii.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      if (j != i && (balls.centers[i] - balls.centers[j]).norm() < balls.radii[i] + balls.radii[j])
        neighbours_[i].push_back(static_cast<std::uint32_t>(j));
}

bool UnionSurface::exposed(const Vec3& x, std::size_t a, std::size_t b, std::size_t c) const {
  for (const std::uint32_t k : neighbours_[a])
    if (k != b && k != c && (x - balls_.centers[k]).squaredNorm() < balls_.radii[k] * balls_.radii[k])
      return false;
  return true;
}

std::vector<UnionPoint> UnionSurface::sample(std::size_t count) const {
  const std::size_t balls = balls_.radii.size();
  double area = 0.0;  // of all balls; some of it is covered
  for (const double r : balls_.radii) area += r * r;
  std::vector<std::vector<UnionPoint>> found(balls);
  for (double factor = 1.0;; factor *= 2.0) {
    parallel_blocks(balls, 1, [&](std::size_t i, std::size_t) {
      found[i].clear();
      const double r = balls_.radii[i];
      const auto directions =
          static_cast<std::size_t>(std::ceil(factor * static_cast<double>(count) * r * r / area));
      for (const Vec3& u : spiral_directions(directions))
        if (const Vec3 x = balls_.centers[i] + r * u; exposed(x, i, i, i))
          found[i].push_back({x, static_cast<std::uint32_t>(i)});
    });
    std::vector<UnionPoint> all;
    for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    if (2 * all.size() >= count || factor > 1000.0) return all;
  }
}

double UnionSurface::distance(const Vec3& x, double near) const {
  const auto& centers = balls_.centers;
  const auto& radii = balls_.radii;
  double outside = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < radii.size(); ++i)
    outside = std::min(outside, (x - centers[i]).norm() - radii[i]);
  if (outside >= 0.0) return outside;  // the nearest ball's nearest point is exposed

  double best = near;
  std::vector<std::uint32_t> close;  // balls with surface near enough to matter
  for (std::uint32_t i = 0; i < radii.size(); ++i) {
    const Vec3 arm = x - centers[i];
    const double height = arm.norm() - radii[i];
    if (std::abs(height) >= best) continue;
    close.push_back(i);
    const Vec3 foot = centers[i] + radii[i] / (height + radii[i]) * arm;
    if (height + radii[i] > 0.0 && exposed(foot, i, i, i)) best = std::abs(height);
  }
  if (best <= -outside) return -best;  // no point is nearer than that
  for (std::size_t a = 0; a < close.size(); ++a)
    for (std::size_t b = a + 1; b < close.size(); ++b) {
      const std::uint32_t i = close[a], j = close[b];
      const Vec3 between = centers[j] - centers[i];
      const double d = between.norm();
      if (!(d < radii[i] + radii[j] && d > std::abs(radii[i] - radii[j]))) continue;
      const Vec3 axis = between / d;
      const double along = 0.5 * (d * d + radii[i] * radii[i] - radii[j] * radii[j]) / d;
      const Vec3 middle = centers[i] + along * axis;
      const double rim = std::sqrt(std::max(0.0, radii[i] * radii[i] - along * along));
      const Vec3 arm = (x - middle) - (x - middle).dot(axis) * axis;
      if (std::sqrt(squared((x - middle).dot(axis)) + squared(arm.norm() - rim)) >= best) continue;
      const Vec3 out = arm.norm() > 0.0 ? Vec3(arm.normalized()) : axis.unitOrthogonal();
      if (const Vec3 foot = middle + rim * out; exposed(foot, i, j, j)) best = (foot - x).norm();
      for (std::size_t c = b + 1; c < close.size(); ++c) {
        const std::uint32_t k = close[c];
        // On the circle, the directions in which the third ball's surface is met.
        const Vec3 to = centers[k] - middle, flat = to - to.dot(axis) * axis;
        const double reach = flat.norm();
        const double cosine = (to.squaredNorm() + rim * rim - radii[k] * radii[k]) / (2.0 * rim * reach);
        if (!(std::abs(cosine) < 1.0)) continue;
        const Vec3 u = flat / reach, v = axis.cross(u);
        for (const double side : {-1.0, 1.0}) {
          const Vec3 corner = middle + rim * (cosine * u + side * std::sqrt(1.0 - cosine * cosine) * v);
          if ((corner - x).norm() < best && exposed(corner, i, j, k)) best = (corner - x).norm();
        }
      }
    }
  return -best;
}

}  // namespace cairn
