// Mass properties against closed forms, an independent integration, and symmetries.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "shape/shape.h"
#include "unit/shape/clusters.h"

namespace cairn {
namespace {

using test::moved;
using test::random_cluster;

void expect_same(const MassProperties& a, const MassProperties& b, double tolerance) {
  EXPECT_NEAR(a.volume, b.volume, tolerance * b.volume);
  EXPECT_LT((a.centroid - b.centroid).norm(), tolerance * (1.0 + b.centroid.norm()));
  EXPECT_LT((a.inertia - b.inertia).norm(), tolerance * b.inertia.norm());
}

// Integrals over the cap z > height of a ball about the origin: 1, z, z^2 and x^2.
struct CapIntegrals {
  double volume, z, zz, xx;
};
CapIntegrals cap_integrals(double r, double height) {
  const auto primitive = [r](double z) {
    const double r2 = r * r, z3 = z * z * z, z5 = z3 * z * z;
    return CapIntegrals{kPi * (r2 * z - z3 / 3.0), kPi * (r2 * z * z / 2.0 - z3 * z / 4.0),
                        kPi * (r2 * z3 / 3.0 - z5 / 5.0),
                        kPi / 4.0 * (r2 * r2 * z - 2.0 * r2 * z3 / 3.0 + z5 / 5.0)};
  };
  const CapIntegrals a = primitive(height), b = primitive(r);
  return {b.volume - a.volume, b.z - a.z, b.zz - a.zz, b.xx - a.xx};
}

// Two balls with centres at z = 0 and z = d: each ball less its cap beyond the plane of intersection.
MassProperties two_balls(double r0, double r1, double d) {
  const double plane = (d * d + r0 * r0 - r1 * r1) / (2.0 * d);
  double volume = 0.0, z = 0.0, zz = 0.0, xx = 0.0;
  for (const auto& [r, center, side, height] : {std::tuple{r0, 0.0, 1.0, plane}, {r1, d, -1.0, d - plane}}) {
    const CapIntegrals ball = cap_integrals(r, -r), cap = cap_integrals(r, height);
    const double v = ball.volume - cap.volume, first = side * (ball.z - cap.z), second = ball.zz - cap.zz;
    volume += v;
    z += v * center + first;
    zz += v * center * center + 2.0 * center * first + second;
    xx += ball.xx - cap.xx;
  }
  const double axial = zz - z * z / volume;
  return {volume, Vec3(0.0, 0.0, z / volume), Vec3(xx + axial, xx + axial, 2.0 * xx).asDiagonal()};
}

TEST(UnionOfSpheres, OneSphere) {
  const Shape shape{"", "", {{3.0, -1.0, 2.0}}, {0.7}};
  const MassProperties mass = union_of_spheres(shape);
  const double volume = 4.0 / 3.0 * kPi * 0.343;
  EXPECT_NEAR(mass.volume, volume, 1e-15 * volume);
  EXPECT_EQ(mass.centroid, shape.centers[0]);
  EXPECT_LT((mass.inertia - 0.4 * 0.49 * volume * Mat3::Identity()).norm(), 1e-15);
}

TEST(UnionOfSpheres, TwoBallsMatchTheLens) {
  Random random(1, 2);
  for (const auto& [r0, r1, d] : {std::tuple{1.0, 1.0, 1.7320508075688772},
                                  {1.0, 0.4, 1.1},
                                  {1.0, 0.4, 0.7},
                                  {0.3, 2.0, 1.8},
                                  {1.0, 1.0, 1e-6},
                                  {1.0, 1.0, 2.0 - 1e-9}}) {
    const Quat turn = random.rotation();
    const Vec3 shift = random.in_ball();
    const Shape shape{"", "", {Vec3::Zero(), {0.0, 0.0, d}}, {r0, r1}};
    const MassProperties exact = two_balls(r0, r1, d);
    expect_same(union_of_spheres(shape), exact, 1e-13);
    const Mat3 rotation = turn.toRotationMatrix();
    expect_same(
        union_of_spheres(moved(shape, turn, shift)),
        {exact.volume, turn * exact.centroid + shift, rotation * exact.inertia * rotation.transpose()},
        d < 1e-3 ? 1e-9 : 1e-12);  // turning close centres rounds their distance
  }
}

// An independent method: along each ray the spheres cover intervals; the rays stand on a grid of midpoints.
TEST(UnionOfSpheres, MatchesRayIntegration) {
  const Shape shape = random_cluster(12, 5);
  constexpr int grid = 1200;
  constexpr double extent = 4.0, step = 2.0 * extent / grid;
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  std::vector<std::pair<double, double>> covered;
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      const double y = (row + 0.5) * step - extent, z = (column + 0.5) * step - extent;
      covered.clear();
      for (std::size_t i = 0; i < shape.radii.size(); ++i) {
        const Vec3& c = shape.centers[i];
        const double half2 =
            shape.radii[i] * shape.radii[i] - (y - c.y()) * (y - c.y()) - (z - c.z()) * (z - c.z());
        if (half2 > 0.0) covered.emplace_back(c.x() - std::sqrt(half2), c.x() + std::sqrt(half2));
      }
      std::sort(covered.begin(), covered.end());
      double reach = -extent;
      for (const auto& [begin, end] : covered) {
        const double a = std::max(begin, reach), b = std::max(end, reach);
        const double x0 = b - a, x1 = (b * b - a * a) / 2.0, x2 = (b * b * b - a * a * a) / 3.0;
        volume += x0;
        first += Vec3(x1, y * x0, z * x0);
        second +=
            (Mat3() << x2, y * x1, z * x1, y * x1, y * y * x0, y * z * x0, z * x1, y * z * x0, z * z * x0)
                .finished();
        reach = b;
      }
    }
  const double cell = step * step;
  const Vec3 centroid = first / volume;
  second -= volume * centroid * centroid.transpose();
  expect_same(union_of_spheres(shape),
              {cell * volume, centroid, cell * (second.trace() * Mat3::Identity() - second)}, 2e-5);
}

TEST(UnionOfSpheres, FollowsRotationAndTranslation) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    Random random(seed, 1);
    const Shape shape = random_cluster(20, seed);
    const Quat turn = random.rotation();
    const Vec3 shift = 5.0 * random.direction();
    const MassProperties mass = union_of_spheres(shape);
    const Mat3 rotation = turn.toRotationMatrix();
    expect_same(union_of_spheres(moved(shape, turn, shift)),
                {mass.volume, turn * mass.centroid + shift, rotation * mass.inertia * rotation.transpose()},
                1e-12);
  }
}

