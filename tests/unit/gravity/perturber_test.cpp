#include "gravity/perturber.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace cairn::gravity {
namespace {

using LongVec = Eigen::Matrix<long double, 3, 1>;

Vec3 pull_at(const Pull& pull, const Vec3& x) {
  Vec3 a = Vec3::Zero();
  add_pull(pull, std::span(&x, 1), std::span(&a, 1));
  return a;
}

/// The difference of the two pulls in long double.
LongVec difference(const Pull& pull, const Vec3& x) {
  const LongVec d = pull.place.cast<long double>(), r = d - x.cast<long double>();
  return static_cast<long double>(pull.gm) *
         (r / std::pow(r.squaredNorm(), 1.5L) - d / std::pow(d.squaredNorm(), 1.5L));
}

TEST(Perturber, TheWholePullIsNewtons) {
  const Pull pull{3.986e14, {7e6, -2e6, 3e6}, false};
  Random random(1, 0);
  for (int k = 0; k < 100; ++k) {
    const Vec3 x = 1e7 * random.in_ball(), r = pull.place - x;
    const Vec3 expected = pull.gm / std::pow(r.norm(), 3) * r;
    EXPECT_LT((pull_at(pull, x) - expected).norm(), 1e-14 * expected.norm());
  }
}

TEST(Perturber, TheTideIsTheDifferenceWhereverTheSphereIs) {
  Random random(2, 0);
  for (const double reach : {1e-1, 1.0, 10.0, 1e3, 1e5}) {  // of the distance to the perturber
    double worst = 0.0;
    for (int k = 0; k < 1000; ++k) {
      const Pull pull{1e20, 1e6 * Vec3(1.0, -0.3, 0.5), true};
      const Vec3 x = reach * 1e6 * random.in_ball();
      const LongVec expected = difference(pull, x);
      const double r = (pull.place - x).norm();
      const double scale = std::max(pull.gm * x.norm() / (r * r * r), static_cast<double>(expected.norm()));
      worst = std::max(worst,
                       static_cast<double>((pull_at(pull, x).cast<long double>() - expected).norm()) / scale);
    }
    EXPECT_LT(worst, 4e-15) << reach;
  }
  const Pull pull{1e20, {1e6, 0.0, 0.0}, true};
  EXPECT_EQ(pull_at(pull, Vec3::Zero()), Vec3(Vec3::Zero()));
  // Close to the perturber, where 1 + q is nearly 0.
  for (const double gap : {1e-2, 1e-6}) {
    const Vec3 x = (1.0 - gap) * pull.place;
    const double expected = pull.gm / 1e12 * (1.0 / (gap * gap) - 1.0);
    EXPECT_NEAR(pull_at(pull, x).x(), expected, 1e-9 * expected);
  }
}

/// gm/D^3 (3 n n - 1) x, and the next term of the expansion in x/D.
Vec3 tensor(const Pull& pull, const Vec3& x, bool next) {
  const double d = pull.place.norm();
  const Vec3 n = pull.place / d;
  const double c = n.dot(x);
  Vec3 a = 3.0 * c * n - x;
  if (next) a += (7.5 * c * c * n - 1.5 * x.squaredNorm() * n - 3.0 * c * x) / d;
  return pull.gm / (d * d * d) * a;
}

TEST(Perturber, TideAt1e11MetresIsTheTidalTensorToRoundOff) {
  const Pull sun{1.32712440018e20, Vec3(1.2e11, -0.7e11, 0.3e11), true};
  Random random(3, 0);
  double first = 0.0, second = 0.0, direct = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 x = 500.0 * random.in_ball(), a = pull_at(sun, x);
    const Vec3 r = sun.place - x;
    const Vec3 naive = sun.gm * (r / std::pow(r.norm(), 3) - sun.place / std::pow(sun.place.norm(), 3));
    first = std::max(first, (a - tensor(sun, x, false)).norm() / a.norm());
    second = std::max(second, (a - tensor(sun, x, true)).norm() / a.norm());
    direct = std::max(direct, (a - naive).norm() / a.norm());
  }
  EXPECT_GT(first, 1e-9);  // x/D: the octupole is seen
  EXPECT_LT(first, 2e-8);
  EXPECT_LT(second, 2e-15);
  EXPECT_GT(direct, 1e-8);  // what the difference of two doubles would give
  // 64 bits against 53: the direct difference in long double has 11 bits more than the naive one.
  const Vec3 x(300.0, 200.0, -100.0);
  const LongVec expected = difference(sun, x);
  EXPECT_LT((pull_at(sun, x).cast<long double>() - expected).norm() / expected.norm(), 1e-10L);
}

