#include "analysis/budget.h"

#include <Eigen/Core>

#include "body/cells.h"
#include "core/parallel.h"

namespace cairn {
namespace {

// Sums that carry their rounding errors along [Ogita, Rump & Oishi 2005, SIAM J. Sci. Comput. 26, 1955:
// Sum2].
template <int count>
struct Compensated {
  using Values = Eigen::Vector<double, count>;
  Values sum = Values::Zero(), error = Values::Zero();

  Compensated& operator+=(const Values& term) {
    const Values total = sum + term;
    const Values added = total - sum;
    error += (sum - (total - added)) + (term - added);
    sum = total;
    return *this;
  }
  Compensated& operator+=(const Compensated& other) {
    *this += other.sum;
    error += other.error;
    return *this;
  }
  Values value() const { return sum + error; }
};

}  // namespace

Budget budget(const Bodies& bodies) {
  const std::size_t count = bodies.size();
  if (count == 0) return {};
  Budget result;

  using First = Compensated<7>;
  const auto first_term = [&](std::size_t b) -> First::Values {
    if (is_held(bodies, b)) return First::Values::Zero();
    const double m = bodies.mass[b];
    First::Values term;
    term[0] = m;
    term.segment<3>(1) = m * separation(bodies, 0, b);
    term.segment<3>(4) = m * bodies.velocity[b];
    return term;
  };
  const First::Values first = parallel_sum(count, First{}, first_term).value();
  result.mass = first[0];
  const Vec3 center = first.segment<3>(1) / result.mass;  // from body 0, so that a far pile loses nothing
  result.center = place(bodies, 0) + center;
  result.momentum = first.segment<3>(4);
  const Vec3 velocity = result.momentum / result.mass;

  using Second = Compensated<11>;
  const auto second_term = [&](std::size_t b) -> Second::Values {
    if (is_held(bodies, b)) return Second::Values::Zero();
    const Vec3& spin = bodies.spin[b];
    const Vec3 p = bodies.mass[b] * bodies.velocity[b];
    const Vec3 arm = separation(bodies, 0, b) - center;
    const Vec3 relative = bodies.mass[b] * (bodies.velocity[b] - velocity);
    const Vec3 about_origin = place(bodies, b).cross(p), about_center = arm.cross(relative);
    Second::Values term;
    term.segment<3>(0) = about_origin + spin;
    term.segment<3>(3) = about_center + spin;
    term[6] = p.norm();
    term[7] = about_origin.norm() + spin.norm();
    term[8] = about_center.norm() + spin.norm();
    term[9] = 0.5 * p.dot(bodies.velocity[b]);
    term[10] = 0.5 * spin.dot(angular_velocity(bodies, b));
    return term;
  };
  const Second::Values second = parallel_sum(count, Second{}, second_term).value();
  result.angular_momentum_about_origin = second.segment<3>(0);
  result.angular_momentum_about_center = second.segment<3>(3);
  result.momentum_scale = second[6];
  result.angular_scale_about_origin = second[7];
  result.angular_scale_about_center = second[8];
  result.translational_energy = second[9];
  result.rotational_energy = second[10];
  return result;
}

double held_mass(const Bodies& bodies) {
  double mass = 0.0;
  for (std::size_t b = 0; b < bodies.held.size(); ++b)
    if (is_held(bodies, b)) mass += bodies.mass[b];
  return mass;
}

}  // namespace cairn
