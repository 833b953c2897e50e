// The error asked for is met whatever the points are like.
#include "gravity/accuracy.h"

#include <gtest/gtest.h>

#include "gravity/direct.h"
#include "unit/gravity/clouds.h"

namespace cairn::gravity {
namespace {

constexpr std::size_t kPoints = 6000;

void add(Cloud& cloud, const Vec3& x, double mass) {
  cloud.add_group({x}, mass);
}

Cloud shell() {
  Cloud cloud;
  Random random(2, 0);
  for (std::size_t i = 0; i < kPoints; ++i) add(cloud, 400.0 * random.direction(), 1e9);
  return cloud;
}

Cloud far_pair() {
  Cloud cloud;
  Random random(3, 0);
  for (std::size_t i = 0; i < kPoints; ++i)
    add(cloud, 300.0 * random.in_ball() + (i % 3 == 0 ? Vec3(1e5, 0, 0) : Vec3(0, 0, 0)), 1e9);
  return cloud;
}

Cloud pile_with_halo() {
  Cloud cloud;
  Random random(4, 0);
  for (std::size_t i = 0; i < kPoints; ++i) add(cloud, (i % 20 == 0 ? 2e4 : 400.0) * random.in_ball(), 1e9);
  return cloud;
}

/// Radii from 1 to 100, masses in proportion to their cubes.
Cloud many_sizes() {
  Cloud cloud;
  Random random(5, 0);
  for (std::size_t i = 0; i < kPoints; ++i)
    add(cloud, 400.0 * random.in_ball(), 1e3 * std::pow(1e6, std::pow(random.uniform(), 3.0)));
  return cloud;
}

/// A cube of 10 x 10 x 10 glued points, 2 apart, with its lowest corner at `corner`.
std::vector<Vec3> cube(const Vec3& corner) {
  std::vector<Vec3> x;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 10; ++k) x.push_back(corner + 2.0 * Vec3(i, j, k));
  return x;
}

/// Six such cubes side by side, loose points all about.
Cloud cubes() {
  Cloud cloud;
  for (int c = 0; c < 6; ++c) cloud.add_group(cube(20.0 * Vec3(c % 3, c / 3, 0)), 1e4);
  Random random(6, 0);
  for (int i = 0; i < 500; ++i) add(cloud, Vec3(30, 20, 30) + 10.0 * random.in_ball(), 1e4);
  return cloud;
}

TEST(Accuracy, ErrorAskedForIsMetInEveryDistribution) {
  struct Case {
    const char* name;
    Cloud cloud;
  };
  for (const Case& c : {Case{"ball", ball(kPoints)}, Case{"aggregates", ball(kPoints, 6)},
                        Case{"shell", shell()}, Case{"far pair", far_pair()}, Case{"halo", pile_with_halo()},
                        Case{"sizes", many_sizes()}, Case{"cubes of a thousand", cubes()}}) {
    std::vector<Vec3> exact(c.cloud.size()), fast(c.cloud.size());
    DirectSum().evaluate(c.cloud.points(), exact);
    for (const double asked : {1e-2, 1e-3, 1e-4, 1e-6}) {
      const Accuracy a = choose_accuracy(c.cloud.points(), asked);
      EXPECT_LE(a.error, asked) << c.name;
      Fmm method(a.settings);
      method.set_tolerance(a.factor * rms(exact));
      method.evaluate(c.cloud.points(), fast);
      EXPECT_LE(rms_error(fast, exact), 1.5 * asked) << c.name;
      EXPECT_LE(quantile_error(fast, exact, 0.999), 10.0 * asked) << c.name;
    }
  }
}

// A cube of a thousand glued points would pull its own points a million times as strongly as the grain beside
// it does.
TEST(Accuracy, NothingOfABodysOwnPullComesThrough) {
  Cloud cloud;
  cloud.add_group(cube(Vec3::Zero()), 1e6);
  add(cloud, {23.0, 9.0, 9.0}, 1e3);
  std::vector<Vec3> exact(cloud.size()), fast(cloud.size());
  DirectSum().evaluate(cloud.points(), exact);
  for (const double asked : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6}) {
    const Accuracy a = choose_accuracy(cloud.points(), asked);
    Fmm method(a.settings);
    method.set_tolerance(a.factor * rms(exact));
    method.evaluate(cloud.points(), fast);
    std::vector<Vec3> on_cube(fast.begin(), fast.end() - 1), exact_on_cube(exact.begin(), exact.end() - 1);
    EXPECT_LE(rms_error(on_cube, exact_on_cube), asked);
    EXPECT_LE(rms_error({fast.back()}, {exact.back()}), asked);
  }
}

TEST(Accuracy, ASmallerErrorTakesASmallerFactor) {
  const Cloud cloud = ball(kPoints);
  double before = 1e300;
  for (const double asked : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    const double factor = choose_accuracy(cloud.points(), asked).factor;
    EXPECT_LT(factor, before);
    before = factor;
  }
}

TEST(Accuracy, PointsThatDoNotAttract) {
  Cloud cloud;
  cloud.add_group({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1.0);  // one body
  const Accuracy one = choose_accuracy(cloud.points(), 1e-3);
  EXPECT_EQ(one.scale, 0.0);
  EXPECT_EQ(one.error, 0.0);
  cloud.add_group({{0, 0, 0}}, 0.0);  // massless, and where another one is
  EXPECT_EQ(choose_accuracy(cloud.points(), 1e-3).error, 0.0);
}

}  // namespace
}  // namespace cairn::gravity
