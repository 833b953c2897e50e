#include "gravity/kepler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/elementary.h"

namespace cairn::gravity {

namespace {

/// Stumpff's functions c0 to c3 of z: cos, sin(x)/x, (1 - cos)/x^2 and (x - sin)/x^3 of x = sqrt(z), and
/// their hyperbolic continuation to z < 0.
struct Stumpff {
  double c0, c1, c2, c3;
};

Stumpff stumpff(double z) {
  if (std::abs(z) < 1.0) {  // where the closed forms of c2 and c3 lose digits
    double c2 = 1.0, c3 = 1.0;
    for (int k = 9; k >= 1; --k) {
      c2 = 1.0 - z / ((2 * k + 1) * (2 * k + 2)) * c2;
      c3 = 1.0 - z / ((2 * k + 2) * (2 * k + 3)) * c3;
    }
    c2 /= 2.0;
    c3 /= 6.0;
    return {1.0 - z * c2, 1.0 - z * c3, c2, c3};
  }
  const double x = std::sqrt(std::abs(z)), x3 = x * x * x;
  if (z > 0.0) {
    const double half = sine_and_cosine(0.5 * x).sine, sine = sine_and_cosine(x).sine;
    return {sine_and_cosine(x).cosine, sine / x, 2.0 * half * half / z, (x - sine) / x3};
  }
  const double half = hyperbolic_sine(0.5 * x), sine = hyperbolic_sine(x);
  return {hyperbolic_cosine(x), sine / x, -2.0 * half * half / z, (sine - x) / x3};
}

/// Solves tau = s + e s^3 c3((1 - e) s^2) for s. This is Kepler's equation with the periapsis distance as
/// unit of length and gm = 1; |tau| is at most half a period. d tau / ds is the distance: it is positive, and
/// grows with |s|, so that Newton's iteration comes down on the root from above.
double universal_anomaly(double e, double tau) {
  constexpr int most = 100;
  const double beta = 1.0 - e, t = std::abs(tau);
  if (t == 0.0) return 0.0;
  double low = 0.0, high = std::numeric_limits<double>::infinity(), s = t;
  if (e > 1e-3) {  // the parabola-like cubic s + e s^3 / 6 = t
    const double k = std::sqrt(2.0 / e);
    s = 2.0 * k * hyperbolic_sine(area_sine(1.5 * t / (k * k * k) * 2.0 / e) / 3.0);
  }
  if (beta > 0.0) {
    high = kPi / std::sqrt(beta);
    s = std::min(s, high);
  } else if (beta < 0.0) {  // (e - 1) sinh H <= N
    const double root = std::sqrt(-beta);
    s = std::min(s, area_sine(t * root) / root);
  }
  for (int k = 0; k < most; ++k) {
    const double s2 = s * s;
    const Stumpff c = stumpff(beta * s2);
    const double excess = s + e * s2 * s * c.c3 - t, distance = 1.0 + e * s2 * c.c2;
    if (excess == 0.0) break;
    (excess > 0.0 ? high : low) = s;
    double next = s - excess / distance;
    const bool close = std::abs(next - s) <= 4.0 * std::numeric_limits<double>::epsilon() * s;
    if (!close && !(next >= low && next <= high)) next = 0.5 * (low + high);
    s = next;
    if (close) break;
  }
  return std::copysign(s, tau);
}

}  // namespace

Motion motion(const KeplerOrbit& orbit, double time) {
  const double e = orbit.eccentricity, q = orbit.periapsis;
  const double speed = std::sqrt(orbit.gm / q);  // q and this are the units
  double since = time - orbit.periapsis_time;
  if (e < 1.0) since = std::remainder(since, period(orbit));
  const double s = universal_anomaly(e, since * speed / q);
  const Stumpff c = stumpff((1.0 - e) * s * s);
  const double width = std::sqrt(1.0 + e), distance = 1.0 + e * s * s * c.c2;
  const Quat plane = rotation(orbit.node, Vec3::UnitZ()) * rotation(orbit.inclination, Vec3::UnitX()) *
                     rotation(orbit.argument, Vec3::UnitZ());
  const Mat3 axes = plane.toRotationMatrix();
  return {axes * (q * Vec3(1.0 - s * s * c.c2, width * s * c.c1, 0.0)),
          axes * (speed / distance * Vec3(-s * c.c1, width * c.c0, 0.0))};
}

double mean_motion(const KeplerOrbit& orbit) {
  const double beta = std::abs(1.0 - orbit.eccentricity);
  return std::sqrt(orbit.gm * beta / orbit.periapsis) * beta / orbit.periapsis;
}

double period(const KeplerOrbit& orbit) {
  return orbit.eccentricity < 1.0 ? 2.0 * kPi / mean_motion(orbit) : std::numeric_limits<double>::infinity();
}

}  // namespace cairn::gravity