TEST(UnionOfSpheres, ScalesWithSize) {
  const Shape shape = random_cluster(10, 3);
  Shape large = shape;
  for (Vec3& center : large.centers) center *= 1000.0;
  for (double& radius : large.radii) radius *= 1000.0;
  const MassProperties mass = union_of_spheres(shape);
  expect_same(union_of_spheres(large), {1e9 * mass.volume, 1e3 * mass.centroid, 1e15 * mass.inertia}, 1e-12);
}

TEST(UnionOfSpheres, NeverExceedsTheSum) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Shape shape = random_cluster(8, seed);
    const double summed = sum_of_spheres(shape).volume, covered = union_of_spheres(shape).volume;
    EXPECT_LE(covered, summed * (1.0 + 1e-14));
    double largest = 0.0;
    for (const double r : shape.radii) largest = std::max(largest, 4.0 / 3.0 * kPi * r * r * r);
    EXPECT_GE(covered, largest);
  }
}

TEST(UnionOfSpheres, SpheresApartOrTangentGiveTheSum) {
  const Shape apart{"", "", {{0, 0, 0}, {5, 1, 0}, {0, 4, 3}}, {1.0, 2.0, 0.5}};
  expect_same(union_of_spheres(apart), sum_of_spheres(apart), 1e-14);
  const Shape tangent{"", "", {{0, 0, 0}, {2, 0, 0}, {0, 0, 1.5}}, {1.0, 1.0, 0.5}};
  expect_same(union_of_spheres(tangent), sum_of_spheres(tangent), 1e-14);
}

TEST(UnionOfSpheres, IgnoresContainedAndDuplicateSpheres) {
  const Shape plain = random_cluster(6, 11);
  Shape crowded = plain;
  crowded.centers.push_back(plain.centers[2] + Vec3(0.1, 0.0, 0.05));
  crowded.radii.push_back(plain.radii[2] - 0.2);
  crowded.centers.push_back(plain.centers[0] + Vec3(0.125, 0.0, 0.0));  // touches from within
  crowded.radii.push_back(plain.radii[0] - 0.125);
  for (int copy = 0; copy < 2; ++copy) {
    crowded.centers.insert(crowded.centers.end(), plain.centers.begin(), plain.centers.end());
    crowded.radii.insert(crowded.radii.end(), plain.radii.begin(), plain.radii.end());
  }
  expect_same(union_of_spheres(crowded), union_of_spheres(plain), 1e-12);
}

// Rims through one point, on one circle, and through the pole of the quadrature.
TEST(UnionOfSpheres, DegenerateArrangements) {
  Random random(4, 4);
  for (const double nudge : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
    Shape shape{"", "", {}, {}};
    for (int k = 0; k < 8; ++k) {
      const double angle = kPi * k / 4.0;
      shape.centers.push_back((0.9 + nudge * (k % 3)) * Vec3(std::cos(angle), std::sin(angle), 0.0));
      shape.radii.push_back(0.9);
    }
    shape.centers.emplace_back(0.0, 0.0, 0.5);
    shape.radii.push_back(0.9);
    shape.centers.emplace_back(0.0, nudge, -0.5);
    shape.radii.push_back(0.9);
    const Quat turn = random.rotation();
    const MassProperties mass = union_of_spheres(shape);
    const Mat3 rotation = turn.toRotationMatrix();
    expect_same(union_of_spheres(moved(shape, turn, Vec3::Zero())),
                {mass.volume, turn * mass.centroid, rotation * mass.inertia * rotation.transpose()}, 1e-12);
  }
}

TEST(SumOfSpheres, ParallelAxis) {
  const Shape shape{"", "", {{1, 0, 0}, {-1, 0, 0}}, {1.0, 1.0}};
  const MassProperties mass = sum_of_spheres(shape);
  const double ball = 4.0 / 3.0 * kPi;
  EXPECT_NEAR(mass.volume, 2.0 * ball, 1e-14);
  EXPECT_NEAR(mass.inertia(0, 0), 2.0 * ball * 0.4, 1e-14);
  EXPECT_NEAR(mass.inertia(1, 1), 2.0 * ball * 1.4, 1e-14);
  EXPECT_NEAR(mass.inertia(2, 2), 2.0 * ball * 1.4, 1e-14);
}

}  // namespace
}  // namespace cairn
