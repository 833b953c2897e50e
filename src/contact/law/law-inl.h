// The contact law of one pair: spring, dashpot and slider for each relative motion, with cohesion.
// Pure functions of one contact, for T = double or Batch (several contacts at once).
// Equations: Zhang et al. 2017 (Icarus 294, 98) section 2, Zhang et al. 2021 (Icarus 362, 114433) eq. 1,
// Schwartz et al. 2012 (Granular Matter 14, 363), Jiang et al. 2015.

#include "contact/law/features.h"
#include "contact/law/memory.h"
#include "core/simd-inl.h"

#if defined(CAIRN_CONTACT_LAW_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_CONTACT_LAW_INL_H
#undef CAIRN_CONTACT_LAW_INL_H
#else
#define CAIRN_CONTACT_LAW_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {

/// PairLaw, one or several at a time.
template <class T>
struct LawConstants {
  T k_n, k_s, friction, rolling, twisting, beta, cohesion;

  LawConstants() = default;
  CAIRN_INLINE explicit LawConstants(const PairLaw& law)
      : k_n(law.k_n),
        k_s(law.k_s),
        friction(law.friction),
        rolling(law.rolling),
        twisting(law.twisting),
        beta(law.beta),
        cohesion(law.cohesion) {}
};

/// Where the two surfaces meet, at the end of the drift and in its middle.
template <class T>
struct ContactGeometry {
  Triple<T> n, n_mid;  ///< unit normal from i to j
  T overlap;           ///< m
  T radius;            ///< effective radius, m
  T slip_lever;        ///< (l_j - l_i) / (2 l_i l_j), 1/m; used by rolling_slip = zhang2017 only
};

/// Relative motion of j against i at the contact point.
template <class T>
struct ContactMotion {
  Triple<T> u, w;          ///< velocity (m/s) and spin (rad/s) predicted for the end of the step: dashpots
  Triple<T> u_mid, w_mid;  ///< the same in mid-step: springs
  Triple<T> turn;  ///< mean of the two bodies' spins in mid-step, (2 / dt) tan(angle / 2), rad/s: carries the
                   ///< springs
  T dt;            ///< part of the step during which the contact has existed, s
};

/// Force and couple on i (j gets the opposite) and the work lost in the step.
template <class T>
struct ContactAction {
  Triple<T> force;   ///< N
  Triple<T> couple;  ///< N m, rolling and twisting
  T dissipated;      ///< J
};

/// Rotation by the angle whose tangent is |half|, about `half`.
template <class T>
class Rotation {
 public:
  CAIRN_INLINE explicit Rotation(const Triple<T>& half) {
    // (1 - cosine) / tangent^2; the series is exact to round-off below the limit.
    const T h2 = dot(half, half), limit(1e-4);
    T versine = fma(h2, fma(h2, fma(h2, T(-0.2734375), T(0.3125)), T(-0.375)), T(0.5));
    if (any(h2 > limit)) {
      const T secant = sqrt(T(1.0) + h2);
      versine = select(h2 > limit, T(1.0) / (secant * (T(1.0) + secant)), versine);
    }
    const T cosine = fma(-h2, versine, T(1.0));  // the sine is cosine times tangent
    const Triple<T> a = versine * half, s = cosine * half;
    const T xy = a.x * half.y, xz = a.x * half.z, yz = a.y * half.z;
    x_ = {fma(a.x, half.x, cosine), xy - s.z, xz + s.y};
    y_ = {xy + s.z, fma(a.y, half.y, cosine), yz - s.x};
    z_ = {xz - s.y, yz + s.x, fma(a.z, half.z, cosine)};
  }
  CAIRN_INLINE Triple<T> operator()(const Triple<T>& a) const { return {dot(x_, a), dot(y_, a), dot(z_, a)}; }

 private:
  Triple<T> x_, y_, z_;  // rows of the matrix
};

