#include "gravity/renewal.h"

#include <algorithm>
#include <cmath>

#include "core/elementary.h"
#include "core/parallel.h"

namespace cairn::gravity {

namespace {

/// Sums of squares by which two sets of forces are compared.
struct Squares {
  double difference = 0.0, size = 0.0;
  Squares& operator+=(const Squares& other) {
    difference += other.difference;
    size += other.size;
    return *this;
  }
};

double relative_difference(std::span<const Vec3> forces, std::span<const Vec3> reference,
                           std::span<const double> masses) {
  const Squares s = parallel_sum(reference.size(), Squares{}, [&](std::size_t g) {
    return Squares{(forces[g] - reference[g]).squaredNorm() / masses[g],
                   reference[g].squaredNorm() / masses[g]};
  });
  return s.size > 0.0 ? std::sqrt(s.difference / s.size) : 0.0;
}

/// now + ratio (now - before).
void forecast(std::span<const Vec3> now, std::span<const Vec3> before, double ratio, std::vector<Vec3>& out) {
  out.resize(now.size());
  parallel_for(now.size(), [&](std::size_t g) { out[g] = now[g] + ratio * (now[g] - before[g]); });
}

/// The pile's frame goes on from where it is at `time`.
void look(HeldGravity& held, double time, const Vec3& omega) {
  held.attitude = attitude_at(held, time).normalized();
  held.time = time;
  held.omega = omega;
}

/// `from` is now what `to` was aimed at.
void arrive(HeldGravity& held) {
  if (!held.to.force.empty()) std::swap(held.from, held.to);
}

}  // namespace

Quat attitude_at(const HeldGravity& held, double time) {
  const Vec3 angle = (time - held.time) * held.omega;
  const double size = angle.norm();
  if (size == 0.0) return held.attitude;
  return rotation(size, angle / size) * held.attitude;
}

void renew(HeldGravity& held, const Wrenches& now, std::span<const double> masses, double time,
           const Vec3& omega, double dt, bool forecasts, const std::function<std::uint64_t()>& steps) {
  const double passed = time - held.evaluated_time;
  look(held, time, omega);
  held.evaluated_time = time;
  const bool first = held.steps == 0, goes_on = held.steps > 1;
  if (!forecasts) {
    held.from = now;
    held.steps = steps();
    held.interval = static_cast<double>(held.steps) * dt;
    return;
  }
  arrive(held);
  held.miss = first ? 0.0 : relative_difference(held.from.force, now.force, masses);
  if (!goes_on) held.from = now;
  held.steps = steps();
  held.interval = static_cast<double>(held.steps) * dt;
  const double ratio = first ? 0.0 : held.interval / passed;
  const Wrenches& before = first ? now : held.evaluated;
  forecast(now.force, before.force, ratio, held.to.force);
  forecast(now.torque, before.torque, ratio, held.to.torque);
  held.evaluated = now;
}

bool rests(const HeldGravity& held, std::span<const Vec3> places, double reach) {
  if (held.places.size() != places.size()) return false;
  return parallel_sum(places.size(), 0, [&](std::size_t i) {
           return (places[i] - held.places[i]).squaredNorm() <= reach * reach ? 0 : 1;
         }) == 0;
}

void hold_on(HeldGravity& held, double time, const Vec3& omega, double dt, std::uint64_t steps) {
  look(held, time, omega);
  arrive(held);
  held.to = held.from == held.evaluated ? Wrenches{} : held.evaluated;
  held.steps = steps;
  held.interval = static_cast<double>(steps) * dt;
}

double reach_at_rest(double error, double scale, double fall_time) {
  return 0.025 * error * scale * fall_time * fall_time;
}

std::uint64_t most_steps(double error, double shortest, double dt) {
  return static_cast<std::uint64_t>(
      std::max(1.0, std::floor(std::min(std::sqrt(error) * shortest / dt, 1e6))));
}

std::uint64_t automatic_steps(const HeldGravity& held, double error, std::uint64_t most) {
  // Evaluations that each err by `error`, independently, differ from their linear forecast by 2.4 times that.
  constexpr double kMost = 2.5, kFew = 1.5, kAim = 2.0;
  double steps = std::max(1.0, static_cast<double>(held.steps));
  if (held.miss > kMost * error)
    steps *= std::max(0.5, std::sqrt(kAim * error / held.miss));
  else if (held.miss < kFew * error)
    steps *= 2.0;
  return std::clamp(static_cast<std::uint64_t>(std::floor(steps)), std::uint64_t{1}, most);
}

}  // namespace cairn::gravity
