#include "analysis/packing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/coordination.h"
#include "analysis/spin_state.h"
#include "shape/library.h"

namespace cairn {
namespace {

/// n^3 bodies on a cubic lattice; layers across z have either size in turn.
Bodies cubic(const std::string& shape, int n, double spacing, double size, double other) {
  const RigidShape rigid = make_rigid(load_shape(shape, "."), MassModel::union_volume);
  Bodies bodies;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        add_body(bodies, rigid, 0, k % 2 ? other : size, 1000.0, 0, {.position = spacing * Vec3(i, j, k)});
  return bodies;
}

TEST(Packing, OfLayersOfTwoSizesHasTheCellsOfTheRadicalPlanes) {
  const double d = 2.0, a = 0.9, b = 0.6;
  const Bodies bodies = cubic("sphere", 9, d, a, b);
  const Packing p = interior_packing(bodies, all_bodies(bodies), 1.01 * d);
  ASSERT_EQ(p.bodies, 7u);  // five of the middle layer, of size a, and one of the layer on either side
  const auto ball = [](double r) { return 4.0 / 3.0 * kPi * r * r * r; };
  EXPECT_NEAR(p.mean, (5.0 * ball(a) + 2.0 * ball(b)) / 7.0 / (d * d * d), 1e-12);
  // The plane between unlike neighbours is (d^2 + a^2 - b^2) / 2d from the centre of a.
  const double cell_a = d * (d * d + a * a - b * b), cell_b = d * (d * d + b * b - a * a);
  EXPECT_NEAR(p.mean_radical, (5.0 * ball(a) / cell_a + 2.0 * ball(b) / cell_b) / 7.0, 1e-12);
  EXPECT_NEAR(p.total, p.mean, 1e-12);  // all plain cells are equal
  EXPECT_NEAR(p.total_radical, (5.0 * ball(a) + 2.0 * ball(b)) / (5.0 * cell_a + 2.0 * cell_b), 1e-12);
}

TEST(Packing, OfAggregatesCountsWhatTheirSpheresShareOnce) {
  const Bodies bodies = cubic("cube", 7, 6.0, 1.0, 1.0);
  const Packing p = interior_packing(bodies, all_bodies(bodies), 7.0);
  ASSERT_EQ(p.bodies, 7u);
  EXPECT_NEAR(p.mean, bodies.volume[0] / 216.0, 1e-12);
  EXPECT_NEAR(p.total_radical, bodies.volume[0] / 216.0, 1e-12);
}

TEST(Packing, IsNotANumberWhereThereIsNoBody) {
  const Bodies bodies = cubic("sphere", 2, 3.0, 1.0, 1.0);
  EXPECT_TRUE(std::isnan(interior_packing(bodies, all_bodies(bodies), 0.1).mean));
}

TEST(Coordination, CountsContactsOfALattice) {
  const Bodies balls = cubic("sphere", 4, 2.0, 1.0, 1.0);
  const Coordination c = coordination(balls);
  EXPECT_EQ(c.contacts, 3u * 4 * 4 * 3);
  EXPECT_EQ(c.body_pairs, c.contacts);
  EXPECT_NEAR(c.per_sphere, 2.0 * 144 / 64, 1e-15);
  EXPECT_EQ(c.free_bodies, 0u);
  const Bodies apart = cubic("sphere", 4, 2.01, 1.0, 1.0);
  EXPECT_EQ(coordination(apart).free_bodies, 64u);

  // Cubes of eight balls face to face: four contacts for each of their pairs.
  const Bodies cubes = cubic("cube", 3, 1.0, 1.0, 1.0);
  double width = 0.0;
  for (std::uint32_t s = 0; s < cubes.first_sphere[1]; ++s)
    width = std::max(width, 2.0 * (cubes.spheres.offset[s].cwiseAbs().maxCoeff() + cubes.spheres.radius[s]));
  const Coordination faces = coordination(cubic("cube", 3, width * (1.0 - 1e-6), 1.0, 1.0));
  EXPECT_EQ(faces.body_pairs, 54u);
  EXPECT_EQ(faces.contacts, 4u * 54u);
  EXPECT_NEAR(faces.per_body, 8.0 * faces.per_sphere, 1e-12);
  EXPECT_NEAR(faces.neighbours, 4.0, 1e-12);
  EXPECT_NEAR(faces.largest_overlap, width * 1e-6, 1e-9);
}

}  // namespace
}  // namespace cairn
