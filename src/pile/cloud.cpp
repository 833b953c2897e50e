#include "pile/cloud.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "core/elementary.h"
#include "core/error.h"
#include "core/random.h"
#include "pile/order.h"

namespace cairn {

namespace {

/// Bounding spheres of similar sizes already placed, in cells as wide as the largest of them. No sphere that
/// is asked for is larger.
class Layer {
 public:
  explicit Layer(double cell) : cell_(cell) {}

  double cell() const { return cell_; }
  bool overlaps(const Vec3& x, double radius) const {
    const auto [i, j, k] = index(x);
    for (std::int64_t a = i - 1; a <= i + 1; ++a)
      for (std::int64_t b = j - 1; b <= j + 1; ++b)
        for (std::int64_t c = k - 1; c <= k + 1; ++c)
          if (const auto it = cells_.find(key(a, b, c)); it != cells_.end())
            for (const auto& [center, r] : it->second)
              if ((center - x).squaredNorm() < (r + radius) * (r + radius)) return true;
    return false;
  }

  void insert(const Vec3& x, double radius) {
    const auto [i, j, k] = index(x);
    cells_[key(i, j, k)].emplace_back(x, radius);
  }

 private:
  std::array<std::int64_t, 3> index(const Vec3& x) const {
    return {static_cast<std::int64_t>(std::floor(x.x() / cell_)),
            static_cast<std::int64_t>(std::floor(x.y() / cell_)),
            static_cast<std::int64_t>(std::floor(x.z() / cell_))};
  }
  static std::int64_t key(std::int64_t i, std::int64_t j, std::int64_t k) {
    return ((i + (1 << 20)) << 42) | ((j + (1 << 20)) << 21) | (k + (1 << 20));
  }

  double cell_;
  std::unordered_map<std::int64_t, std::vector<std::pair<Vec3, double>>> cells_;
};

/// Bounding spheres already placed, in layers of sizes that differ by less than two.
class Occupied {
 public:
  bool overlaps(const Vec3& x, double radius) const {
    return std::any_of(layers_.begin(), layers_.end(),
                       [&](const Layer& layer) { return layer.overlaps(x, radius); });
  }
  /// Spheres must come largest first.
  void insert(const Vec3& x, double radius) {
    if (layers_.empty() || 4.0 * radius < layers_.back().cell()) layers_.emplace_back(2.0 * radius);
    layers_.back().insert(x, radius);
  }

 private:
  std::vector<Layer> layers_;
};

/// Bodies of each shape: weights times count, rounded so that they add up (largest remainders first).
std::vector<std::int64_t> shape_counts(const CloudSpec& cloud) {
  const std::size_t n = cloud.shapes.size();
  double total = 0.0;
  for (const ShapeChoice& s : cloud.shapes) total += s.weight;
  std::vector<std::int64_t> counts(n);
  std::vector<double> remainder(n);
  std::int64_t placed = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double share = static_cast<double>(cloud.count) * cloud.shapes[k].weight / total;
    counts[k] = static_cast<std::int64_t>(std::floor(share));
    remainder[k] = share - std::floor(share);
    placed += counts[k];
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return remainder[a] > remainder[b]; });
  for (std::size_t k = 0; placed < cloud.count; k = (k + 1) % n, ++placed) ++counts[order[k]];
  return counts;
}

/// Logarithm of the part of the normal distribution above z > 0, however far in the tail.
double log_tail(double z) {
  if (z < 30.0) return logarithm(0.5 * complementary_error_function(z / std::sqrt(2.0)));
  return -0.5 * z * z - logarithm(z * std::sqrt(2.0 * kPi)) + logarithm_of_one_plus(-1.0 / (z * z));
}

/// Where the normal distribution cut off at low and high has the part u below it.
double draw_normal(double low, double high, double u) {
  if (high < 0.0) return -draw_normal(-high, -low, 1.0 - u);
  const auto part_below = [](double z) { return 0.5 * complementary_error_function(-z / std::sqrt(2.0)); };
  const bool tail = low > 0.0;  // differences of `part_below` would be lost there
  const double aim =
      tail ? log_tail(low) + logarithm_of_one_plus(u * exponential_less_one(log_tail(high) - log_tail(low)))
           : part_below(low) + u * (part_below(high) - part_below(low));
  for (int k = 0; k < 60; ++k) {
    const double z = 0.5 * (low + high);
    ((tail ? log_tail(z) > aim : part_below(z) < aim) ? low : high) = z;
  }
  return 0.5 * (low + high);
}