TEST(Perturber, TheBitsDoNotDependOnHowManyGoTogether) {
  Random random(4, 0);
  std::vector<Vec3> x(1037), all(x.size(), Vec3(1.0, 2.0, 3.0)), single = all;
  for (Vec3& v : x) v = 1e3 * random.in_ball();
  for (const bool tidal : {true, false}) {
    const Pull pull{1e14, {2e7, 1e7, 0.0}, tidal};
    const double nearest = add_pull(pull, x, all);
    double least = 1e300;
    for (std::size_t k = 0; k < x.size(); ++k)
      least = std::min(least, add_pull(pull, std::span(&x[k], 1), std::span(&single[k], 1)));
    EXPECT_EQ(all, single);
    EXPECT_EQ(nearest, least);
    EXPECT_NEAR(std::sqrt(nearest), std::sqrt(5e14), 1e3);
  }
}

/// An ellipse with rows at equal steps of the time, with or without velocities; greatest error over rows at
/// the middle of each two.
double track_error(int rows, bool velocities) {
  const KeplerOrbit orbit{.gm = 1.0,
                          .periapsis = 1.0,
                          .eccentricity = 0.3,
                          .inclination = 0.4,
                          .node = 1.0,
                          .argument = 2.0,
                          .periapsis_time = 1.0};
  std::vector<double> times;
  std::vector<Vec3> places, speeds;
  for (int k = 0; k < rows; ++k) {
    times.push_back(8.0 * k / (rows - 1));
    const Motion m = motion(orbit, times.back());
    places.push_back(m.position);
    speeds.push_back(m.velocity);
  }
  const Track track = velocities ? Track(times, places, speeds) : Track(times, places);
  double worst = 0.0;
  for (int k = 0; k < rows; ++k) {
    const Motion m = track.at(times[k]);
    EXPECT_LT((m.position - places[k]).norm(), 1e-14);
    if (k + 1 == rows) break;
    const double t = 0.5 * (times[k] + times[k + 1]);
    worst = std::max(worst, (track.at(t).position - motion(orbit, t).position).norm());
  }
  return worst;
}

TEST(Track, ConvergesAtFourthOrder) {
  for (const bool velocities : {false, true}) {
    const double coarse = track_error(81, velocities), fine = track_error(161, velocities);
    EXPECT_LT(coarse, 1e-4);
    EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.25) << velocities;
  }
}

TEST(Track, ReproducesACubicWithUnevenRows) {
  const auto cubic = [](double t) -> Vec3 { return {1.0 + t * (2.0 - t * (3.0 - 0.5 * t)), t, t * t}; };
  const auto slope = [](double t) -> Vec3 { return {2.0 - 6.0 * t + 1.5 * t * t, 1.0, 2.0 * t}; };
  std::vector<double> times{-2.0, -1.0, 0.5, 0.75, 3.0, 3.5};
  std::vector<Vec3> places, slopes;
  for (const double t : times) {
    places.push_back(cubic(t));
    slopes.push_back(slope(t));
  }
  const Track spline(times, places), hermite(times, places, slopes);
  for (double t = -2.5; t < 4.0; t += 0.1)
    for (const Track* track : {&spline, &hermite}) {
      EXPECT_LT((track->at(t).position - cubic(t)).norm(), 1e-12) << t;
      EXPECT_LT((track->at(t).velocity - slope(t)).norm(), 1e-12) << t;
    }
  EXPECT_DOUBLE_EQ(spline.closest(), cubic(0.75).norm());
}

TEST(Track, TheSplineHasAContinuousAcceleration) {
  std::vector<double> times;
  std::vector<Vec3> places;
  for (int k = 0; k < 12; ++k) {
    times.push_back(k + 0.3 * (k % 3));
    places.emplace_back(std::sin(times.back()), std::cos(1.3 * times.back()), 0.0);
  }
  const Track track(times, places);
  const double h = 1e-4;
  for (std::size_t k = 1; k + 1 < times.size(); ++k) {
    const double t = times[k];
    const Vec3 before = (track.at(t - h).velocity - track.at(t - 2 * h).velocity) / h;
    const Vec3 after = (track.at(t + 2 * h).velocity - track.at(t + h).velocity) / h;
    EXPECT_LT((after - before).norm(), 20.0 * h);
  }
}

}  // namespace
}  // namespace cairn::gravity
