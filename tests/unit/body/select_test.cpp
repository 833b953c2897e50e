#include "body/select.h"

#include <gtest/gtest.h>

#include "shape/library.h"

namespace cairn {
namespace {

TEST(SelectBodies, KeepsTheMarkedOnesAndNumbersTheirSpheresAnew) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume),
                   rod = make_rigid(load_shape("dumbbell", "."), MassModel::union_volume);
  const auto add = [&](Bodies& bodies, int k) {
    add_body(bodies, k % 2 ? rod : ball, k % 2, 1.0 + k, 1000.0 + k, static_cast<std::uint16_t>(k),
             {.position = {10.0 * k, 0.0, 0.0}, .velocity = {0.0, 1.0 * k, 0.0}});
  };
  Bodies all, some;
  for (int k = 0; k < 5; ++k) add(all, k);
  for (const int k : {1, 2, 4}) add(some, k);
  const std::vector<std::uint32_t> number = select_bodies(all, {0, 1, 1, 0, 1});
  EXPECT_EQ(number, (std::vector<std::uint32_t>{kGone, 0, 1, 2, kGone, kGone, 3}));
  EXPECT_EQ(all.first_sphere, some.first_sphere);
  EXPECT_EQ(all.mass, some.mass);
  EXPECT_EQ(all.volume, some.volume);
  EXPECT_EQ(all.inertia, some.inertia);
  EXPECT_EQ(all.material, some.material);
  EXPECT_EQ(all.position, some.position);
  EXPECT_EQ(all.velocity, some.velocity);
  EXPECT_EQ(all.spheres.body, some.spheres.body);
  EXPECT_EQ(all.spheres.radius, some.spheres.radius);
  EXPECT_EQ(all.spheres.position, some.spheres.position);
  EXPECT_TRUE(all.cell.empty());
  for (const std::size_t size : {all.remainder.size(), all.spin.size(), all.orientation.size(),
                                 all.shape.size(), all.length.size(), all.force.size(), all.torque.size()})
    EXPECT_EQ(size, 3u);
}

}  // namespace
}  // namespace cairn
