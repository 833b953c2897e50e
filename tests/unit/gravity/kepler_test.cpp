#include "gravity/kepler.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace cairn::gravity {
namespace {

using Long = long double;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// c2 or c3 of z by their power series, in long double; |z| below 40.
Long stumpff(int k, Long z) {
  Long term = k == 2 ? 0.5L : 1.0L / 6.0L, sum = 0.0L;
  for (int n = k; std::abs(term) > 1e-24L || n < k + 8; n += 2) {
    sum += term;
    term *= -z / ((n + 1) * (n + 2));
  }
  return sum;
}

/// Time since periapsis and place in the plane at the universal anomaly s, for periapsis distance 1 and gm 1.
struct Exact {
  Long time, x, y, vx, vy;
};
Exact exact(Long e, Long s) {
  const Long z = (1.0L - e) * s * s, width = std::sqrt(1.0L + e);
  Long c1, c2, c3;
  if (std::abs(z) < 30.0L) {
    c2 = stumpff(2, z);
    c3 = stumpff(3, z);
    c1 = 1.0L - z * c3;
  } else {  // far out on a hyperbola
    const Long h = std::sqrt(-z);
    c1 = std::sinh(h) / h;
    c2 = (std::cosh(h) - 1.0L) / (h * h);
    c3 = (std::sinh(h) - h) / (h * h * h);
  }
  const Long r = 1.0L + e * s * s * c2;
  return {s + e * s * s * s * c3, 1.0L - s * s * c2, width * s * c1, -s * c1 / r,
          width * (1.0L - z * c2) / r};
}

KeplerOrbit unit_orbit(double e) {
  return {.gm = 1.0,
          .periapsis = 1.0,
          .eccentricity = e,
          .inclination = 0.0,
          .node = 0.0,
          .argument = 0.0,
          .periapsis_time = 0.0};
}

const std::vector<double> kEccentricities{
    0.0, 1e-12,       1e-3,       0.1,      0.5,   0.9, 0.999, 0.999999, 1.0 - 1e-9, 1.0 - 1e-15,
    1.0, 1.0 + 1e-15, 1.0 + 1e-9, 1.000001, 1.001, 1.5, 3.0,   30.0,     1e3};

/// Universal anomalies from 1e-6 to the apoapsis, or to where the time is 1e15 units.
std::vector<double> anomalies(double e) {
  const double beta = 1.0 - e;
  const double last = beta > 0.0   ? 0.9999999 * kPi / std::sqrt(beta)
                      : beta < 0.0 ? std::min(1e5, 35.0 / std::sqrt(-beta))
                                   : 1e5;
  std::vector<double> s;
  for (double x = 1e-6; x < std::min(last, 1e5); x *= 1.13) s.push_back(x);
  if (beta > 0.0)
    for (const double part : {1e-7, 1e-4, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0}) s.push_back(part * last);
  return s;
}

TEST(Kepler, PlaceAndVelocityAreThoseOfAHighPrecisionSum) {
  double place = 0.0, velocity = 0.0;
  for (const double e : kEccentricities)
    for (const double s : anomalies(e))
      for (const double sign : {1.0, -1.0}) {
        // The time is rounded to a double; the exact place is carried to that time by its velocity.
        const Exact at = exact(e, sign * s);
        const auto time = static_cast<double>(at.time);
        const Motion m = motion(unit_orbit(e), time);
        const Long late = time - at.time, r3 = std::pow(at.x * at.x + at.y * at.y, 1.5L);
        const Long x = at.x + late * at.vx, y = at.y + late * at.vy;
        const Long vx = at.vx - late * at.x / r3, vy = at.vy - late * at.y / r3;
        const auto off =
            static_cast<double>(std::hypot(m.position.x() - x, m.position.y() - y) / std::hypot(x, y));
        // Where the velocity turns quickly the last bit of the time is seen in it.
        const Long scale = std::hypot(vx, vy) + std::abs(at.time) / std::pow(r3, 2.0L / 3.0L);
        const auto fast = static_cast<double>(std::hypot(m.velocity.x() - vx, m.velocity.y() - vy) / scale);
        EXPECT_LT(off, 32.0 * kEpsilon) << "e " << e << ", s " << sign * s;
        EXPECT_LT(fast, 32.0 * kEpsilon) << "e " << e << ", s " << sign * s;
        place = std::max(place, off);
        velocity = std::max(velocity, fast);
      }
  RecordProperty("place", fmt::format("{:.2e}", place));
  RecordProperty("velocity", fmt::format("{:.2e}", velocity));
}

TEST(Kepler, EccentricAndHyperbolicAnomaliesGiveTheTime) {
  for (double anomaly = -3.1; anomaly < 3.1; anomaly += 0.1) {  // textbook forms, away from e = 1
    for (const double e : {0.0, 0.2, 0.7}) {
      const double a = 1.0 / (1.0 - e);
      const Motion m = motion(unit_orbit(e), std::pow(a, 1.5) * (anomaly - e * std::sin(anomaly)));
      EXPECT_NEAR(m.position.x(), a * (std::cos(anomaly) - e), 1e-14 * a);
      EXPECT_NEAR(m.position.y(), a * std::sqrt(1.0 - e * e) * std::sin(anomaly), 1e-14 * a);
    }
    for (const double e : {1.2, 4.0}) {
      const double a = 1.0 / (e - 1.0);
      const Motion m = motion(unit_orbit(e), std::pow(a, 1.5) * (e * std::sinh(anomaly) - anomaly));
      const double r = a * (e * std::cosh(anomaly) - 1.0);
      EXPECT_NEAR(m.position.x(), a * (e - std::cosh(anomaly)), 1e-14 * r);
      EXPECT_NEAR(m.position.y(), a * std::sqrt(e * e - 1.0) * std::sinh(anomaly), 1e-14 * r);
    }
    // Barker's equation, t = sqrt(2) (D + D^3 / 3) with D the tangent of half the true anomaly.
    const double d = anomaly;
    const Motion m = motion(unit_orbit(1.0), std::sqrt(2.0) * (d + d * d * d / 3.0));
    EXPECT_NEAR(m.position.x(), 1.0 - d * d, 1e-14 * (1.0 + d * d));
    EXPECT_NEAR(m.position.y(), 2.0 * d, 1e-14 * (1.0 + d * d));
  }
}

TEST(Kepler, EnergyAndAngularMomentumAreKeptAndTheVelocityIsThatOfThePlace) {
  for (const double e : {0.0, 0.4, 0.97, 1.0, 1.3, 8.0}) {
    const KeplerOrbit orbit{.gm = 3.986e14,
                            .periapsis = 2e7,
                            .eccentricity = e,
                            .inclination = 0.7,
                            .node = 2.1,
                            .argument = -1.3,
                            .periapsis_time = 5e3};
    const double energy = 0.5 * orbit.gm * (e - 1.0) / orbit.periapsis, scale = orbit.gm / orbit.periapsis;
    const double length = std::sqrt(orbit.gm * orbit.periapsis * (1.0 + e));
    const Vec3 normal(std::sin(0.7) * std::sin(2.1), -std::sin(0.7) * std::cos(2.1), std::cos(0.7));
    for (double t = -3e5; t < 3e5; t += 7.3e3) {
      const Motion m = motion(orbit, t);
      const double r = m.position.norm();
      EXPECT_NEAR(0.5 * m.velocity.squaredNorm() - orbit.gm / r, energy, 1e-14 * scale);
      EXPECT_LT((m.position.cross(m.velocity) - length * normal).norm(), 1e-14 * r * m.velocity.norm());
      const double h = 1.0;
      const Vec3 change = motion(orbit, t + h).position - motion(orbit, t - h).position;
      EXPECT_LT((change / (2.0 * h) - m.velocity).norm(), 1e-6 * m.velocity.norm());
    }
    const Motion nearest = motion(orbit, 5e3);
    EXPECT_NEAR(nearest.position.norm(), 2e7, 1e-7);
    // Node and argument: the periapsis is 1.3 rad before the node along the orbit.
    const Vec3 node(std::cos(2.1), std::sin(2.1), 0.0);
    EXPECT_NEAR(nearest.position.dot(node) / 2e7, std::cos(1.3), 1e-14);
    EXPECT_LT(nearest.position.z(), 0.0);
  }
}

TEST(Kepler, AnEllipseComesBackAfterItsPeriod) {
  const KeplerOrbit orbit{.gm = 1.327e20,
                          .periapsis = 1e11,
                          .eccentricity = 0.3,
                          .inclination = 0.1,
                          .node = 1.0,
                          .argument = 2.0,
                          .periapsis_time = -4e6};
  const double a = 1e11 / 0.7;
  EXPECT_NEAR(period(orbit), 2.0 * kPi * std::sqrt(a * a * a / 1.327e20), 1e-15 * period(orbit) * 4.0);
  EXPECT_NEAR(mean_motion(orbit) * period(orbit), 2.0 * kPi, 1e-14);
  for (double t = 0.0; t < 3e7; t += 1.1e6) {
    const Motion now = motion(orbit, t), later = motion(orbit, t + 7.0 * period(orbit));
    EXPECT_LT((now.position - later.position).norm(), 1e-14 * a);
  }
  EXPECT_TRUE(std::isinf(period(unit_orbit(1.0))));
  EXPECT_TRUE(std::isinf(period(unit_orbit(2.0))));
}

}  // namespace
}  // namespace cairn::gravity
