#include "gravity/fmm.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <limits>

#include "clouds.h"
#include "core/error.h"
#include "gravity/direct.h"

namespace cairn::gravity {
namespace {

TEST(Fmm, ErrorAgainstTheDirectSumIsAsStated) {
  // rms error; the 99.9 % quantile of |da| / rms |a| is at most 8 times as large.
  struct Case {
    int order;
    double theta, rms;
  };
  const Cloud cloud = ball(10000);
  const Field reference = evaluate(DirectSum(), cloud);
  for (const Case c : {Case{4, 0.4, 1.2e-4}, Case{4, 0.6, 9e-4}, Case{5, 0.7, 9e-4}, Case{5, 0.3, 6e-6},
                       Case{6, 0.8, 1.2e-3}, Case{6, 0.3, 2e-6}, Case{5, 1.0, 1e-2}}) {
    const Field f = evaluate(Fmm({.theta = c.theta, .order = c.order}), cloud);
    const double rms = rms_error(f.acceleration, reference.acceleration);
    EXPECT_LT(rms, c.rms) << "order " << c.order << ", theta " << c.theta;
    EXPECT_GT(rms, c.rms / 10) << "order " << c.order << ", theta " << c.theta;
    EXPECT_LT(quantile_error(f.acceleration, reference.acceleration, 0.999), 8 * c.rms);
    EXPECT_LT(worst_relative(f.potential, reference.potential), c.rms);
  }
}

TEST(Fmm, NoExpansionLeavesTheDirectSum) {
  const Cloud cloud = ball(1500, 3);
  const Field f = evaluate(Fmm({.theta = 0.0}), cloud), reference = evaluate(DirectSum(), cloud);
  EXPECT_LT(rms_error(f.acceleration, reference.acceleration), 1e-14);
}

TEST(Fmm, ForcesOfDistantCellsBalance) {
  const Cloud cloud = ball(5000);
  const Field f = evaluate(Fmm({.theta = 0.9, .order = 4}), cloud);
  EXPECT_LT(net(cloud, f.acceleration).force, 1e-15);
}

// Whole cubes of 1000 glued spheres side by side: nothing of a cube's own pull comes through its far cells,
// so that the error is that of the field of the others.
TEST(Fmm, ABigGroupDoesNotPullItself) {
  Cloud cloud;
  for (int cube = 0; cube < 8; ++cube) {
    const Vec3 corner = 10.5 * Vec3(cube % 2, cube / 2 % 2, cube / 4);
    std::vector<Vec3> members;
    for (int i = 0; i < 1000; ++i) members.push_back(corner + Vec3(i % 10, i / 10 % 10, i / 100));
    cloud.add_group(members, 1e9);
  }
  const Field reference = evaluate(DirectSum(), cloud);
  for (const auto& [theta, rms] : {std::pair{0.5, 4e-4}, std::pair{0.2, 1e-6}}) {
    const Field f = evaluate(Fmm({.theta = theta, .order = 5}), cloud);
    EXPECT_LT(rms_error(f.acceleration, reference.acceleration), rms) << theta;
  }

  Cloud alone;
  alone.add_group(std::vector<Vec3>(cloud.x.begin(), cloud.x.begin() + 1000), 1e9);
  for (const Vec3& a : evaluate(Fmm(), alone).acceleration) EXPECT_EQ(a, Vec3(Vec3::Zero()));
}

TEST(Fmm, AggregatesConvergeAsLooseSpheresDo) {
  for (const std::size_t group : {4, 40}) {
    const Cloud cloud = ball(8000, group);
    const Field f = evaluate(Fmm({.theta = 0.3, .order = 5}), cloud),
                reference = evaluate(DirectSum(), cloud);
    EXPECT_LT(rms_error(f.acceleration, reference.acceleration), 5e-5) << group;
  }
}

TEST(Fmm, SameBitsForAnyNumberOfThreadsAndOnReuse) {
  const Cloud cloud = ball(6000, 3);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  Fmm method;
  const Field one = evaluate(method, cloud);
  omp_set_num_threads(2);
  evaluate(method, ball(100));
  const Field two = evaluate(method, cloud), fresh = evaluate(Fmm(), cloud);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.acceleration, two.acceleration);
  EXPECT_EQ(one.acceleration, fresh.acceleration);
  EXPECT_EQ(one.potential, two.potential);
}

struct Shape {
  const char* name;
  Vec3 (*place)(int i, Random& random);
  double (*mass)(int i);
};

class FmmOn : public testing::TestWithParam<Shape> {};

TEST_P(FmmOn, DegenerateSets) {
  for (const int n : {1, 2, 21, 1000}) {
    Cloud cloud;
    Random random(5, 0);
    for (int i = 0; i < n; ++i) cloud.add_group({GetParam().place(i, random)}, GetParam().mass(i));
    const Field f = evaluate(Fmm({.theta = 0.4, .order = 5}), cloud),
                reference = evaluate(DirectSum(), cloud);
    double size = 0.0, difference = 0.0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      ASSERT_TRUE(f.acceleration[i].allFinite());
      size += reference.acceleration[i].squaredNorm();
      difference += (f.acceleration[i] - reference.acceleration[i]).squaredNorm();
    }
    EXPECT_LE(std::sqrt(difference), 3e-3 * std::sqrt(size)) << n;
  }
}

double unit(int) {
  return 1e10;
}

INSTANTIATE_TEST_SUITE_P(
    All, FmmOn,
    testing::Values(Shape{"line", [](int i, Random&) { return Vec3(i, 2.0 * i, -1.0); }, unit},
                    Shape{"plane", [](int i, Random&) { return Vec3(i % 32, i / 32, 7.0); }, unit},
                    Shape{"one_place", [](int, Random&) { return Vec3(1e6, 0.0, 3.0); }, unit},
                    Shape{"two_places", [](int i, Random&) { return Vec3(i % 2, 0.0, 0.0); }, unit},
                    Shape{"geometric",
                          [](int i, Random&) { return Vec3(std::ldexp(1.0, -(i % 900)), 0.0, 0.0); },
                          [](int) { return 1e-30; }},
                    Shape{"no_mass", [](int, Random& r) { return r.in_ball(); }, [](int) { return 0.0; }},
                    Shape{"one_mass", [](int, Random& r) { return r.in_ball(); },
                          [](int i) { return i == 13 ? 1e30 : 0.0; }},
                    Shape{"planet", [](int, Random& r) { return r.in_ball(); },
                          [](int i) { return i == 0 ? 1e30 : 1.0; }},
                    Shape{"binary",
                          [](int i, Random& r) -> Vec3 {
                            return Vec3(i % 3 == 0 ? 1e9 : 0.0, 0.0, 0.0) + 300.0 * r.in_ball();
                          },
                          unit},
                    Shape{"far_out",
                          [](int, Random& r) -> Vec3 { return Vec3(1.5e11, 0.0, 0.0) + 300.0 * r.in_ball(); },
                          unit}),
    [](const auto& shape) { return shape.param.name; });

TEST(Fmm, RefusesWhatIsOutOfBounds) {
  EXPECT_THROW(Fmm({.theta = 1.5}), InputError);
  EXPECT_THROW(Fmm({.order = 8}), InputError);
  EXPECT_THROW(Fmm({.leaf_size = 0}), InputError);
  Cloud cloud = ball(30);
  cloud.x[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(evaluate(Fmm(), cloud), UnstableError);
  cloud = ball(30);
  cloud.mass[3] = -1.0;
  EXPECT_THROW(evaluate(Fmm(), cloud), UnstableError);
}

}  // namespace
}  // namespace cairn::gravity
