#include "analysis/axes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/spin_state.h"
#include "core/error.h"
#include "unit/analysis/unit_sphere.h"

namespace cairn {
namespace {

// A turned box of 9 x 6 x 4 spheres of radius 1, spaced by 2.
TEST(AxisLengths, BoxOfSpheres) {
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -0.5).normalized()));
  Bodies bodies;
  for (int x = 0; x < 9; ++x)
    for (int y = 0; y < 6; ++y)
      for (int z = 0; z < 4; ++z)
        test::add_sphere(bodies, Vec3(100.0, -40.0, 3.0) + turn * Vec3(2 * y, 2 * x, 2 * z), 1.0, 1.0);
  const auto set = all_bodies(bodies);
  const AxisLengths box = axis_lengths(bodies, set);
  EXPECT_NEAR(box.a, 18.0, 1e-11);
  EXPECT_NEAR(box.b, 12.0, 1e-11);
  EXPECT_NEAR(box.c, 8.0, 1e-11);
  EXPECT_NEAR(box.b_over_a(), 12.0 / 18.0, 1e-12);
  EXPECT_NEAR(box.c_over_a(), 8.0 / 18.0, 1e-12);
  EXPECT_NEAR(std::abs(box.axes.col(0).dot(turn * Vec3::UnitY())), 1.0, 1e-12);
  EXPECT_NEAR(std::abs(box.axes.col(2).dot(turn * Vec3::UnitZ())), 1.0, 1e-12);

  // An escaping grain belongs to the system, not to the remnant.
  test::add_sphere(bodies, Vec3(1e4, 0.0, 0.0), 1.0, 1.0);
  EXPECT_EQ(axis_lengths(bodies, set).a, box.a);
  EXPECT_GT(axis_lengths(bodies, all_bodies(bodies)).a, 9e3);
}

// The heavy pair along y has the smallest inertia about y, yet the light pair along x reaches farther.
TEST(AxisLengths, SortedByLength) {
  Bodies bodies;
  for (const double side : {-1.0, 1.0}) {
    test::add_sphere(bodies, Vec3(0.0, 5.0 * side, 0.0), 1.0, 100.0);
    test::add_sphere(bodies, Vec3(8.0 * side, 0.0, 0.0), 1.0, 1.0);
  }
  const AxisLengths lengths = axis_lengths(bodies, all_bodies(bodies));
  EXPECT_NEAR(lengths.a, 18.0, 1e-12);
  EXPECT_NEAR(lengths.b, 12.0, 1e-12);
  EXPECT_NEAR(lengths.c, 2.0, 1e-12);
  EXPECT_NEAR(std::abs(lengths.axes(0, 0)), 1.0, 1e-12);
  EXPECT_NEAR(lengths.axes.determinant(), 1.0, 1e-12);
}

TEST(AxisLengths, SingleBodies) {
  Bodies bodies;
  test::add_sphere(bodies, Vec3(7.0, 8.0, 9.0), 3.0, 1.0);
  Placement placement;
  placement.orientation = Quat(Eigen::AngleAxisd(1.0, Vec3::UnitZ()));
  add_body(bodies, test::dumbbell(), 0, 2.0, 1.0, 0, placement);
  const AxisLengths ball = axis_lengths(bodies, std::vector{0u});
  EXPECT_NEAR(ball.a, 6.0, 1e-14);
  EXPECT_NEAR(ball.c, 6.0, 1e-14);
  const AxisLengths pair = axis_lengths(bodies, std::vector{1u});
  EXPECT_NEAR(pair.a, 8.0, 1e-12);
  EXPECT_NEAR(pair.b, 4.0, 1e-12);
  EXPECT_NEAR(pair.c, 4.0, 1e-12);
  EXPECT_THROW(axis_lengths(bodies, {}), InputError);
}

}  // namespace
}  // namespace cairn
