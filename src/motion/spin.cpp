#include "motion/spin.h"

#include "body/cells.h"
#include "core/parallel.h"

namespace cairn {

namespace {

/// Sums over the members, about a point moving with them.
struct Sums {
  double mass = 0.0;
  Vec3 moment = Vec3::Zero(), momentum = Vec3::Zero();
  Sums& operator+=(const Sums& s) {
    mass += s.mass;
    moment += s.moment;
    momentum += s.momentum;
    return *this;
  }
};

struct Rotation {
  double inertia = 0.0, angular_momentum = 0.0;  // I_zz, L_z
  Rotation& operator+=(const Rotation& r) {
    inertia += r.inertia;
    angular_momentum += r.angular_momentum;
    return *this;
  }
};

/// R I R^T z: angular momentum of body b per unit spin about z.
Vec3 spin_response(const Bodies& bodies, std::size_t b) {
  const Quat& q = bodies.orientation[b];
  return q * (q.conjugate() * Vec3::UnitZ()).cwiseProduct(bodies.inertia[b]);
}

double kinetic_energy(const Bodies& bodies, std::size_t b) {
  return 0.5 * bodies.mass[b] * bodies.velocity[b].squaredNorm() +
         0.5 * angular_velocity(bodies, b).dot(bodies.spin[b]);
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
  const std::size_t n = bodies.size();
  const Sums sums = parallel_sum(n, Sums{}, [&](std::size_t b) {
    if (!members[b]) return Sums{};
    const double m = bodies.mass[b];
    return Sums{m, m * separation(bodies, 0, b), m * bodies.velocity[b]};
  });
  const Vec3 center = sums.moment / sums.mass, drift = sums.momentum / sums.mass;
  const Rotation now = parallel_sum(n, Rotation{}, [&](std::size_t b) {
    if (!members[b]) return Rotation{};
    const Vec3 x = separation(bodies, 0, b) - center, v = bodies.velocity[b] - drift;
    const double m = bodies.mass[b];
    return Rotation{m * (x.x() * x.x() + x.y() * x.y()) + spin_response(bodies, b).z(),
                    m * (x.x() * v.y() - x.y() * v.x()) + bodies.spin[b].z()};
  });
  const double change = 2.0 * kPi / period - now.angular_momentum / now.inertia;

  struct Effect {
    Vec3 momentum = Vec3::Zero();
    double work = 0.0;
    Effect& operator+=(const Effect& e) {
      momentum += e.momentum;
      work += e.work;
      return *this;
    }
  };
  const Effect effect = parallel_sum(n, Effect{}, [&](std::size_t b) {
    if (!members[b]) return Effect{};
    const double before = kinetic_energy(bodies, b);
    const Vec3 x = separation(bodies, 0, b) - center;
    const Vec3 dv = change * Vec3::UnitZ().cross(x), ds = change * spin_response(bodies, b);
    bodies.velocity[b] += dv;
    bodies.spin[b] += ds;
    return Effect{bodies.mass[b] * x.cross(dv) + ds, kinetic_energy(bodies, b) - before};
  });
  return {period, effect.momentum, effect.work};
}

}  // namespace cairn
