#include "motion/drift.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace cairn