/// `a` made orthogonal to the unit vector n at unchanged length.
template <class T>
CAIRN_INLINE Triple<T> flatten(const Triple<T>& a, const Triple<T>& n) {
  const T along = dot(a, n), zero(0.0);
  const Triple<T> flat = fma(-along, n, a);
  const T flat2 = dot(flat, flat);
  const auto some = flat2 > zero;
  // sqrt(1 + q); springs of a step have hardly turned, and below the limit the series is exact to round-off.
  const T q = select(some, along * along / select(some, flat2, T(1.0)), zero), limit(1e-5);
  T scale = fma(q, fma(q, T(-0.125), T(0.5)), T(1.0));
  if (any(q > limit)) scale = select(q > limit, sqrt(T(1.0) + q), scale);
  return scale * flat;
}

/// min(1, limit / length) for a vector of squared length `length2`.
template <class T>
CAIRN_INLINE T cut(T limit, T length2) {
  const auto over = length2 > limit * limit;
  T scale(1.0);
  if (any(over)) scale = select(over, limit * rsqrt(select(over, length2, T(1.0))), scale);
  return scale;
}

/// Advances the springs over the drift, evaluates spring + dashpot + slider for each motion that F has.
template <Features F, class T>
CAIRN_INLINE ContactAction<T> evaluate(const LawConstants<T>& law, const ContactGeometry<T>& geometry,
                                       const ContactMotion<T>& motion, ContactMemory<T>& memory) {
  const Triple<T>& n = geometry.n;
  const Triple<T>& n_mid = geometry.n_mid;
  const T dt = motion.dt;
  const T zero(0.0);

  const T u_n = dot(motion.u, n);
  const T u_n_mid = dot(motion.u_mid, n_mid);
  const T press = fma(law.k_n, geometry.overlap, -(memory.c_n * u_n));
  T along = -press;  // component along n of the force on i
  if constexpr (F.cohesion) along = fma(law.cohesion * geometry.radius, geometry.radius, along);

  ContactAction<T> action;
  action.force = along * n;
  action.couple = {zero, zero, zero};
  action.dissipated = memory.c_n * u_n_mid * u_n_mid * dt;
  if constexpr (!F.tangential) return action;

  const T pressed = max(press, zero);
  // The same in mid-step, for the ledger.
  const T pressed_mid =
      max(fma(law.k_n, fma(T(0.5) * dt, u_n_mid, geometry.overlap), -(memory.c_n * u_n_mid)), zero);
  const Rotation<T> turn((T(0.5) * dt) * motion.turn);  // of the springs over half a step
  const auto advance = [&](const Triple<T>& spring, const Triple<T>& rate) HWY_ATTR
      __attribute__((always_inline)) {
    return flatten(turn(fma(dt, rate, turn(spring))), n);
  };
  // Spring, dashpot, slider: the spring is shortened to what the slider holds, then the sum is cut to the
  // limit, `hold` times the pressing force. The work lost is, to second order, that done on the drag of
  // mid-step less what the spring has gained; where nothing slides that is the work of the dashpot.
  const auto slide = [&](T stiffness, T damping, T hold, Triple<T> & spring, const Triple<T>& rate,
                         const Triple<T>& rate_mid) HWY_ATTR __attribute__((always_inline)) {
    const T limit = hold * pressed, limit_mid = hold * pressed_mid;
    const T half_stiffness = T(0.5) * stiffness;
    const T length2 = dot(spring, spring), way2 = dt * dot(rate_mid, rate_mid);
    Triple<T> sum = fma(damping, rate, stiffness * spring);
    const Triple<T> sum_mid = fma(stiffness, spring, fma(-half_stiffness, dt, damping) * rate_mid);
    T lost = damping * way2;
    const auto slides = (stiffness * stiffness * length2 > limit * limit) | (dot(sum, sum) > limit * limit) |
                        (dot(sum_mid, sum_mid) > limit_mid * limit_mid);
    if (any(slides)) {
      const T stretch = dt * dot(rate_mid, spring);
      const T keep = cut(limit, stiffness * stiffness * length2);
      Triple<T> kept = keep * spring;
      // A spring held at its limit turns towards the rate while it slides: half of what is cut off of it,
      // over its length, is the share by which the rate counts more for that to be right to second order.
      const T over = T(1.0) - keep, little(1e-6);
      if (any(over > little)) {
        const T share = select(over > little, T(0.5) * over * fma(over, T(1.0) + over, T(1.0)), zero);
        const Triple<T> longer = fma(share * dt, fma(-dot(rate_mid, n), n, rate_mid), spring);
        kept = cut(limit, stiffness * stiffness * dot(longer, longer)) * longer;
      }
      const Triple<T> drag_mid = fma(half_stiffness, kept + fma(-dt, rate_mid, spring), damping * rate_mid);
      const T work = cut(limit_mid, dot(drag_mid, drag_mid)) * dt * dot(drag_mid, rate_mid);
      const T gain = (dot(kept, kept) - length2) + fma(T(2.0), stretch, -dt * way2);
      lost = select(slides, fma(-half_stiffness, gain, work), lost);
      spring = kept;
      const Triple<T> whole = fma(damping, rate, stiffness * kept);
      const T scale = cut(limit, dot(whole, whole));
      sum = {select(slides, scale * whole.x, sum.x), select(slides, scale * whole.y, sum.y),
             select(slides, scale * whole.z, sum.z)};
    }
    action.dissipated += lost;
    return sum;
  };

  const Triple<T> u_t = fma(-u_n, n, motion.u);
  const Triple<T> u_t_mid = fma(-u_n_mid, n_mid, motion.u_mid);
  memory.slide = advance(memory.slide, u_t_mid);
  action.force = action.force + slide(law.k_s, memory.c_s, law.friction, memory.slide, u_t, u_t_mid);

  if constexpr (F.rolling || F.twisting) {
    const T patch = law.beta * geometry.radius;
    const T patch2 = patch * patch;
    const T w_n = dot(motion.w, n);
    const T w_n_mid = dot(motion.w_mid, n_mid);
    if constexpr (F.rolling) {
      Triple<T> w_r = fma(-w_n, n, motion.w);
      Triple<T> w_r_mid = fma(-w_n_mid, n_mid, motion.w_mid);
      if constexpr (F.rolling_slip) {
        w_r = fma(geometry.slip_lever, cross(n, u_t), w_r);
        w_r_mid = fma(geometry.slip_lever, cross(n_mid, u_t_mid), w_r_mid);
      }
      memory.roll = advance(memory.roll, w_r_mid);
      action.couple = slide(law.k_n * patch2, memory.c_n * patch2, law.rolling * geometry.radius, memory.roll,
                            w_r, w_r_mid);
    }
    if constexpr (F.twisting) {
      const T hold = law.twisting * geometry.radius, limit = hold * pressed, limit_mid = hold * pressed_mid;
      const T stiffness = T(2.0) * law.k_s * patch2, damping = T(2.0) * memory.c_s * patch2;
      const T before = memory.twist, grown = fma(dt, w_n_mid, before);
      const T after = cut(limit, stiffness * stiffness * grown * grown) * grown;
      const T drag_mid = fma(damping, w_n_mid, T(0.5) * stiffness * (before + after));
      action.dissipated += fma(max(-limit_mid, min(limit_mid, drag_mid)) * w_n_mid, dt,
                               T(0.5) * stiffness * (before - after) * (before + after));
      memory.twist = after;
      const T couple = max(-limit, min(limit, fma(damping, w_n, stiffness * after)));
      action.couple = fma(couple, n, action.couple);
    }
  }
  return action;
}

/// Energy stored in the springs of a contact, less the work that cohesion has gained (J).
template <Features F>
double stored_energy(const LawConstants<double>& law, double overlap, double radius,
                     const ContactMemory<double>& memory) {
  double energy = 0.5 * law.k_n * overlap * overlap;
  if constexpr (F.cohesion) energy -= law.cohesion * radius * radius * overlap;
  if constexpr (F.tangential) energy += 0.5 * law.k_s * dot(memory.slide, memory.slide);
  const double patch2 = law.beta * law.beta * radius * radius;
  if constexpr (F.rolling) energy += 0.5 * law.k_n * patch2 * dot(memory.roll, memory.roll);
  if constexpr (F.twisting) energy += law.k_s * patch2 * memory.twist * memory.twist;
  return energy;
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#endif
