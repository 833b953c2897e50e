// The two steps that a contact shares with its absence. Leapfrog gives a force half a step on either side of
// its evaluation; but a contact begins and ends somewhere within a step, where dashpot and cohesion jump. The
// impulses here make up the difference to the part of the step for which the contact was there; without them
// restitution depends on the phase of the step at first touch (0.548-0.561 for 0.55 at 50 steps a contact).
//
// Along the normal both steps obey one rule, the same forwards and backwards in time: impulse times mean
// speed is the work of spring and cohesion between the surfaces' meeting and the overlap at that end of the
// step which lies within the contact, less what the dashpot takes on that way. Beside other forces they are
// trapezoids in time.

#include <cmath>

#include "contact/law/law-inl.h"

#if defined(CAIRN_CONTACT_LAW_PARTIAL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_CONTACT_LAW_PARTIAL_INL_H
#undef CAIRN_CONTACT_LAW_PARTIAL_INL_H
#else
#define CAIRN_CONTACT_LAW_PARTIAL_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {

/// How long before the end of the step the surfaces met (s), from the overlap (m), the normal velocity in
/// mid-step (m/s) and the step dt (s): dt where they were not nearing each other.
template <class T>
CAIRN_INLINE T age(T overlap, T u_n_mid, T dt) {
  const auto nearing = u_n_mid < T(0.0);
  return select(nearing, min(dt, overlap / select(nearing, -u_n_mid, T(1.0))), dt);
}

/// Pull of cohesion (N).
template <Features F, class T>
CAIRN_INLINE T pull(const LawConstants<T>& law, T radius) {
  if constexpr (F.cohesion) return law.cohesion * radius * radius;
  return T(0.0);
}

/// The normal part of a contact that begins or ends within a step.
struct PartialStep {
  double k_n;   ///< N/m
  double c_n;   ///< kg/s
  double pull;  ///< N, of cohesion
  double mass;  ///< kg, effective along the normal
  double dt;    ///< s

  /// Energy (J) of spring and cohesion as leapfrog keeps it: in a free oscillation the sum of this and of
  /// mass v^2 / 2 is the same at the ends of all steps; in flight that sum is greater by the square of
  /// `stretch`, which makes leapfrog's own energy, that of its steps to second order, one and the same.
  double potential(double overlap) const {
    return (1.0 - 0.25 * dt * dt * k_n / mass) * (0.5 * k_n * overlap - pull) * overlap;
  }
  double stretch() const { return std::sqrt(1.0 + dt * dt * k_n / (6.0 * mass)); }
  /// Mean of the speeds (m/s) at both ends of the way `overlap` (m), begun at `speed`, on which `gain` (J) is
  /// gained beside what the dashpot takes; 0: the way cannot be gone.
  double mean_speed(double speed, double overlap, double gain) const {
    const double free = 2.0 * mass * speed - c_n * overlap, square = free * free + 8.0 * mass * gain;
    return square >= 0.0 ? max(0.0, 0.25 * (free + sqrt(square)) / mass) : 0.0;
  }
};

/// Impulse along n (N s) that i gets in the step of first touch, which ends with `overlap` (m) and would end
/// with the surfaces nearing each other at `speed` (m/s). Where the spring would have stopped them it is that
/// of `force` (N), the one at the end, for half a step.
inline double first_impulse(const PartialStep& step, double overlap, double speed, double force) {
  const double within = speed / step.stretch();
  const double mean = step.mean_speed(within, overlap, -step.potential(overlap));
  return mean > 0.0 ? step.mass * (2.0 * mean - within - speed) : 0.5 * step.dt * force;
}

/// What a contact that has begun `motion.dt` ago is due beyond the closing half kick of `end`, its action at
/// the end of the step of dt: N s, N m s. `normal` is its whole impulse along n.
template <Features F, class T>
CAIRN_INLINE ContactAction<T> first_touch(const LawConstants<T>& law, const ContactGeometry<T>& geometry,
                                          const ContactMotion<T>& motion, const ContactMemory<T>& memory,
                                          const ContactAction<T>& end, T normal, T dt) {
  const T zero(0.0), half(0.5), age = motion.dt;
  const Triple<T> none{zero, zero, zero};
  ContactAction<T> due{none, none, zero};
  if constexpr (F.tangential) {  // nothing was stretched as the surfaces met
    ContactGeometry<T> met = geometry;
    met.overlap = zero;
    ContactMotion<T> then = motion;
    then.u = motion.u_mid;
    then.w = motion.w_mid;
    then.dt = zero;
    ContactMemory<T> fresh{memory.c_n, memory.c_s, none, none, zero};
    const ContactAction<T> first = evaluate<F>(law, met, then, fresh);
    due.force = fma(half * age, first.force, (half * (age - dt)) * end.force);
    due.couple = fma(half * age, first.couple, (half * (age - dt)) * end.couple);
  }
  const Triple<T>& n = geometry.n;
  due.force = fma(normal - half * dt * dot(end.force, n) - dot(due.force, n), n, due.force);
  return due;
}

/// Velocities (m/s) at which surfaces go apart that part within a step.
struct PartingSpeeds {
  double start;  ///< as the step began
  double mid;    ///< after the opening half kick, along the normal of the start
  double end;    ///< the same along the normal of the end
};

/// What a contact that parts within the step is due beyond its opening half kick: N s, N m s, and the work
/// (J) lost in the step. `start` is where the surfaces met as the step began, but with the normal of its end;
/// `motion` that of mid-step, its dt the part of the step for which the contact was there yet.
template <Features F>
ContactAction<double> parting(const LawConstants<double>& law, const ContactGeometry<double>& start,
                              const ContactMotion<double>& motion, const PartingSpeeds& speeds,
                              const PartialStep& step, ContactMemory<double> memory) {
  const double overlap = start.overlap;
  ContactAction<double> due{{}, {}, stored_energy<F>(law, 0.0, start.radius, memory)};
  const double mean = step.mean_speed(speeds.start, overlap, step.potential(overlap));
  double after = step.stretch() * (2.0 * mean - speeds.start), lost = step.c_n * overlap * mean;
  if (!(mean > 0.0 && after > 0.0)) {  // too slow to part, had the step not been one too long
    after = speeds.start +
            motion.dt / step.mass * (0.5 * step.k_n * overlap - step.pull - step.c_n * speeds.start);
    lost = step.potential(overlap) + 0.5 * step.mass * (speeds.start * speeds.start - after * after);
  }
  due.dissipated += lost;
  const double given = 0.5 * step.dt / step.mass * (step.k_n * overlap - step.pull - step.c_n * speeds.start);
  const double right = speeds.mid - given + after - speeds.start;  // what `mid` should be
  const double square = speeds.end * speeds.end + right * right - speeds.mid * speeds.mid;
  const double change = right > 0.0 && square > 0.0 ? sqrt(square) - speeds.end : right - speeds.mid;
  if constexpr (F.tangential) {
    ContactMotion<double> then = motion;
    then.dt = 0.0;
    const ContactAction<double> last = evaluate<F>(law, start, then, memory);
    const Triple<double> drag = fma(-dot(last.force, start.n), start.n, last.force);
    due.dissipated += 0.5 * motion.dt * (dot(drag, motion.u) + dot(last.couple, motion.w));
    due.force = (0.5 * (motion.dt - step.dt)) * drag;
    due.couple = (0.5 * (motion.dt - step.dt)) * last.couple;
  }
  due.force = fma(-step.mass * change, start.n, due.force);
  return due;
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#endif
