#include "pile/cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "shape/library.h"

namespace cairn {
namespace {

CloudSpec mixture() {
  CloudSpec cloud;
  cloud.shapes = {{"sphere", 1.0}, {"rod4", 2.0}, {"cube", 4.0}};
  cloud.count = 500;
  cloud.filling = 0.15;
  cloud.distribution = SizeDistribution::power_law;
  cloud.size = 1.0;
  cloud.size_max = 4.0;
  cloud.exponent = 3.0;
  cloud.density = 2500.0;
  cloud.position = {100.0, -50.0, 10.0};
  cloud.velocity = {1.0, 0.0, -2.0};
  cloud.spin_period = 7200.0;
  return cloud;
}

Bodies make(const CloudSpec& cloud, std::uint64_t seed, std::uint64_t stream = 0) {
  std::vector<RigidShape> shapes;
  std::vector<std::uint32_t> index;
  for (const ShapeChoice& s : cloud.shapes) {
    index.push_back(static_cast<std::uint32_t>(shapes.size()));
    shapes.push_back(make_rigid(load_shape(s.shape, "."), MassModel::union_volume));
  }
  Bodies bodies;
  add_cloud(cloud, shapes, index, 0, seed, stream, bodies);
  return bodies;
}

/// Largest distance between the sample's distribution and `cumulative`.
template <class F>
double kolmogorov(std::vector<double> sample, F&& cumulative) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double distance = 0.0;
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const double f = cumulative(sample[k]), at = static_cast<double>(k);
    distance = std::max({distance, std::abs(f - at / n), std::abs(f - (at + 1.0) / n)});
  }
  return distance;
}

TEST(Cloud, HasTheNumbersOfEachShapeThatTheWeightsAskFor) {
  const Bodies bodies = make(mixture(), 1);
  ASSERT_EQ(bodies.size(), 500u);
  std::array<int, 3> counts{};
  for (std::uint32_t s : bodies.shape) ++counts[s];
  EXPECT_EQ(counts, (std::array<int, 3>{71, 143, 286}));  // 71.4, 142.9, 285.7
}

TEST(Cloud, SpheresOfDifferentBodiesDoNotOverlapAndFillTheBall) {
  const CloudSpec cloud = mixture();
  const Bodies bodies = make(cloud, 1);
  const Spheres& s = bodies.spheres;
  for (std::size_t a = 0; a < s.size(); ++a)
    for (std::size_t b = a + 1; b < s.size(); ++b)
      if (s.body[a] != s.body[b]) {
        ASSERT_GE((s.position[a] - s.position[b]).norm(), s.radius[a] + s.radius[b]) << a << ' ' << b;
      }
  double volume = 0.0, reach = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    double bound = 0.0;
    for (std::uint32_t k = bodies.first_sphere[b]; k < bodies.first_sphere[b + 1]; ++k)
      bound = std::max(bound, s.offset[k].norm() + s.radius[k]);
    volume += std::pow(bound, 3);
    reach = std::max(reach, (bodies.position[b] - cloud.position).norm() + bound);
  }
  const double ball = std::cbrt(volume / cloud.filling);
  EXPECT_LE(reach, ball * (1.0 + 1e-12));
  EXPECT_GE(reach, 0.95 * ball);
}

TEST(Cloud, OfEqualSpheresHasNoTwoThatOverlap) {
  CloudSpec cloud = mixture();
  cloud.shapes = {{"sphere", 1.0}};
  cloud.distribution = SizeDistribution::single;
  const Bodies bodies = make(cloud, 1);
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.size(); ++b)
      ASSERT_GE((bodies.position[a] - bodies.position[b]).norm(), 2.0) << a << ' ' << b;
}

TEST(Cloud, SizesFollowThePowerLaw) {
  CloudSpec cloud = mixture();
  for (const double exponent : {3.0, 1.0}) {
    cloud.exponent = exponent;
    std::vector<double> sizes = make(cloud, 2).length;
    for (double d : sizes) {
      ASSERT_GE(d, 1.0);
      ASSERT_LE(d, 4.0);
    }
    const double distance = kolmogorov(sizes, [&](double d) {
      return exponent == 1.0 ? std::log(d) / std::log(4.0)
                             : (1.0 - std::pow(d, -2.0)) / (1.0 - std::pow(4.0, -2.0));
    });
    EXPECT_LT(distance, 1.63 / std::sqrt(500.0)) << exponent;  // 1 % level
  }
}

TEST(Cloud, DrawnSizesInvertTheDistribution) {
  CloudSpec cloud = mixture();
  EXPECT_DOUBLE_EQ(draw_size(cloud, 0.0), 1.0);
  EXPECT_NEAR(draw_size(cloud, 1.0), 4.0, 1e-12);
  EXPECT_NEAR(draw_size(cloud, 0.8), 2.0, 1e-12);  // (1 - 1/4) / (1 - 1/16)
  cloud.distribution = SizeDistribution::uniform;
  EXPECT_DOUBLE_EQ(draw_size(cloud, 0.5), 2.5);
  cloud.distribution = SizeDistribution::single;
  EXPECT_EQ(draw_size(cloud, 0.5), 1.0);
}

