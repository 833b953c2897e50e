#include "analysis/fragments.h"

#include <gtest/gtest.h>

#include "unit/analysis/unit_sphere.h"

namespace cairn {
namespace {

using Labels = std::vector<std::uint32_t>;
using test::add_sphere;

// Three chains whose spheres are listed in turn; surfaces 0.1 apart within a chain.
TEST(Fragments, Chains) {
  Bodies bodies;
  for (int k = 0; k < 4; ++k) {
    add_sphere(bodies, Vec3(2.1 * k, 0.0, 0.0), 1.0, 1.0);
    add_sphere(bodies, Vec3(0.0, 50.0, 2.1 * k), 1.0, 3.0);
    if (k < 2) add_sphere(bodies, Vec3(0.0, -50.0 + 2.1 * k, 0.0), 1.0, 5.0);
  }
  const Fragments found = find_fragments(bodies, 0.11);
  EXPECT_EQ(found.label, (Labels{2, 0, 1, 2, 0, 1, 2, 0, 2, 0}));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found.mass[0], 12.0, 1e-12);
  EXPECT_NEAR(found.mass[1], 10.0, 1e-12);
  EXPECT_NEAR(found.mass[2], 4.0, 1e-12);
  EXPECT_EQ(found.count, (Labels{4, 2, 4}));
  EXPECT_EQ(found.members(1), (Labels{2, 5}));

  const Fragments loose = find_fragments(bodies, 0.09);
  EXPECT_EQ(loose.size(), bodies.size());
  EXPECT_EQ(loose.label, (Labels{6, 2, 0, 7, 3, 1, 8, 4, 9, 5}));  // equal masses by smallest body
}

TEST(Fragments, LinkThroughAnySphereOfABody) {
  Bodies bodies;
  add_sphere(bodies, Vec3(-4.05, 0.0, 0.0), 1.0, 1.0);
  Placement placement;
  placement.position = Vec3(-1.0, 0.0, 0.0);
  add_body(bodies, test::dumbbell(), 0, 1.0, 1.0, 0, placement);
  add_sphere(bodies, Vec3(2.05, 0.0, 0.0), 1.0, 1.0);
  EXPECT_EQ(find_fragments(bodies, 0.06).size(), 1u);
  EXPECT_EQ(find_fragments(bodies, 0.04).label, (Labels{1, 0, 2}));
}

TEST(Fragments, OfOneMassAreOrderedByTheirSmallestBody) {
  Bodies bodies;
  for (const double x : {0.0, 50.0, 52.1, 2.1}) add_sphere(bodies, Vec3(x, 0.0, 0.0), 1.0, 1.0);
  EXPECT_EQ(find_fragments(bodies, 0.2).label, (Labels{0, 1, 1, 0}));
}

TEST(Fragments, NoBodies) {
  EXPECT_EQ(find_fragments(Bodies{}, 0.1).size(), 0u);
}

}  // namespace
}  // namespace cairn
