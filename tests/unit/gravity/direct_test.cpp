#include "gravity/direct.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <limits>

#include "clouds.h"
#include "core/error.h"

namespace cairn::gravity {
namespace {

TEST(Direct, TwoBodiesPullEachOtherByNewtonsLaw) {
  Cloud cloud;
  cloud.add_group({{1.0, 2.0, 3.0}}, 3e10);
  cloud.add_group({{4.0, 6.0, 15.0}}, 5e10);
  const Field f = evaluate(DirectSum(), cloud);
  const Vec3 d(3.0, 4.0, 12.0);
  const Vec3 a0 = kGravitationalConstant * 5e10 / (13.0 * 13.0 * 13.0) * d;
  EXPECT_LT((f.acceleration[0] - a0).norm(), 1e-15 * a0.norm());
  EXPECT_LT((f.acceleration[1] + 0.6 * a0).norm(), 1e-15 * a0.norm());
  EXPECT_NEAR(f.potential[0], -kGravitationalConstant * 5e10 / 13.0, 1e-15);
}

TEST(Direct, EqualsTheLongDoubleSum) {
  for (const std::size_t group : {1, 2, 7, 90}) {
    for (const std::size_t n : {1, 3, 9, 64, 700}) {
      const Cloud cloud = ball(n, group);
      const Field f = evaluate(DirectSum(), cloud), e = exact(cloud);
      if (n <= group) {
        EXPECT_EQ(f.acceleration[0], Vec3(Vec3::Zero()));
        continue;
      }
      EXPECT_LT(rms_error(f.acceleration, e.acceleration), 1e-14) << n << " in groups of " << group;
      EXPECT_LT(worst_relative(f.potential, e.potential), 1e-14);
    }
  }
}

TEST(Direct, AUniformBallPullsAsItsClosedForm) {
  const double n = 8000;
  Cloud cloud;
  Random random(3, 0);
  for (int i = 0; i < n; ++i) cloud.add_group({random.in_ball()}, 1.0 / kGravitationalConstant);
  cloud.add_group({{0.0, 3.0, 0.0}}, 0.0);
  const Field f = evaluate(DirectSum(), cloud);
  double virial = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    virial += cloud.mass[i] * kGravitationalConstant * cloud.x[i].dot(f.acceleration[i]);
    energy += 0.5 * cloud.mass[i] * kGravitationalConstant * f.potential[i];
  }
  EXPECT_NEAR(energy / (-0.6 * n * n), 1.0, 0.01);
  EXPECT_NEAR(virial / energy, 1.0, 1e-12);  // of a pull that goes as 1/r^2
  EXPECT_NEAR(f.acceleration.back().y() / (-n / 9.0), 1.0, 0.01);
}

TEST(Direct, CoincidentAndMasslessPointsAreHarmless) {
  Cloud cloud;
  for (int i = 0; i < 40; ++i) cloud.add_group({{1.0, 1.0, 1.0}}, i % 2);
  cloud.add_group({{2.0, 1.0, 1.0}}, 0.0);
  const Field f = evaluate(DirectSum(), cloud);
  EXPECT_EQ(f.acceleration[0], Vec3(Vec3::Zero()));
  EXPECT_NEAR(f.acceleration[40].x() / (-20.0 * kGravitationalConstant), 1.0, 1e-14);
}

TEST(Direct, SameBitsForAnyNumberOfThreads) {
  const Cloud cloud = ball(3000, 5);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const Field one = evaluate(DirectSum(), cloud);
  omp_set_num_threads(2);
  const Field two = evaluate(DirectSum(), cloud);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.acceleration, two.acceleration);
  EXPECT_EQ(one.potential, two.potential);
}

TEST(Direct, NamesThePointThatIsNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Cloud cloud = ball(10);
    cloud.x[7].z() = bad;
    try {
      evaluate(DirectSum(), cloud);
      FAIL();
    } catch (const UnstableError& e) {
      EXPECT_NE(std::string(e.what()).find("point 7"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace cairn::gravity
