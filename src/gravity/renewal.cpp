#include "gravity/renewal.h"

#include <algorithm>
#include <cmath>

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

std::array<PackVec, 3> rows(const Quat& rotation) {
  const Mat3 matrix = rotation.toRotationMatrix();
  return {spread(matrix.row(0)), spread(matrix.row(1)), spread(matrix.row(2))};
}

}  // namespace

Quat attitude_at(const HeldGravity& held, double time) {
  const Vec3 angle = (time - held.time) * held.omega;
  const double size = angle.norm();
  if (size == 0.0) return held.attitude;
  return Quat(Eigen::AngleAxisd(size, angle / size)) * held.attitude;
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

SelfGravity::SelfGravity(const HeldGravity& held, double time, std::span<const Vec3> positions,
                         std::span<const double> masses)
    : held_(held),
      positions_(positions),
      masses_(masses),
      turned_(rows(attitude_at(held, time))),
      part_(held.to.force.empty() ? 0.0 : (time - held.time) / held.interval),
      balance_(positions, masses, [this](std::size_t g, std::size_t count) { return unbalanced(g, count); }) {
}

PackWrench SelfGravity::unbalanced(std::size_t g, std::size_t count) const {
  const auto now = [&](const std::vector<Vec3>& from, const std::vector<Vec3>& to) -> PackVec {
    PackVec f = load(&from[g], count);
    if (part_ != 0.0) f = fma(spread(part_), load(&to[g], count) - f, f);
    return {dot(turned_[0], f), dot(turned_[1], f), dot(turned_[2], f)};
  };
  return {now(held_.from.force, held_.to.force),
          held_.from.torque.empty() ? PackVec{} : now(held_.from.torque, held_.to.torque)};
}

void SelfGravity::get(std::size_t g, std::size_t count, Vec3* force, Vec3* torque) const {
  const PackWrench w =
      balance_(load(&positions_[g], count), load_masses(masses_, g, count), unbalanced(g, count));
  store(force, w.force, count);
  store(torque, w.torque, count);
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
