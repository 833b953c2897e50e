// Wall surfaces, their motion, and what a sphere touches of a mesh.
#include <gtest/gtest.h>

#include "contact/wall/wall.h"
#include "core/random.h"
#include "grid_mesh.h"

namespace cairn {
namespace {

/// Two triangles a cell; z = height(x, y).
template <class Height>
TriangleMesh sheet(std::uint32_t cells, double width, Height&& height) {
  return grid_mesh(cells, [&](double u, double v) {
    const double x = width * (u - 0.5), y = width * (v - 0.5);
    return Vec3(x, y, height(x, y));
  });
}

/// What a sphere touches when nothing is left to candidates.
std::vector<WallTouch> touches(const MeshSurface& mesh, const Vec3& y, double radius) {
  std::vector<std::uint32_t> near;
  mesh.tree().find(y, 1.1 * radius, near);
  std::vector<WallTouch> out;
  mesh.touch(y, radius, near, out);
  return out;
}

TEST(WallSurface, RoundOnesHoldSpheresInsideOrOutside) {
  const SphereSurface bowl{{0, 0, 1}, 5.0, true}, ball{{0, 0, 1}, 5.0, false};
  const Vec3 y(0, 0, 4);
  EXPECT_EQ(bowl.nearest(y).arm, 2.0);
  EXPECT_EQ(bowl.nearest(y).n, Vec3::UnitZ());
  EXPECT_EQ(ball.nearest(y).arm, -2.0);  // beyond the wall
  EXPECT_EQ(ball.nearest(y).n, -Vec3::UnitZ());
  EXPECT_TRUE(bowl.nearest(bowl.center).n.allFinite());
  const CylinderSurface pipe{{1, 0, 0}, Vec3::UnitY(), 3.0, true};
  EXPECT_EQ(pipe.nearest({1, 77, -2}).arm, 1.0);
  EXPECT_EQ(pipe.nearest({1, 77, -2}).n, -Vec3::UnitZ());
  EXPECT_TRUE(pipe.nearest({1, 5, 0}).n.allFinite());
}

TEST(WallMotion, PoseIsTheIntegralOfItsVelocity) {
  const WallMotion motion{.velocity = {0.3, -0.1, 0.2},
                          .amplitude = {0.01, 0.02, -0.05},
                          .frequency = 1.7,
                          .phase = 0.4,
                          .spin = {0.5, -1.0, 2.0},
                          .center = {1.0, 2.0, 3.0}};
  const double t = 12.3, h = 1e-5;
  const WallPose now = motion.pose(t), before = motion.pose(t - h), after = motion.pose(t + h);
  const Vec3 x(4, -2, 1), y = now.to_wall(x);
  const auto place = [&](const WallPose& pose) -> Vec3 {
    return pose.shift + pose.center + pose.turn * (y - pose.center);
  };
  EXPECT_LT((place(now) - x).norm(), 1e-14);
  EXPECT_LT(((place(after) - place(before)) / (2 * h) - now.velocity_at(x)).norm(), 1e-8);
  EXPECT_LT((now.to_space(now.turn.transpose() * Vec3::UnitX()) - Vec3::UnitX()).norm(), 1e-15);
  EXPECT_GE(motion.greatest_speed((x - now.shift - now.center).norm()), now.velocity_at(x).norm());
  EXPECT_FALSE(WallMotion{}.moves());
  EXPECT_EQ(WallMotion{}.pose(5.0).to_wall(x), x);
}

TEST(TriangleTree, FindsWhatAFullSearchFinds) {
  const TriangleMesh mesh = sheet(13, 10.0, [](double x, double y) { return std::sin(x) * std::cos(y); });
  const TriangleTree tree(mesh);
  Random random(5, 0);
  for (int k = 0; k < 300; ++k) {
    const Vec3 y = 8.0 * random.in_ball();
    double nearest = 1e300;
    std::vector<std::uint32_t> near, found;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const double d = tree.triangle(t).nearest(y).distance;
      nearest = std::min(nearest, d);
      if (d < 1.5) near.push_back(t);
    }
    tree.find(y, 1.5, found);
    EXPECT_EQ(found, near);
    EXPECT_EQ(tree.distance(y), nearest);
  }
}

TEST(TriangleShape, NearestPointIsNearerThanAllOthers) {
  const Vec3 a(0, 0, 0), b(3, 0, 0.5), c(2.5, 0.7, -0.2);  // obtuse
  const TriangleShape shape(a, b, c);
  Random random(6, 0);
  for (int k = 0; k < 200; ++k) {
    const Vec3 y = 3.0 * random.in_ball();
    const NearestPoint best = shape.nearest(y);
    EXPECT_NEAR((best.point - y).norm(), best.distance, 1e-12);
    for (int i = 0; i <= 40; ++i)
      for (int j = 0; i + j <= 40; ++j)
        EXPECT_GE((a + i / 40.0 * (b - a) + j / 40.0 * (c - a) - y).norm(), best.distance - 1e-12);
  }
}

TEST(MeshSurface, AFlatFloorPressesOnceWhereverTheSphereStands) {
  for (const double tilt : {0.0, 0.3}) {
    // Also with triangles far smaller than the sphere's cap, and exactly above edges and vertices.
    for (const int cells : {4, 64}) {
      const MeshSurface floor(sheet(cells, 8.0, [&](double x, double) { return tilt * x; }));
      const Vec3 up = Vec3(-tilt, 0, 1).normalized();
      for (int i = 0; i < 25; ++i)
        for (int j = 0; j < 25; ++j) {
          const double x = -1.5 + i * 0.125, y = -1.5 + j * 0.125;
          const auto found = touches(floor, Vec3(x, y, tilt * x) + 0.95 * up, 1.0);
          ASSERT_EQ(found.size(), 1u) << x << " " << y;
          EXPECT_NEAR(found[0].arm, 0.95, 1e-12);
          EXPECT_LT((found[0].n + up).norm(), 1e-12);
          const auto below = touches(floor, Vec3(x, y, tilt * x) - 0.95 * up, 1.0);
          ASSERT_EQ(below.size(), 1u);
          EXPECT_LT((below[0].n - up).norm(), 1e-12);
        }
    }
  }
}

TEST(MeshSurface, TrianglesOfOnePlaneNeedNotShareTheirEdges) {
  TriangleMesh mesh = sheet(1, 4.0, [](double, double) { return 0.0; });
  const TriangleMesh right = sheet(3, 4.0, [](double, double) { return 0.0; });
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& x : right.vertices) mesh.vertices.push_back(x + 4.0 * Vec3::UnitX());
  for (const auto& [a, b, c] : right.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  const MeshSurface floor(mesh);
  for (double x = 1.5; x < 2.5; x += 0.01) EXPECT_EQ(touches(floor, {x, 0.1, 0.95}, 1.0).size(), 1u) << x;
}

TEST(MeshSurface, AValleyPressesTwiceARidgeOnce) {
  const MeshSurface valley(sheet(2, 8.0, [](double x, double) { return std::abs(x); }));
  const auto two = touches(valley, {0, 0.3, 0.95 * std::sqrt(2.0)}, 1.0);
  ASSERT_EQ(two.size(), 2u);
  for (const WallTouch& t : two) {
    EXPECT_NEAR(t.arm, 0.95, 1e-12);
    EXPECT_LT(t.feature, valley.mesh().triangles.size());
  }
  EXPECT_NEAR(two[0].n.dot(two[1].n), 0.0, 1e-12);

  const MeshSurface ridge(sheet(2, 8.0, [](double x, double) { return -std::abs(x); }));
  for (const double x : {-0.3, 0.0, 0.2}) {
    const Vec3 y = Vec3(x, 0.3, std::sqrt(0.95 * 0.95 - x * x));
    const auto one = touches(ridge, y, 1.0);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_LT((one[0].n + y.cwiseProduct(Vec3(1, 0, 1)) / 0.95).norm(), 1e-12);
    EXPECT_GE(one[0].feature, ridge.mesh().triangles.size());
    const WallTouch again = ridge.extend(one[0].feature, y);
    EXPECT_LT((again.n - one[0].n).norm(), 1e-12);
  }
  EXPECT_EQ(touches(ridge, {2.0, 0.3, 0.95 * std::sqrt(2.0) - 2.0}, 1.0).size(), 1u);
}

TEST(MeshSurface, ATipAndTheRimOfAnOpenSheetPressOnce) {
  const MeshSurface tip(
      sheet(2, 4.0, [](double x, double y) { return -std::max(std::abs(x), std::abs(y)); }));
  const auto above = touches(tip, {0.1, 0.05, 0.9}, 1.0);
  ASSERT_EQ(above.size(), 1u);
  EXPECT_EQ(above[0].feature, tip.features() - tip.mesh().vertices.size() + 4);  // the vertex in the middle
  const MeshSurface flat(sheet(2, 4.0, [](double, double) { return 0.0; }));
  const auto beside = touches(flat, {2.9, 0.3, 0.0}, 1.0);  // level with the sheet, off its rim
  ASSERT_EQ(beside.size(), 1u);
  EXPECT_LT((beside[0].n + Vec3::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(beside[0].arm, 0.9, 1e-12);
  EXPECT_EQ(touches(flat, {0.3, 0.2, 0.0}, 1.0)[0].arm, -1.0);  // centre on the mesh
}

TEST(MeshSurface, ABoxCornerPressesThreeTimes) {
  TriangleMesh box;
  for (int k = 0; k < 8; ++k) box.vertices.emplace_back(4.0 * (k & 1), 2.0 * (k & 2), 1.0 * (k & 4));
  box.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  const MeshSurface inside(box);
  EXPECT_EQ(touches(inside, {0.95, 0.96, 0.97}, 1.0).size(), 3u);
  EXPECT_EQ(touches(inside, {0.95, 2.0, 0.97}, 1.0).size(), 2u);
  EXPECT_EQ(touches(inside, {-0.5, -0.5, -0.5}, 1.0).size(), 1u);  // from outside, the corner itself
  EXPECT_EQ(touches(inside, {2.0, 2.0, 2.0}, 1.0).size(), 0u);
}

}  // namespace
}  // namespace cairn
