#include "motion/spin.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "shape/library.h"

namespace cairn {
namespace {

TEST(SpinPath, IsLinearBetweenPointsAndConstantOutside) {
  const std::vector<SpinPoint> path{{100.0, 18000.0}, {200.0, 10000.0}, {300.0, 10000.0}, {500.0, 8000.0}};
  EXPECT_EQ(period_at(path, 0.0), 18000.0);
  EXPECT_EQ(period_at(path, 50.0), 18000.0);
  EXPECT_EQ(period_at(path, 100.0), 18000.0);
  EXPECT_DOUBLE_EQ(period_at(path, 125.0), 16000.0);
  EXPECT_EQ(period_at(path, 200.0), 10000.0);
  EXPECT_EQ(period_at(path, 250.0), 10000.0);
  EXPECT_DOUBLE_EQ(period_at(path, 450.0), 8500.0);
  EXPECT_EQ(period_at(path, 1e9), 8000.0);
}

Bodies moving_pile() {
  const RigidShape shape = make_rigid(load_shape("l_shape", "."), MassModel::union_volume);
  Bodies bodies;
  Random random(1, 0);
  for (int b = 0; b < 60; ++b)
    add_body(bodies, shape, 0, random.uniform(1.0, 3.0), 2500.0, 0,
             {.position = Vec3(5.0, -3.0, 8.0) + 40.0 * random.in_ball(),
              .orientation = random.rotation(),
              .velocity = Vec3(0.3, 0.1, 0.0) + 0.02 * random.in_ball(),
              .angular_velocity = 0.01 * random.in_ball()});
  return bodies;
}

struct Whole {
  double mass = 0.0, inertia = 0.0, energy = 0.0;
  Vec3 center = Vec3::Zero(), momentum = Vec3::Zero(), angular = Vec3::Zero();
};

/// Sums over the members, in the plainest way.
Whole whole(const Bodies& bodies, const std::vector<std::uint8_t>& members) {
  Whole w;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!members[b]) continue;
    w.mass += bodies.mass[b];
    w.center += bodies.mass[b] * bodies.position[b];
    w.momentum += bodies.mass[b] * bodies.velocity[b];
    w.energy += 0.5 * bodies.mass[b] * bodies.velocity[b].squaredNorm() +
                0.5 * bodies.spin[b].dot(angular_velocity(bodies, b));
  }
  w.center /= w.mass;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!members[b]) continue;
    const Vec3 x = bodies.position[b] - w.center;
    w.angular += bodies.mass[b] * x.cross(bodies.velocity[b] - w.momentum / w.mass) + bodies.spin[b];
    w.inertia +=
        bodies.mass[b] * (x.x() * x.x() + x.y() * x.y()) + inverse_inertia(bodies, b).inverse()(2, 2);
  }
  return w;
}

TEST(ImposePeriod, GivesThePeriodExactlyAndNoMomentum) {
  Bodies bodies = moving_pile();
  std::vector<std::uint8_t> members(bodies.size(), 1);
  for (std::size_t b = 0; b < bodies.size(); b += 7) members[b] = 0;
  const Bodies before = bodies;
  const Whole was = whole(before, members);
  const SpinCorrection done = impose_period(bodies, members, 9000.0);
  const Whole is = whole(bodies, members);

  EXPECT_NEAR(2.0 * kPi * is.inertia / is.angular.z(), 9000.0, 1e-9);
  EXPECT_LT((is.momentum - was.momentum).norm(), 1e-13 * was.momentum.norm());
  EXPECT_LT((is.angular - was.angular - done.momentum).norm(), 1e-11 * is.angular.norm());
  EXPECT_NEAR(done.work, is.energy - was.energy, 1e-11 * is.energy);
  const double change = 2.0 * kPi / 9000.0 - was.angular.z() / was.inertia;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_EQ(bodies.position[b], before.position[b]);
    if (members[b]) {  // a rigid rotation: every body gains the same angular velocity about the mass centre
      EXPECT_LT((angular_velocity(bodies, b) - angular_velocity(before, b) - Vec3(0.0, 0.0, change)).norm(),
                1e-15);
      const Vec3 gain = change * Vec3::UnitZ().cross(Vec3(bodies.position[b] - was.center));
      EXPECT_LT((bodies.velocity[b] - before.velocity[b] - gain).norm(), 1e-14);
    } else {
      EXPECT_EQ(bodies.velocity[b], before.velocity[b]);
      EXPECT_EQ(bodies.spin[b], before.spin[b]);
    }
  }
}

TEST(ImposePeriod, ChangesNothingOnceThePeriodIsRight) {
  Bodies bodies = moving_pile();
  const std::vector<std::uint8_t> members(bodies.size(), 1);
  impose_period(bodies, members, 9000.0);
  const double momentum = whole(bodies, members).angular.norm();
  EXPECT_LT(impose_period(bodies, members, 9000.0).momentum.norm(), 1e-12 * momentum);
}

}  // namespace
}  // namespace cairn