double draw_log_normal(const CloudSpec& cloud, double u) {
  const double z = draw_normal(logarithm(cloud.size / cloud.median) / cloud.sigma,
                               logarithm(cloud.size_max / cloud.median) / cloud.sigma, u);
  return std::clamp(cloud.median * exponential(cloud.sigma * z), cloud.size, cloud.size_max);
}

}  // namespace

double draw_size(const CloudSpec& cloud, double u) {
  const double low = cloud.size, high = cloud.size_max;
  switch (cloud.distribution) {
    case SizeDistribution::single:
      return low;
    case SizeDistribution::uniform:
      return low + (high - low) * u;
    case SizeDistribution::log_normal:
      return draw_log_normal(cloud, u);
    case SizeDistribution::power_law:
      break;
  }
  const double p = 1.0 - cloud.exponent;  // the cumulative number goes as size^p
  if (std::abs(p) < 1e-12) return low * power(high / low, u);
  const double a = power(low, p), b = power(high, p);
  return power(a + (b - a) * u, 1.0 / p);
}

void add_cloud(const CloudSpec& cloud, const std::vector<RigidShape>& shapes,
               const std::vector<std::uint32_t>& shape_index, std::uint16_t material, std::uint64_t seed,
               std::uint64_t stream, Bodies& bodies) {
  struct Grain {
    std::uint32_t shape;
    double size, radius;
    Vec3 position;
    Quat orientation;
  };
  Random random(seed, stream);
  std::vector<Grain> grains;
  const std::vector<std::int64_t> counts = shape_counts(cloud);
  double volume = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < counts.size(); ++k)
    for (std::int64_t c = 0; c < counts[k]; ++c) {
      const double size = draw_size(cloud, random.uniform());
      const double radius = size * shapes[shape_index[k]].bounding_radius;
      grains.push_back({shape_index[k], size, radius, Vec3::Zero(), random.rotation()});
      volume += radius * radius * radius;
      largest = std::max(largest, radius);
    }

  // Largest first: they need the widest gaps.
  std::stable_sort(grains.begin(), grains.end(), [](auto& a, auto& b) { return a.radius > b.radius; });
  const double hole = cloud.hole, ball = std::max(cube_root(volume / cloud.filling + hole * hole * hole),
                                                  hole > 0.0 ? hole + 2.0 * largest : largest);
  Occupied occupied;
  for (Grain& g : grains) {
    constexpr int tries = 10000;
    int t = 0;
    do g.position = (ball - g.radius) * random.in_ball();
    while (((hole > 0.0 && g.position.norm() < hole + g.radius) || occupied.overlaps(g.position, g.radius)) &&
           ++t < tries);
    if (t == tries)
      throw InputError(
          "cloud of {} bodies: no room after {} tries for a body of size {:g} m; lower 'filling' ({:g}){}",
          cloud.count, tries, g.size, cloud.filling, hole > 0.0 ? " or 'hole'" : "");
    occupied.insert(g.position, g.radius);
  }

  const auto code = [&](const Grain& g) { return morton(g.position, ball); };
  std::stable_sort(grains.begin(), grains.end(), [&](auto& a, auto& b) { return code(a) < code(b); });
  const Vec3 spin = cloud.spin_period > 0.0 ? Vec3(0.0, 0.0, 2.0 * kPi / cloud.spin_period) : Vec3::Zero();
  for (const Grain& g : grains)
    add_body(bodies, shapes[g.shape], g.shape, g.size, cloud.density, material,
             {.position = g.position,
              .orientation = g.orientation,
              .velocity = cloud.velocity + spin.cross(g.position),
              .angular_velocity = spin,
              .origin = cloud.position});
}

}  // namespace cairn
