#include <algorithm>
#include <cmath>
#include <queue>

#include "core/parallel.h"
#include "core/random.h"
#include "shape/fit_methods.h"

namespace cairn {
namespace {

constexpr std::size_t kTouching = 4000, kInner = 20000;

/// Points of low discrepancy inside the solid.
std::vector<Vec3> inner_points(const FitTarget& target, std::uint64_t seed) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : target.solid.surface.vertices) box.extend(x);
  const double filled = target.mass.volume / box.volume();
  const auto tries = static_cast<std::size_t>(static_cast<double>(kInner) / filled);
  Random random(seed, 1);
  const Vec3 start(random.uniform(), random.uniform(), random.uniform());
  const Vec3 step(0.8191725133961645, 0.6710436067037893, 0.5497004779019703);  // Roberts 2018, "R3"
  std::vector<Vec3> points(tries);
  std::vector<char> inside(tries);
  parallel_for(tries, [&](std::size_t n) {
    const Vec3 at = start + static_cast<double>(n) * step;
    const Vec3 part = at - Vec3(at.array().floor());
    points[n] = box.min() + part.cwiseProduct(box.sizes());
    inside[n] = target.distance.inside(points[n]);
  });
  std::vector<Vec3> inner;
  for (std::size_t n = 0; n < tries; ++n)
    if (inside[n]) inner.push_back(points[n]);
  return inner;
}

}  // namespace

Shape medial_balls(const FitTarget& target, const std::vector<SurfaceSample>& touching, double largest) {
  constexpr int most_steps = 40;
  constexpr double exact = 1e-9, least = 1e-3;
  Shape balls;
  balls.centers.resize(touching.size());
  balls.radii.resize(touching.size());
  parallel_for(touching.size(), [&](std::size_t s) {
    const auto& [p, n] = touching[s];
    double radius = largest;
    for (int step = 0; step < most_steps; ++step) {
      const auto nearest = target.distance(p - radius * n);
      if (std::abs(nearest.distance) >= radius - exact && nearest.distance < 0.0) break;
      const Vec3 chord = p - nearest.point;
      const double rise = chord.dot(n);
      if (!(rise > 1e-12)) break;
      radius = std::min(0.5 * chord.squaredNorm() / rise, 0.999 * radius);
    }
    balls.centers[s] = p - std::max(radius, least) * n;
    balls.radii[s] = std::max(least, -target.distance(balls.centers[s]).distance);
  });
  return balls;
}

Shape fit_greedy(const FitTarget& target, std::size_t count, std::uint64_t seed) {
  const Shape balls = medial_balls(target, sample_surface(target.solid.surface, kTouching, seed));
  const std::vector<Vec3> inner = inner_points(target, seed);
  std::vector<char> covered(inner.size(), 0);
  const auto covers = [&](std::size_t b, std::size_t p) {
    return (inner[p] - balls.centers[b]).squaredNorm() < balls.radii[b] * balls.radii[b];
  };
  const auto gain = [&](std::size_t b) {
    std::size_t points = 0;
    for (std::size_t p = 0; p < inner.size(); ++p) points += !covered[p] && covers(b, p);
    return points;
  };
  // Gains only fall as balls are added: one that still leads after a new count is the best of all.
  std::vector<std::size_t> gains(balls.radii.size());
  parallel_for(gains.size(), [&](std::size_t b) { gains[b] = gain(b); });
  const auto behind = [&](const std::pair<std::size_t, std::size_t>& x,
                          const std::pair<std::size_t, std::size_t>& y) {
    return x.first != y.first ? x.first < y.first : x.second > y.second;
  };
  std::priority_queue<std::pair<std::size_t, std::size_t>, std::vector<std::pair<std::size_t, std::size_t>>,
                      decltype(behind)>
      queue(behind);
  for (std::size_t b = 0; b < gains.size(); ++b) queue.push({gains[b], b});
  Shape chosen;
  while (chosen.radii.size() < count) {
    const std::size_t b = queue.top().second;
    queue.pop();
    const std::size_t now = gain(b);
    if (!queue.empty() && behind({now, b}, queue.top())) {
      queue.push({now, b});
      continue;
    }
    chosen.centers.push_back(balls.centers[b]);
    chosen.radii.push_back(balls.radii[b]);
    for (std::size_t p = 0; p < inner.size(); ++p) covered[p] = covered[p] || covers(b, p);
  }
  return chosen;
}

}  // namespace cairn
