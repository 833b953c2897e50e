#include "analysis/budget.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "unit/analysis/unit_sphere.h"

namespace cairn {
namespace {

using test::add_sphere;

TEST(Budget, TwoBodies) {
  Bodies bodies;
  const Vec3 w(0.0, 0.0, 4.0);
  add_sphere(bodies, Vec3(1.0, 0.0, 0.0), 1.0, 2.0, Vec3(0.0, 3.0, 0.0), w);  // 2/5 m r^2 = 0.8
  add_sphere(bodies, Vec3(-2.0, 0.0, 0.0), 0.5, 6.0, Vec3(0.0, -2.0, 0.0));
  const Budget total = budget(bodies);
  EXPECT_NEAR(total.mass, 8.0, 1e-14);
  EXPECT_LT((total.center - Vec3(-1.25, 0.0, 0.0)).norm(), 1e-14);
  EXPECT_LT((total.momentum - Vec3(0.0, -6.0, 0.0)).norm(), 1e-14);
  EXPECT_NEAR(total.momentum_scale, 18.0, 1e-13);
  const double spin = 0.8 * 4.0;
  EXPECT_LT((total.angular_momentum_about_origin - Vec3(0.0, 0.0, 6.0 + 24.0 + spin)).norm(), 1e-13);
  EXPECT_NEAR(total.angular_scale_about_origin, 6.0 + 24.0 + spin, 1e-13);
  // Reduced mass 1.5, separation 3, relative speed 5.
  EXPECT_LT((total.angular_momentum_about_center - Vec3(0.0, 0.0, 22.5 + spin)).norm(), 1e-13);
  EXPECT_NEAR(total.angular_scale_about_center, 22.5 + spin, 1e-13);
  EXPECT_NEAR(total.translational_energy, 9.0 + 12.0, 1e-13);
  EXPECT_NEAR(total.rotational_energy, 0.5 * 0.8 * 16.0, 1e-13);
}

// A thousand bodies and their exact opposites, with a small one that a plain sum would lose.
TEST(Budget, CancellationKeepsTheRest) {
  Bodies bodies;
  Random random(3, 0);
  std::vector<std::pair<Vec3, Vec3>> half;
  for (int k = 0; k < 1000; ++k) half.emplace_back(100.0 * random.in_ball(), 1e8 * random.in_ball());
  for (const auto& [x, v] : half) add_sphere(bodies, x, 1.0, 1.0, v);
  add_sphere(bodies, Vec3(3.0, 0.0, 0.0), 1.0, 1.0, Vec3(0.0, 1e-7, 0.0));
  for (const auto& [x, v] : half) add_sphere(bodies, x, 1.0, 1.0, -v);
  const Budget total = budget(bodies);
  EXPECT_LT((total.momentum - bodies.mass[0] * Vec3(0.0, 1e-7, 0.0)).norm(), 1e-16);
  EXPECT_NEAR(total.angular_momentum_about_origin.z(), 3e-7 * bodies.mass[0], 1e-16);
}

TEST(Budget, Nothing) {
  EXPECT_EQ(budget(Bodies{}).mass, 0.0);
}

}  // namespace
}  // namespace cairn
