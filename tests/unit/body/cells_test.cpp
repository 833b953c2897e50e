#include "body/cells.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "shape/library.h"

namespace cairn {
namespace {

Bodies scattered(const Vec3& origin, const Vec3& velocity, int count) {
  const RigidShape shape = make_rigid(load_shape("diamond", "."), MassModel::union_volume);
  Bodies bodies;
  bodies.cell_edge = cell_edge(1.0);
  Random random(1, 0);
  for (int b = 0; b < count; ++b)
    add_body(bodies, shape, 0, 1.0, 2500.0, 0,
             {.position = 50.0 * random.in_ball(),
              .velocity = velocity + 0.0078125 * Vec3(b, -b, 2 * b),
              .origin = origin});
  return bodies;
}

TEST(Cells, EdgeIsAPowerOfTwoThatResolvesTheSmallestSphere) {
  for (const double radius : {1e-3, 0.7, 1.0, 3.9, 1e6}) {
    int exponent;
    EXPECT_EQ(std::frexp(cell_edge(radius), &exponent), 0.5);
    EXPECT_GT(cell_edge(radius), 0x1p12 * radius);
    EXPECT_LE(cell_edge(radius), 0x1p13 * radius);
    EXPECT_LT(kCellReach * cell_edge(radius) * 0x1p-53, 1e-12 * radius);
  }
}

TEST(Cells, BodiesNearTheZeroNeedNone) {
  Bodies bodies = scattered({1000.0, -3.0, 7.5}, Vec3::Zero(), 10);
  EXPECT_TRUE(bodies.cell.empty());
  const std::vector<Vec3> before = bodies.position;
  const Frame frame = take_frame(bodies);
  EXPECT_EQ(frame.position, Vec3(Vec3::Zero()));
  EXPECT_EQ(frame.velocity, Vec3(Vec3::Zero()));
  EXPECT_EQ(bodies.position, before);
}

TEST(Cells, FarBodiesKeepTheirMutualPlaces) {
  const Vec3 far(1.5e11, -7.77e10, 3.1e9);
  const Bodies near = scattered(Vec3::Zero(), Vec3::Zero(), 20), there = scattered(far, Vec3::Zero(), 20);
  ASSERT_EQ(there.cell.size(), 20u);
  for (std::size_t b = 0; b < 20; ++b) {
    EXPECT_LT((separation(there, 0, b) - separation(near, 0, b)).norm(), 2e-12);
    EXPECT_LT((place(there, b) - far - near.position[b]).norm(), 1e-4);  // what one double resolves there
  }
}

TEST(Cells, OneCellOfManyFarBodiesBecomesTheirFrame) {
  const Vec3 far(1.5e11, -7.77e10, 3.1e9), fast(3e4, -1e4, 10.0);
  Bodies bodies = scattered(far, fast, 21);
  const Bodies before = bodies;
  const Frame frame = take_frame(bodies);
  EXPECT_TRUE(bodies.cell.empty());
  EXPECT_LE((frame.position - far).cwiseAbs().maxCoeff(), 0.5 * kFrameStep * bodies.cell_edge + 50.0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_EQ(separation(bodies, 0, b), separation(before, 0, b));
    EXPECT_LE(bodies.velocity[b].cwiseAbs().maxCoeff(), 33.0);
    const double k = static_cast<double>(b);
    EXPECT_EQ(Vec3(frame.velocity + bodies.velocity[b]), Vec3(fast + 0.0078125 * Vec3(k, -k, 2 * k)));
  }
}

// A perturber far from the many does not drag the frame away from them.
TEST(Cells, FrameIsThatOfTheMany) {
  Bodies bodies = scattered(Vec3::Zero(), Vec3::Zero(), 20);
  add_body(bodies, make_rigid(load_shape("sphere", "."), MassModel::union_volume), 0, 1e6, 2500.0, 0,
           {.velocity = {-3e4, 0.0, 0.0}, .origin = {1.5e11, 0.0, 0.0}});
  EXPECT_EQ(take_frame(bodies).position, Vec3(Vec3::Zero()));
  EXPECT_EQ(bodies.cell[3], Vec3(Vec3::Zero()));
  EXPECT_NEAR(place(bodies, 20).x(), 1.5e11, 1e-4);
  EXPECT_EQ(bodies.velocity[20].x(), -3e4);
}

TEST(Cells, ChangeOfTheLatticeMovesNothing) {
  Bodies bodies = scattered({4e9, 5e8, -1e7}, Vec3::Zero(), 20);
  const Bodies before = bodies;
  for (const double edge : {0x1p18, 0x1p10, bodies.cell_edge}) {
    set_cell_edge(bodies, edge);
    for (std::size_t b = 0; b < 20; ++b) {
      EXPECT_LE(bodies.position[b].cwiseAbs().maxCoeff(), kCellReach * edge);
      EXPECT_LT((separation(bodies, 0, b) - separation(before, 0, b)).norm(), 1e-10);
      EXPECT_LT((place(bodies, b) - place(before, b)).norm(), 1e-5);
    }
  }
  set_cell_edge(bodies, 0.0);
  EXPECT_TRUE(bodies.cell.empty());
  EXPECT_LT((bodies.position[7] - place(before, 7)).norm(), 1e-5);
}

TEST(Cells, ABodyThatLeavesItsCellIsGivenANewOne) {
  Bodies bodies = scattered(Vec3::Zero(), Vec3::Zero(), 3);
  const double edge = bodies.cell_edge;
  bodies.position[1].x() = 0.74 * edge;
  settle_cells(bodies);
  EXPECT_TRUE(bodies.cell.empty());
  bodies.position[1].x() = 0.76 * edge;
  const Vec3 before = place(bodies, 1);
  settle_cells(bodies);
  ASSERT_EQ(bodies.cell.size(), 3u);
  EXPECT_EQ(bodies.cell[1], Vec3(1.0, 0.0, 0.0));
  EXPECT_EQ(place(bodies, 1), before);
  EXPECT_NEAR(bodies.position[1].x(), -0.24 * edge, 1e-9);
}

}  // namespace
}  // namespace cairn