TEST(Cloud, SizesFollowTheLogNormalDistributionBetweenTheLimits) {
  CloudSpec cloud = mixture();
  cloud.distribution = SizeDistribution::log_normal;
  cloud.median = 1.6;
  cloud.sigma = 0.5;
  const auto normal = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  const auto below = [&](double d) { return normal(std::log(d / 1.6) / 0.5); };
  const std::vector<double> sizes = make(cloud, 2).length;
  const double distance =
      kolmogorov(sizes, [&](double d) { return (below(d) - below(1.0)) / (below(4.0) - below(1.0)); });
  EXPECT_LT(distance, 1.63 / std::sqrt(500.0));  // 1 % level
  EXPECT_NEAR(draw_size(cloud, 0.0), 1.0, 1e-12);
  EXPECT_NEAR(draw_size(cloud, 1.0), 4.0, 1e-12);
  for (const double u : {0.1, 0.5, 0.9})
    EXPECT_NEAR((below(draw_size(cloud, u)) - below(1.0)) / (below(4.0) - below(1.0)), u, 1e-12);
}

// Limits far in a tail, where differences of the distribution function vanish; by the trapezium rule.
TEST(Cloud, SizesInATailOfTheLogNormalDistributionFollowIt) {
  CloudSpec cloud = mixture();
  cloud.distribution = SizeDistribution::log_normal;
  cloud.size = 10.0;
  cloud.size_max = 50.0;
  for (const auto& [median, sigma] :
       std::vector<std::pair<double, double>>{{3000, 0.1}, {1e6, 0.01}, {100, 0.05}, {1, 0.1}, {1, 0.003}}) {
    cloud.median = median;
    cloud.sigma = sigma;
    const double low = std::log(10.0 / median) / sigma, high = std::log(50.0 / median) / sigma,
                 nearest = low > 0.0 ? low : high;
    const auto part = [&](double from, double to) {  // of the density over that at the nearest limit
      constexpr int steps = 200000;
      double sum = 0.0;
      for (int k = 0; k <= steps; ++k) {
        const double z = from + (to - from) * k / steps;
        sum += (k % steps == 0 ? 0.5 : 1.0) * std::exp(0.5 * (nearest - z) * (nearest + z));
      }
      return sum * (to - from) / steps;
    };
    const double width = std::min(high - low, 30.0 / std::abs(nearest));  // the rest is nothing
    const double first = low > 0.0 ? low : high - width, last = low > 0.0 ? low + width : high;
    for (const double u : {0.01, 0.3, 0.5, 0.9, 0.999}) {
      const double z = std::log(draw_size(cloud, u) / median) / sigma;
      EXPECT_NEAR(part(first, z) / part(first, last), u, 1e-6) << median << ' ' << sigma;
    }
  }
}

TEST(Cloud, OfAHundredfoldRangeOfSizesHasNoOverlap) {
  CloudSpec cloud = mixture();
  cloud.shapes = {{"sphere", 1.0}};
  cloud.count = 5000;
  cloud.size_max = 100.0;
  cloud.exponent = 2.0;
  cloud.filling = 0.2;
  const Bodies bodies = make(cloud, 1);
  EXPECT_GT(*std::max_element(bodies.length.begin(), bodies.length.end()), 90.0);
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.size(); ++b)
      ASSERT_GE((bodies.position[a] - bodies.position[b]).norm(), bodies.length[a] + bodies.length[b]);
}

TEST(Cloud, LeavesTheHoleFree) {
  CloudSpec cloud = mixture();
  cloud.hole = 60.0;
  const Bodies bodies = make(cloud, 3);
  double volume = 0.0, reach = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    double bound = 0.0;
    for (std::uint32_t k = bodies.first_sphere[b]; k < bodies.first_sphere[b + 1]; ++k)
      bound = std::max(bound, bodies.spheres.offset[k].norm() + bodies.spheres.radius[k]);
    const double distance = (bodies.position[b] - cloud.position).norm();
    EXPECT_GE(distance, 60.0 + bound * (1.0 - 1e-12));
    volume += std::pow(bound, 3);
    reach = std::max(reach, distance + bound);
  }
  EXPECT_NEAR(reach, std::cbrt(volume / cloud.filling + std::pow(60.0, 3)), 0.02 * reach);
}

TEST(Cloud, MovesAndTurnsAsOneBody) {
  const CloudSpec cloud = mixture();
  const Bodies bodies = make(cloud, 1);
  const Vec3 spin(0.0, 0.0, 2.0 * kPi / 7200.0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vec3 expected = cloud.velocity + spin.cross(Vec3(bodies.position[b] - cloud.position));
    ASSERT_LT((bodies.velocity[b] - expected).norm(), 1e-14);
    ASSERT_LT((angular_velocity(bodies, b) - spin).norm(), 1e-16);
  }
}

TEST(Cloud, DependsOnSeedAndStreamAlone) {
  const CloudSpec cloud = mixture();
  const Bodies one = make(cloud, 1), again = make(cloud, 1), other = make(cloud, 2), next = make(cloud, 1, 1);
  EXPECT_EQ(one.position, again.position);
  EXPECT_EQ(one.length, again.length);
  for (std::size_t b = 0; b < one.size(); ++b)
    EXPECT_EQ(one.orientation[b].coeffs(), again.orientation[b].coeffs());
  EXPECT_NE(one.position, other.position);
  EXPECT_NE(one.position, next.position);
}

TEST(Cloud, ThatCannotBePlacedIsAnError) {
  CloudSpec cloud = mixture();
  cloud.filling = 0.9;
  EXPECT_THROW(make(cloud, 1), InputError);
}

}  // namespace
}  // namespace cairn
