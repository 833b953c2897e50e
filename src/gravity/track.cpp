#include "gravity/track.h"

#include <algorithm>
#include <limits>

namespace cairn::gravity {

namespace {

/// Slopes of the not-a-knot spline at its knots: a tridiagonal system, one row a knot.
std::vector<Vec3> spline_slopes(const std::vector<double>& t, const std::vector<Vec3>& x) {
  const std::size_t n = t.size();
  const auto h = [&](std::size_t i) { return t[i + 1] - t[i]; };
  const auto d = [&](std::size_t i) -> Vec3 { return (x[i + 1] - x[i]) / h(i); };
  // The third derivative is the same in the two intervals at an end, a the outer one.
  const auto end = [](double a, double b, const Vec3& outer, const Vec3& inner) -> Vec3 {
    return ((a + 2.0 * (a + b)) * b * outer + a * a * inner) / (a + b);
  };
  std::vector<double> above(n);  // what elimination leaves right of the diagonal
  std::vector<Vec3> slope(n);
  above[0] = (h(0) + h(1)) / h(1);
  slope[0] = end(h(0), h(1), d(0), d(1)) / h(1);
  for (std::size_t i = 1; i < n; ++i) {
    const bool last = i + 1 == n;
    const double left = last ? h(n - 2) + h(n - 3) : h(i);
    const double middle = last ? h(n - 3) : 2.0 * (h(i - 1) + h(i));
    const double right = last ? 0.0 : h(i - 1);
    const Vec3 rest =
        last ? end(h(n - 2), h(n - 3), d(n - 2), d(n - 3)) : Vec3(3.0 * (h(i) * d(i - 1) + h(i - 1) * d(i)));
    const double pivot = middle - left * above[i - 1];
    above[i] = right / pivot;
    slope[i] = (rest - left * slope[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 0;) slope[i] -= above[i] * slope[i + 1];
  return slope;
}

}  // namespace

Track::Track(std::vector<double> times, std::vector<Vec3> places)
    : times_(std::move(times)), places_(std::move(places)), velocities_(spline_slopes(times_, places_)) {}

Track::Track(std::vector<double> times, std::vector<Vec3> places, std::vector<Vec3> velocities)
    : times_(std::move(times)), places_(std::move(places)), velocities_(std::move(velocities)) {}

Motion Track::at(double time) const {
  const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, time);
  const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
  const double h = times_[i + 1] - times_[i], s = time - times_[i];
  const Vec3 mean = (places_[i + 1] - places_[i]) / h;
  const Vec3 &v0 = velocities_[i], &v1 = velocities_[i + 1];
  const Vec3 cubic = (v0 + v1 - 2.0 * mean) / (h * h), square = (mean - v0) / h - h * cubic;
  return {places_[i] + s * (v0 + s * (square + s * cubic)), v0 + s * (2.0 * square + 3.0 * s * cubic)};
}

double Track::closest() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& place : places_) least = std::min(least, place.norm());
  return least;
}

}  // namespace cairn::gravity
