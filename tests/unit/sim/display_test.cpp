#include "sim/display.h"

#include <gtest/gtest.h>

#include "shape/library.h"

namespace cairn {
namespace {

TEST(Display, SpheresGoWithTheirBody) {
  const RigidShape rod = make_rigid(load_shape("rod4", "."), MassModel::union_volume);
  State state;
  const Vec3 velocity(1.0, -2.0, 0.5), spin(0.3, 0.2, -0.4);
  add_body(state.bodies, rod, 0, 2.0, 1000.0, 0,
           {.position = {3.0, 4.0, 5.0},
            .orientation = Quat(0.5, 0.5, -0.5, 0.5),
            .velocity = velocity,
            .angular_velocity = spin});
  const Display out = make_display(state, {1});
  ASSERT_EQ(out.spheres.size(), 4u);
  EXPECT_EQ(out.origin, Vec3(0, 0, 0));
  EXPECT_EQ(out.bodies[0], Vec3(3.0, 4.0, 5.0));
  for (std::size_t s = 0; s < 4; ++s) {
    const Vec3& x = state.bodies.spheres.position[s];
    EXPECT_LT((out.spheres[s].cast<double>() - x).norm(), 1e-6);
    const Vec3 expected = velocity + spin.cross(x - Vec3(3.0, 4.0, 5.0));
    EXPECT_LT((out.velocities[s].cast<double>() - expected).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace cairn
