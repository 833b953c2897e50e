#include "pile/lattice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/coordination.h"
#include "analysis/packing.h"
#include "analysis/spin_state.h"
#include "core/error.h"
#include "shape/library.h"

namespace cairn {
namespace {

RegionSpec ball(double radius) {
  RegionSpec spec;
  spec.radius = radius;
  spec.position = {30.0, -20.0, 10.0};
  spec.orientation = Quat(0.9, 0.1, -0.3, 0.2).normalized();
  return spec;
}

Bodies make(LatticeKind kind, const std::string& shape, const RegionSpec& region, bool turned = false) {
  const RigidShape rigid = make_rigid(load_shape(shape, "."), MassModel::union_volume);
  const LatticeSpec lattice{.kind = kind,
                            .shape = shape,
                            .size = 1.5,
                            .density = 2000.0,
                            .material = "",
                            .spacing = 0.0,
                            .random_orientation = turned,
                            .region = region,
                            .held = {},
                            .walls = {}};
  Bodies bodies;
  add_lattice(lattice, Region(region, InputFiles()), rigid, 0, 0, 1, 0, bodies);
  return bodies;
}

/// Neighbours that the innermost body touches.
std::size_t touching_the_middle(const Bodies& bodies, const Vec3& middle) {
  std::size_t centre = 0, count = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if ((bodies.position[b] - middle).norm() < (bodies.position[centre] - middle).norm()) centre = b;
  for (const Vec3& x : bodies.position) {
    const double d = (x - bodies.position[centre]).norm();
    EXPECT_TRUE(d == 0.0 || d > 3.0 * (1.0 - 1e-12)) << d;
    count += d > 0.0 && d < 3.0 * (1.0 + 1e-9);
  }
  return count;
}

TEST(Lattice, HasTheNeighboursAndThePackingOfItsKind) {
  struct Case {
    LatticeKind kind;
    std::size_t neighbours;
    double packing;
  };
  for (const auto& [kind, neighbours, packing] :
       {Case{LatticeKind::hcp, 12, kPi / std::sqrt(18.0)}, Case{LatticeKind::fcc, 12, kPi / std::sqrt(18.0)},
        Case{LatticeKind::sc, 6, kPi / 6.0}}) {
    const RegionSpec region = ball(36.0);
    const Bodies bodies = make(kind, "sphere", region);
    EXPECT_EQ(touching_the_middle(bodies, region.position), neighbours);
    const double expected = packing * std::pow(36.0 / 1.5, 3);
    EXPECT_NEAR(static_cast<double>(bodies.size()), expected, 0.02 * expected);
    EXPECT_LT((spin_state(bodies, all_bodies(bodies)).center - region.position).norm(), 0.5);
    const Packing inner = interior_packing(bodies, all_bodies(bodies), 25.0);
    EXPECT_GT(inner.bodies, 1000u);
    for (const double found : {inner.mean, inner.mean_radical, inner.total_radical})
      EXPECT_NEAR(found, packing, 1e-9);
  }
}

TEST(Lattice, OfAggregatesThatTurnAtRandomDoesNotOverlap) {
  const Bodies bodies = make(LatticeKind::fcc, "cube", ball(30.0), true);
  EXPECT_GT(bodies.size(), 50u);
  EXPECT_LT(coordination(bodies).largest_overlap, 1e-12);
  EXPECT_GT((bodies.orientation[0].coeffs() - bodies.orientation[1].coeffs()).norm(), 0.1);
}

TEST(Lattice, ThatHasNoSiteInTheRegionIsAnError) {
  RegionSpec region;
  region.kind = RegionKind::box;
  region.size = Vec3(1.0, 1e9, 1.0);
  EXPECT_THROW(make(LatticeKind::sc, "sphere", region), InputError);  // far too many
}

}  // namespace
}  // namespace cairn
