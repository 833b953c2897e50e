#include "motion/spin.h"

#include <algorithm>

#include "body/cells.h"
#include "core/parallel.h"

namespace cairn {

namespace {

/// Sums over the members, seen from one of them.
struct Sums {
  double mass = 0.0;
  Vec3 moment = Vec3::Zero(), momentum = Vec3::Zero();
  Vec3 response = Vec3::Zero();   // inertia tensor times z
  double angular_momentum = 0.0;  // about z
  Sums& operator+=(const Sums& s) {
    mass += s.mass;
    moment += s.moment;
    momentum += s.momentum;
    response += s.response;
    angular_momentum += s.angular_momentum;
    return *this;
  }
};

/// R I R^T z: angular momentum of body b per unit spin about z.
Vec3 spin_response(const Bodies& bodies, std::size_t b) {
  if (is_ball(bodies, b)) return {0.0, 0.0, bodies.inertia[b].z()};
  const Quat& q = bodies.orientation[b];
  return q * (q.conjugate() * Vec3::UnitZ()).cwiseProduct(bodies.inertia[b]);
}

/// What a mass at x adds to the inertia tensor's column of z, per mass.
Vec3 response_at(const Vec3& x) {
  return {-x.x() * x.z(), -x.y() * x.z(), x.x() * x.x() + x.y() * x.y()};
}

/// z component of a x b.
double cross_z(const Vec3& a, const Vec3& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

double period_at(std::span<const SpinPoint> path, double t) {
  if (t <= path.front().time) return path.front().period;
  for (std::size_t k = 1; k < path.size(); ++k)
    if (t < path[k].time) {
      const SpinPoint &a = path[k - 1], &b = path[k];
      return a.period + (b.period - a.period) * (t - a.time) / (b.time - a.time);
    }
  return path.back().period;
}

SpinCorrection impose_period(Bodies& bodies, std::span<const std::uint8_t> members, double period) {
  const auto marked = std::find_if(members.begin(), members.end(), [](std::uint8_t m) { return m != 0; });
  const auto first = static_cast<std::size_t>(marked - members.begin());
  if (first == members.size()) return {.period = period};
  const Vec3 reference = bodies.velocity[first];
  const Sums sums = parallel_sum(bodies.size(), Sums{}, [&](std::size_t b) {
    if (!members[b]) return Sums{};
    const double m = bodies.mass[b];
    const Vec3 x = separation(bodies, first, b), p = m * (bodies.velocity[b] - reference);
    return Sums{m, m * x, p, m * response_at(x) + spin_response(bodies, b),
                cross_z(x, p) + bodies.spin[b].z()};
  });
  const Vec3 center = sums.moment / sums.mass;
  const Vec3 response = sums.response - sums.mass * response_at(center);
  const double spin = sums.angular_momentum - cross_z(center, sums.momentum);
  const double change = 2.0 * kPi / period - spin / response.z();
  parallel_for(bodies.size(), [&](std::size_t b) {
    if (!members[b]) return;
    const Vec3 x = separation(bodies, first, b) - center;
    bodies.velocity[b] += Vec3(-change * x.y(), change * x.x(), 0.0);
    bodies.spin[b] += change * spin_response(bodies, b);
  });
  return {period, change * response, change * spin + 0.5 * change * change * response.z()};
}

}  // namespace cairn
