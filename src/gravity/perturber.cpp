#include "gravity/perturber.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gravity/simd.h"

namespace cairn::gravity {

namespace {

struct Columns {
  Pack x, y, z;
};

Columns gather(const Vec3* from, std::size_t count) {
  double x[kLanes], y[kLanes], z[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Vec3& v = from[std::min(i, count - 1)];
    x[i] = v.x();
    y[i] = v.y();
    z[i] = v.z();
  }
  return {load(x), load(y), load(z)};
}

void scatter_add(const Columns& columns, Vec3* to, std::size_t count) {
  double x[kLanes], y[kLanes], z[kLanes];
  store(x, columns.x);
  store(y, columns.y);
  store(z, columns.z);
  for (std::size_t i = 0; i < count; ++i) to[i] += Vec3(x[i], y[i], z[i]);
}

template <bool tidal>
double add(const Pull& pull, std::span<const Vec3> positions, std::span<Vec3> acceleration) {
  const Vec3& d = pull.place;
  const Pack dx = spread(d.x()), dy = spread(d.y()), dz = spread(d.z()), gm = spread(pull.gm);
  const double d2 = d.squaredNorm();
  const Pack inverse2 = spread(1.0 / d2), at_zero = spread(pull.gm / (d2 * std::sqrt(d2)));
  Pack least = spread(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < positions.size(); i += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, positions.size() - i);
    const Columns x = gather(&positions[i], count);
    Columns a{dx - x.x, dy - x.y, dz - x.z};
    const Pack square = fma(a.x, a.x, fma(a.y, a.y, a.z * a.z));
    least = square < least ? square : least;
    const Pack third = inverse_powers<false>(greater(square, Pack{}), square, gm).third;
    if constexpr (tidal) {
      const Pack q =
          -inverse2 * fma(x.x, a.x + dx, fma(x.y, a.y + dy, x.z * (a.z + dz)));  // x.(x - 2D) / D^2
      // (1 + q)^(3/2) is at_zero over third.
      const Pack f = q * fma(q, q + spread(3.0), spread(3.0)) * third / (third + at_zero);
      a = {-fma(f, dx, x.x), -fma(f, dy, x.y), -fma(f, dz, x.z)};
    }
    scatter_add({third * a.x, third * a.y, third * a.z}, &acceleration[i], count);
  }
  double lane[kLanes];
  store(lane, least);
  return *std::min_element(lane, lane + kLanes);
}

}  // namespace

Motion motion(const Orbit& orbit, double time) {
  if (const auto* kepler = std::get_if<KeplerOrbit>(&orbit)) return motion(*kepler, time);
  if (const auto* track = std::get_if<Track>(&orbit)) return track->at(time);
  return {std::get<Vec3>(orbit), Vec3::Zero()};
}

double closest(const Orbit& orbit) {
  if (const auto* kepler = std::get_if<KeplerOrbit>(&orbit)) return kepler->periapsis;
  if (const auto* track = std::get_if<Track>(&orbit)) return track->closest();
  return std::get<Vec3>(orbit).norm();
}

double add_pull(const Pull& pull, std::span<const Vec3> positions, std::span<Vec3> acceleration) {
  return pull.tidal ? add<true>(pull, positions, acceleration) : add<false>(pull, positions, acceleration);
}

}  // namespace cairn::gravity
