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

}  // namespace

Quat attitude_at(const HeldGravity& held, double time) {
  const Vec3 angle = (time - held.time) * held.omega;
  const double size = angle.norm();
  if (size == 0.0) return held.attitude;
  return Quat(Eigen::AngleAxisd(size, angle / size)) * held.attitude;
}

void renew(HeldGravity& held, const Wrenches& now, std::span<const double> masses, double time,
           const Vec3& omega, double dt, bool forecasts, const std::function<std::uint64_t()>& steps) {
  held.attitude = attitude_at(held, time).normalized();
  held.time = time;
  held.omega = omega;
  const bool first = held.steps == 0, goes_on = held.steps > 1;
  if (!forecasts) {
    held.from = now;
    held.steps = steps();
    held.interval = static_cast<double>(held.steps) * dt;
    return;
  }
  held.miss = first ? 0.0 : relative_difference(held.to.force, now.force, masses);
  if (goes_on)
    std::swap(held.from, held.to);
  else
    held.from = now;
  const double former = held.interval;
  held.steps = steps();
  held.interval = static_cast<double>(held.steps) * dt;
  const double ratio = first ? 0.0 : held.interval / former;
  const Wrenches& before = first ? now : held.evaluated;
  forecast(now.force, before.force, ratio, held.to.force);
  forecast(now.torque, before.torque, ratio, held.to.torque);
  held.evaluated = now;
}

void extrapolate(const HeldGravity& held, double time, std::span<const Vec3> positions,
                 std::span<const double> masses, std::span<Vec3> force, std::span<Vec3> torque) {
  constexpr std::size_t kBlock = 512;
  const Mat3 turned = attitude_at(held, time).toRotationMatrix();
  const double part = held.interval > 0.0 ? (time - held.time) / held.interval : 0.0;
  const bool moves = !held.to.force.empty() && part != 0.0, points = held.from.torque.empty();
  const auto at = [&](const std::vector<Vec3>& from, const std::vector<Vec3>& to, std::size_t g) -> Vec3 {
    return turned * (moves ? Vec3(from[g] + part * (to[g] - from[g])) : from[g]);
  };
  const std::size_t n = positions.size();
  const Vec3 origin = positions[0];
  std::vector<NetWrench> nets((n + kBlock - 1) / kBlock);
  parallel_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
    NetWrench net;
    for (std::size_t g = begin; g < end; ++g) {
      force[g] = at(held.from.force, held.to.force, g);
      torque[g] = points ? Vec3(Vec3::Zero()) : at(held.from.torque, held.to.torque, g);
      net.add(positions[g] - origin, masses[g], force[g], torque[g]);
    }
    nets[begin / kBlock] = net;
  });
  NetWrench total;
  for (const NetWrench& net : nets) total += net;
  const Balance balance(total);
  parallel_for(n, [&](std::size_t g) {
    force[g] += balance.force_on(positions[g] - origin, masses[g], force[g]);
    torque[g] += masses[g] * balance.torque;
  });
}

std::uint64_t automatic_steps(const HeldGravity& held, double error, double shortest, double dt) {
  // Evaluations that each err by `error`, independently, differ from their linear forecast by 2.4 times that.
  constexpr double kMost = 2.5, kFew = 1.5, kAim = 2.0;
  double steps = std::max(1.0, static_cast<double>(held.steps));
  if (held.miss > kMost * error)
    steps *= std::max(0.5, std::sqrt(kAim * error / held.miss));
  else if (held.miss < kFew * error)
    steps *= 2.0;
  const double most = std::min(std::sqrt(error) * shortest / dt, 1e6);
  return static_cast<std::uint64_t>(std::max(1.0, std::min(std::floor(steps), std::floor(most))));
}

}  // namespace cairn::gravity
