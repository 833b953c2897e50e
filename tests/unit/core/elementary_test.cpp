// Against correctly rounded values, with more digits.
#include "core/elementary.h"

#include <gtest/gtest.h>
#include <mpfr.h>

#include <cmath>

#include "core/random.h"

namespace cairn {
namespace {

/// Greatest error over numbers of [low, high], in units of the last place of the result.
template <class Ours, class Exact>
double greatest_error(const Ours& ours, const Exact& exact, double low, double high) {
  Random random(7, 0);
  mpfr_t x;
  mpfr_init2(x, 200);
  double worst = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const double at = random.uniform(low, high), found = ours(at);
    mpfr_set_d(x, at, MPFR_RNDN);
    exact(x, x, MPFR_RNDN);
    const double right = std::abs(mpfr_get_d(x, MPFR_RNDN)), place = std::nextafter(right, INFINITY) - right;
    mpfr_sub_d(x, x, found, MPFR_RNDN);
    worst = std::max(worst, std::abs(mpfr_get_d(x, MPFR_RNDN)) / place);
  }
  mpfr_clear(x);
  return worst;
}

TEST(Elementary, FunctionsAreRightToAboutAUnitInTheLastPlace) {
  const auto sine = [](double x) { return sine_and_cosine(x).sine; };
  const auto cosine = [](double x) { return sine_and_cosine(x).cosine; };
  for (const double most : {0.1, 4.0, 1e3, 9e5, 1e9}) {
    EXPECT_LT(greatest_error(sine, mpfr_sin, -most, most), 1.0) << most;
    EXPECT_LT(greatest_error(cosine, mpfr_cos, -most, most), 1.0) << most;
  }
  for (const double most : {0.1, 1.0, 30.0, 700.0})
    EXPECT_LT(greatest_error(exponential, mpfr_exp, -most, most), 1.0) << most;
  for (const double most : {1e-290, 1e-3, 1.0, 10.0, 1e300})
    EXPECT_LT(greatest_error(cube_root, mpfr_cbrt, -most, most), 1.0) << most;
  EXPECT_LT(greatest_error([](double x) { return arc_tangent(x, 1.0); }, mpfr_atan, -3.0, 3.0), 2.0);
  EXPECT_LT(greatest_error([](double x) { return arc_tangent(x, 1.0); }, mpfr_atan, -1e6, 1e6), 2.0);
  EXPECT_LT(greatest_error(arc_cosine, mpfr_acos, -1.0, 1.0), 3.0);
  EXPECT_LT(greatest_error(hyperbolic_sine, mpfr_sinh, -20.0, 20.0), 4.0);
  EXPECT_LT(greatest_error(hyperbolic_cosine, mpfr_cosh, -20.0, 20.0), 3.0);
  EXPECT_LT(greatest_error(complementary_error_function, mpfr_erfc, -5.0, 2.0), 2e3);
  EXPECT_LT(greatest_error(complementary_error_function, mpfr_erfc, 2.0, 20.0), 2e4);
}

TEST(Elementary, ArcTangentKnowsTheQuadrant) {
  for (const double y : {-2.0, -0.0, 0.0, 1e-300, 3.0})
    for (const double x : {-1.0, -0.0, 0.0, 1e-200, 5.0})
      EXPECT_NEAR(arc_tangent(y, x), std::atan2(y, x), 1e-15) << y << ' ' << x;
}

TEST(Elementary, WhatIsNoNumberStaysNone) {
  EXPECT_TRUE(std::isnan(sine_and_cosine(INFINITY).sine));
  EXPECT_TRUE(std::isnan(exponential(NAN)));
  EXPECT_EQ(exponential(-INFINITY), 0.0);
  EXPECT_EQ(exponential(1e4), INFINITY);
  EXPECT_EQ(cube_root(INFINITY), INFINITY);
  EXPECT_EQ(std::signbit(cube_root(-0.0)), true);
}

TEST(Elementary, ARotationTurnsByItsAngle) {
  const Quat turn = rotation(2.0, Vec3::UnitZ());
  EXPECT_LT((turn * Vec3::UnitX() - Vec3(std::cos(2.0), std::sin(2.0), 0.0)).norm(), 1e-15);
}

}  // namespace
}  // namespace cairn
