#include "body/bodies.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace cairn {
namespace {

/// Two unequal spheres; the principal frame is turned against that of the shape file.
RigidShape lopsided() {
  RigidShape shape;
  shape.volume = 7.0;
  shape.inertia = {0.3, 0.8, 1.0};
  shape.axes = Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, -2.0, 0.5).normalized()));
  shape.offsets = {Vec3(-0.5, 0.1, 0.0), Vec3(1.0, -0.2, 0.3)};
  shape.radii = {1.5, 0.75};
  shape.mass_fractions = {0.7, 0.3};
  return shape;
}

/// Two of them, the second one of size 2 and density 10 kg/m^3 at a random pose.
struct Two {
  RigidShape shape = lopsided();
  Placement placement;
  Bodies bodies;

  Two() {
    Random random(5, 0);
    placement = {.position = {3.0, -4.0, 5.0},
                 .orientation = random.rotation(),
                 .velocity = {0.1, 0.2, 0.3},
                 .angular_velocity = {-0.4, 0.5, 0.6}};
    add_body(bodies, shape, 4, 1.0, 1.0, 0, {});
    add_body(bodies, shape, 6, 2.0, 10.0, 3, placement);
  }
};

TEST(AddBody, ScalesTheShapeWithSizeAndDensity) {
  const Two two;
  const Bodies& bodies = two.bodies;
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies.first_sphere, (std::vector<std::uint32_t>{0, 2, 4}));
  EXPECT_EQ(bodies.shape[1], 6u);
  EXPECT_EQ(bodies.material[1], 3u);
  EXPECT_EQ(bodies.length[1], 2.0);
  EXPECT_DOUBLE_EQ(bodies.mass[1], 10.0 * 7.0 * 8.0);
  EXPECT_LT((bodies.inertia[1] - bodies.mass[1] * 4.0 * two.shape.inertia).norm(), 1e-12);
  EXPECT_EQ(bodies.velocity[1], two.placement.velocity);
  const Spheres& s = bodies.spheres;
  EXPECT_EQ(s.body, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  EXPECT_DOUBLE_EQ(s.radius[2], 3.0);
  EXPECT_DOUBLE_EQ(s.radius[3], 1.5);
  EXPECT_DOUBLE_EQ(s.mass[2], 0.7 * bodies.mass[1]);
  EXPECT_DOUBLE_EQ(s.mass[3], 0.3 * bodies.mass[1]);
}

TEST(AddBody, OrientationIsThatOfTheShapeFile) {
  const Two two;
  const Mat3 to_space = two.placement.orientation.toRotationMatrix() * two.shape.axes.toRotationMatrix();
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3 center = two.placement.position + 2.0 * (to_space * two.shape.offsets[k]);
    EXPECT_LT((two.bodies.spheres.position[2 + k] - center).norm(), 1e-14);
  }
}

TEST(Bodies, SpinIsTheInertiaTimesTheAngularVelocity) {
  const Two two;
  const Mat3 axes = (two.placement.orientation * two.shape.axes).toRotationMatrix();
  const Mat3 inertia = axes * two.bodies.inertia[1].asDiagonal() * axes.transpose();
  const Vec3& w = two.placement.angular_velocity;
  const Vec3 spin = inertia * w;
  EXPECT_LT((two.bodies.spin[1] - spin).norm(), 1e-14 * spin.norm());
  EXPECT_LT((angular_velocity(two.bodies, 1) - w).norm(), 1e-14);
  EXPECT_LT((inverse_inertia(two.bodies, 1) * inertia - Mat3::Identity()).norm(), 1e-14);
}

TEST(PlaceSpheres, FollowsTheBodies) {
  Two two;
  Bodies& bodies = two.bodies;
  const std::vector<Vec3> before = bodies.spheres.position;
  const Quat turn(Eigen::AngleAxisd(1.1, Vec3(0.2, 0.3, -1.0).normalized()));
  const Vec3 shift(7.0, 8.0, -9.0), pivot = bodies.position[1];
  bodies.orientation[1] = turn * bodies.orientation[1];
  bodies.position[1] += shift;
  place_spheres(bodies);
  for (std::size_t s : {0, 1}) EXPECT_LT((bodies.spheres.position[s] - before[s]).norm(), 1e-15);
  for (std::size_t s : {2, 3}) {
    const Vec3 moved = pivot + shift + turn * Vec3(before[s] - pivot);
    EXPECT_LT((bodies.spheres.position[s] - moved).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace cairn
