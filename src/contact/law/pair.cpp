#include "contact/law/pair.h"

#include <algorithm>
#include <cmath>

#include "core/elementary.h"

namespace cairn {

Material mix(const Material& a, const Material& b) {
  const auto mean = [](double x, double y) { return x == y ? x : std::sqrt(x * y); };
  return {.name = a.name + "/" + b.name,
          .restitution_normal = mean(a.restitution_normal, b.restitution_normal),
          .restitution_tangential = mean(a.restitution_tangential, b.restitution_tangential),
          .friction = mean(a.friction, b.friction),
          .friction_rolling = mean(a.friction_rolling, b.friction_rolling),
          .friction_twisting = mean(a.friction_twisting, b.friction_twisting),
          .shape_factor = 0.5 * (a.shape_factor + b.shape_factor),
          .cohesion = mean(a.cohesion, b.cohesion)};
}

double damping_ratio(double restitution) {
  if (restitution <= 0.0) return 2.0;
  const double log_e = logarithm(restitution);
  return -2.0 * log_e / std::sqrt(kPi * kPi + log_e * log_e);
}

PairLaw make_pair_law(const Material& a, const Material& b, double k_n) {
  const Material pair = mix(a, b);
  const double beta = pair.shape_factor;
  const auto in_series = [](double x, double y) {
    const double softer = std::min(x, y), harder = std::max(x, y);
    return x == y ? x : 2.0 * softer * (harder / (softer + harder));
  };
  const double k_a = a.stiffness.value_or(k_n), k_b = b.stiffness.value_or(k_n);
  return {.k_n = in_series(k_a, k_b),
          .k_s = in_series(a.stiffness_ratio * k_a, b.stiffness_ratio * k_b),
          .damping_n = damping_ratio(pair.restitution_normal),
          .damping_s = damping_ratio(pair.restitution_tangential),
          .friction = pair.friction,
          .rolling = pair.friction_rolling * beta,
          .twisting = pair.friction_twisting * beta * pair.friction,
          .beta = beta,
          .cohesion = pair.cohesion * 4.0 * beta * beta};
}

Features required_features(const std::vector<Material>& materials, bool zhang_slip) {
  Features wanted;
  for (const Material& a : materials)
    for (const Material& b : materials) {
      const PairLaw law = make_pair_law(a, b, 1.0);
      wanted.tangential |= law.friction > 0.0;
      wanted.rolling |= law.rolling > 0.0;
      wanted.twisting |= law.twisting > 0.0;
      wanted.cohesion |= law.cohesion > 0.0;
    }
  wanted.rolling_slip = zhang_slip && wanted.rolling;
  return compiled_set(wanted);
}

EffectiveMass effective_mass(const Inertia& i, const Vec3& arm_i, const Inertia& j, const Vec3& arm_j,
                             const Vec3& n) {
  // Mobility K = (1/M_i + 1/M_j) 1 + [a]x I^-1 [a]x^T: the velocity of the contact point per unit force.
  const auto mobility = [](const Inertia& side, const Vec3& arm) -> Mat3 {
    Mat3 skew;
    skew << 0.0, -arm.z(), arm.y(), arm.z(), 0.0, -arm.x(), -arm.y(), arm.x(), 0.0;
    return side.inverse_mass * Mat3::Identity() + skew * side.inverse_inertia * skew.transpose();
  };
  const Mat3 k = mobility(i, arm_i) + mobility(j, arm_j);
  const double normal = n.dot(k * n);
  return {1.0 / normal, 2.0 / (k.trace() - normal)};
}

}  // namespace cairn
