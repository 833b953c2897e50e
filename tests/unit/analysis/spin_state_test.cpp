#include "analysis/spin_state.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "unit/analysis/unit_sphere.h"

namespace cairn {
namespace {

using test::add_sphere;

// Spheres and dumbbells turning together with w about a point that moves with v.
Bodies turning_pile(const Vec3& w, const Vec3& center, const Vec3& v) {
  Bodies bodies;
  Random random(11, 0);
  for (int k = 0; k < 2000; ++k) {
    const Vec3 arm = random.in_ball().cwiseProduct(Vec3(40.0, 30.0, 20.0));
    Placement placement;
    placement.position = center + arm;
    placement.orientation = random.rotation();
    placement.velocity = v + w.cross(arm);
    placement.angular_velocity = w;
    add_body(bodies, k % 2 ? test::dumbbell() : test::unit_sphere(), 0, random.uniform(0.5, 2.0), 2000.0, 0,
             placement);
  }
  return bodies;
}

TEST(SpinState, RigidRotationComesBack) {
  const Vec3 w(3e-5, -2e-4, 7.7e-4), v(0.02, -0.5, 0.1);
  const Bodies bodies = turning_pile(w, Vec3::Zero(), v);
  const auto set = all_bodies(bodies);
  const SpinState state = spin_state(bodies, set);
  EXPECT_LT((rotation_rate(state) - w).norm(), 1e-13 * w.norm());
  EXPECT_LT((state.velocity - (v + w.cross(state.center))).norm(), 1e-13);
  EXPECT_LT((state.angular_momentum - state.inertia * w).norm(), 1e-13 * state.angular_momentum.norm());
}

TEST(SpinState, FarFromTheOrigin) {
  const Vec3 w(0.0, 0.0, 7.7e-4), center(1e8, -2e8, 3e8);
  const SpinState near = spin_state(turning_pile(w, Vec3::Zero(), Vec3::Zero()), std::vector{0u, 1u, 2u, 3u});
  const SpinState far = spin_state(turning_pile(w, center, Vec3::Zero()), std::vector{0u, 1u, 2u, 3u});
  EXPECT_LT((far.center - center - near.center).norm(), 2e-7);  // the resolution of a double at 3e8
  EXPECT_LT((far.inertia - near.inertia).norm(), 1e-7 * near.inertia.norm());
}

TEST(SpinState, SubsetIgnoresTheRest) {
  Bodies bodies = turning_pile(Vec3(0.0, 0.0, 1e-3), Vec3::Zero(), Vec3::Zero());
  const auto set = all_bodies(bodies);
  const SpinState alone = spin_state(bodies, set);
  add_sphere(bodies, Vec3(1e5, 0.0, 0.0), 10.0, 1e9, Vec3(0.0, 5.0, 0.0));
  const SpinState subset = spin_state(bodies, set);
  EXPECT_EQ(subset.mass, alone.mass);
  EXPECT_EQ(subset.center, alone.center);
  EXPECT_EQ(subset.angular_momentum, alone.angular_momentum);
  EXPECT_THROW(spin_state(bodies, {}), InputError);
}

// Two unit spheres 4 m apart: I = 2 (2/5) m along the line, plus 2 m 2^2 across it.
TEST(SpinState, TwoSpheres) {
  Bodies bodies;
  const double m = 3.0, w = 0.25;
  for (const double side : {-1.0, 1.0})
    add_sphere(bodies, Vec3(2.0 * side, 0.0, 0.0), 1.0, m, Vec3(0.0, 2.0 * w * side, 0.0), Vec3(0.0, 0.0, w));
  const SpinState state = spin_state(bodies, all_bodies(bodies));
  const double along = 0.8 * m, across = along + 8.0 * m;
  const PrincipalAxes principal = principal_axes(state.inertia);
  EXPECT_LT((principal.moments - Vec3(along, across, across)).norm(), 1e-13 * across);
  EXPECT_NEAR(std::abs(principal.axes(0, 0)), 1.0, 1e-15);
  EXPECT_NEAR(principal.axes.determinant(), 1.0, 1e-14);
  EXPECT_NEAR(spin_period(state, Vec3(0.0, 0.0, 2.0)), 2.0 * kPi / w, 1e-12);
  EXPECT_NEAR(spin_period(state, Vec3(0.0, 0.0, -1.0)), -2.0 * kPi / w, 1e-12);
  EXPECT_EQ(spin_period(state, Vec3::UnitX()), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(wobble(state), 0.0, 1e-12);  // L lies in the plane of the two equal largest moments
}

TEST(SpinState, WobbleIsTheAngleToTheShortestAxis) {
  const double angle = 0.3;
  SpinState state;
  state.inertia = Vec3(1.0, 2.0, 3.0).asDiagonal();
  state.angular_momentum = 5.0 * Vec3(std::sin(angle), 0.0, std::cos(angle));
  EXPECT_NEAR(wobble(state), angle, 1e-14);
  state.angular_momentum = -state.angular_momentum;
  EXPECT_NEAR(wobble(state), angle, 1e-14);
  state.angular_momentum.setZero();
  EXPECT_EQ(wobble(state), 0.0);
}

// Any axis across a line of bodies is one of largest inertia, also when round-off tells two of them apart.
TEST(SpinState, RotationAcrossALineDoesNotWobble) {
  Random random(4, 0);
  for (int k = 0; k < 20; ++k) {
    const Mat3 axes = random.rotation().toRotationMatrix();
    SpinState state;
    state.inertia = axes * Vec3(1.0, 2.0, 2.0).asDiagonal() * axes.transpose();
    const double angle = random.uniform(0.0, kPi);
    state.angular_momentum = axes * Vec3(0.0, std::cos(angle), std::sin(angle));
    EXPECT_LT(wobble(state), 1e-9);
  }
}

TEST(SpinState, SingleBody) {
  Bodies bodies;
  const Vec3 w(0.1, 0.2, -0.3);
  add_sphere(bodies, Vec3(5.0, 6.0, 7.0), 2.0, 9.0, Vec3(1.0, 0.0, 0.0), w);
  const SpinState state = spin_state(bodies, all_bodies(bodies));
  EXPECT_EQ(state.center, bodies.position[0]);
  EXPECT_EQ(state.velocity, bodies.velocity[0]);
  EXPECT_LT((rotation_rate(state) - w).norm(), 1e-15);
  EXPECT_NEAR(wobble(state), 0.0, 1e-15);
  EXPECT_NEAR(spin_period(state, w), 2.0 * kPi / w.norm(), 1e-13);
}

// A line of points has no inertia about itself; nothing may turn into NaN.
TEST(SpinState, DirectionsWithoutInertia) {
  SpinState state;
  state.mass = 1.0;
  state.inertia = Vec3(0.0, 2.0, 2.0).asDiagonal();
  state.angular_momentum = Vec3(0.0, 4.0, 0.0);
  EXPECT_LT((rotation_rate(state) - Vec3(0.0, 2.0, 0.0)).norm(), 1e-15);
  EXPECT_TRUE(std::isinf(spin_period(state, Vec3::UnitX())));
  state.inertia.setZero();
  EXPECT_EQ(rotation_rate(state), Vec3::Zero());
  EXPECT_TRUE(std::isfinite(wobble(state)));
}

}  // namespace
}  // namespace cairn
