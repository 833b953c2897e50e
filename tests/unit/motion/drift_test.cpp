#include "motion/drift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "shape/library.h"

namespace cairn {
namespace {

TEST(Drift, FreeBodiesMoveByTheirVelocityHoweverManySteps) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  Bodies bodies;
  Random random(6, 0);
  std::vector<Vec3> start;
  for (int k = 0; k < 50; ++k) {
    start.push_back(100.0 * random.in_ball());
    add_body(bodies, ball, 0, 1.0, 1.0, 0, {.position = start.back(), .velocity = 1e-3 * random.in_ball()});
  }
  constexpr double dt = 1e-3;
  constexpr int steps = 200000;
  std::vector<Vec3> spin_mid;
  for (int k = 0; k < steps; ++k) drift(bodies, dt, spin_mid);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vec3 way = (dt * bodies.velocity[b]) * steps;
    // Places of 100 m are told to 1.4e-14 m; steps rounded one by one go astray by up to 1e-9.
    EXPECT_LT((bodies.position[b] - (start[b] + way)).norm(), 5e-14) << b;
    EXPECT_LT(bodies.remainder[b].norm(), 2e-14) << b;
  }
}

TEST(Drift, ASphereThatStandsForANeedleTurnsAsTheNeedle) {
  RigidShape shape = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  ASSERT_EQ(shape.inertia.x(), shape.inertia.z());
  shape.inertia = {0.1, 0.5, 0.6};
  const Quat attitude = Random(8, 0).rotation();
  Bodies bodies;
  add_body(bodies, shape, 0, 1.0, 1.0, 0, {.orientation = attitude, .angular_velocity = {0.3, 0.2, -0.1}});
  const Quat before = bodies.orientation[0];
  const Vec3 momentum = bodies.spin[0];
  std::vector<Vec3> spin_mid;
  drift(bodies, 0.5, spin_mid);
  const Quat expected = rotate_free_top(before, momentum, bodies.inertia[0], 0.5);
  EXPECT_LT(bodies.orientation[0].angularDistance(expected), 1e-15);
  EXPECT_GT(bodies.orientation[0].angularDistance(before), 0.1);
  EXPECT_LT((spin_mid[0] - angular_velocity(bodies, 0)).norm(), 0.1 * spin_mid[0].norm());
}

TEST(Drift, BodiesTurnAboutAPrincipalAxisByTheWholeAngle) {
  const RigidShape slab = make_rigid(load_shape("slab", "."), MassModel::spheres),
                   ball = make_rigid(load_shape("sphere", "."), MassModel::spheres);
  constexpr double dt = 0.25;
  Bodies bodies;
  std::vector<Vec3> about;  // axis in space times angle
  Random random(7, 0);
  for (const RigidShape& shape : {slab, ball})
    for (const double angle : {1e-6, 0.01, 0.3, 0.5, 1.5, 2.5})
      for (int axis = 0; axis < 3; ++axis) {
        const Quat attitude = random.rotation();
        about.push_back(angle * (attitude * shape.axes * Vec3::Unit(axis)));
        add_body(bodies, shape, 0, 1.0, 1.0, 0,
                 {.orientation = attitude, .angular_velocity = about.back() / dt});
      }
  const std::vector<Quat> before = bodies.orientation;
  std::vector<Vec3> spin_mid;
  drift(bodies, dt, spin_mid);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double angle = about[b].norm();
    const Vec3 axis = about[b] / angle, rate = 2.0 / dt * std::tan(0.5 * angle) * axis;
    EXPECT_LT((spin_mid[b] - rate).norm(), 1e-14 * rate.norm()) << b;
    const Quat alone = rotate_free_top(before[b], bodies.spin[b], bodies.inertia[b], dt);
    const Quat turned = Quat(Eigen::AngleAxisd(angle, axis)) * before[b];
    EXPECT_NEAR(std::abs(alone.dot(turned)), 1.0, 2e-15) << b;
    EXPECT_LT((alone.conjugate() * turned).vec().norm(), 2e-15) << b;
    EXPECT_LT((bodies.orientation[b].conjugate() * turned).vec().norm(), 2e-15) << b;
  }
}

TEST(Drift, FreeBallsHaveTheAttitudeOfTheClosedForm) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::spheres),
                   cube = make_rigid(load_shape("cube", "."), MassModel::spheres);  // its moments are equal
  ASSERT_NEAR(cube.inertia.x(), cube.inertia.z(), 1e-15);
  constexpr double dt = 1e-3;
  constexpr int steps = 100000;
  Bodies bodies;
  Random random(11, 0);
  std::vector<Vec3> rate;
  for (int k = 0; k < 21; ++k) {  // in neither kind a multiple of eight, one after the other
    rate.push_back(std::pow(10.0, random.uniform(-3.0, 1.0)) * random.direction());
    const Quat attitude = random.rotation();
    for (const RigidShape& shape : {ball, cube})
      add_body(bodies, shape, 0, 1.0, 1.0, 0, {.orientation = attitude, .angular_velocity = rate.back()});
  }
  const std::vector<Quat> before = bodies.orientation;
  std::vector<Vec3> spin_mid;
  for (int k = 0; k < steps; ++k) drift(bodies, dt, spin_mid);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double speed = rate[b / 2].norm(), time = dt * steps;
    const Quat exact = Quat(Eigen::AngleAxisd(speed * time, rate[b / 2] / speed)) * before[b];
    const double off = 2.0 * (bodies.orientation[b].conjugate() * exact).vec().norm();
    EXPECT_NEAR(bodies.orientation[b].norm(), 1.0, 1e-15);
    if (b % 2 == 0)  // a ball: to rounding, which adds up from step to step
      EXPECT_LT(off, 1e-11) << b;
    else  // what is glued of spheres: to second order in the angle of a step
      EXPECT_LT(off, 0.1 * std::pow(speed * dt, 2) * (1.0 + speed * time) + 1e-11) << b;
  }
}

}  // namespace
}  // namespace cairn
