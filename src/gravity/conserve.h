// What makes self-gravity conserve momentum and angular momentum to round-off: the little that a method or a
// forecast leaves of net force and net torque is taken away, by the smallest change relative to what each
// group feels. Groups far from the others, which feel little, are changed little.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "gravity/simd.h"

namespace cairn::gravity {

/// Forces (N) on groups and torques (N m) about their centres of mass; no torques where all groups are
/// points.
struct Wrenches {
  std::vector<Vec3> force, torque;
};

/// Force (N) on and torque (N m) about `centres` of every group: points [first[g], first[g+1]).
void sum_groups(std::span<const Vec3> positions, std::span<const double> masses,
                std::span<const std::uint32_t> first, std::span<const Vec3> acceleration,
                std::span<const Vec3> centres, Wrenches& out);

/// A torque (N m) on weighted points as the rotation a that weight (a x arm) makes of it; the rest is what
/// has no lever: the part along the line of collinear points, and all of it in one place.
struct Turn {
  Vec3 rotation, rest;
};

/// `inertia`: of the weights about their centre. Principal moments below `smallest` times the largest count
/// as none.
Turn turn(const Mat3& inertia, const Vec3& torque, double smallest);

/// Sums over groups that tell what a balance takes. A group's weight is |F|^2 / m.
struct NetWrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();  ///< about the origin
  double mass = 0.0, weight = 0.0;
  Vec3 first = Vec3::Zero();   ///< of the weight
  Mat3 second = Mat3::Zero();  ///< of the weight

  NetWrench& operator+=(const NetWrench& other);
};

/// The change of wrenches that leaves no net force and no net torque: of forces by weight (shift + rotation x
/// X), which is the smallest change relative to |F| / sqrt(m) that does it; what torque they have no lever
/// for is taken from the groups' own torques, in proportion to mass.
struct Balance {
  Vec3 shift, rotation;
  Vec3 torque;  ///< over mass

  explicit Balance(const NetWrench& net);
};

/// Wrenches on kLanes groups.
struct PackWrench {
  PackVec force, torque;
};

/// Sets wrenches on groups at `positions` (m), of `masses` (kg), to at(g, count), the PackWrench of the
/// `count` groups from g on, balanced. Sums run in a fixed order, in parallel.
template <class At>
void set_balanced(std::span<const Vec3> positions, std::span<const double> masses, const At& at,
                  std::span<Vec3> force, std::span<Vec3> torque) {
  constexpr std::size_t kBlock = 512;
  const std::size_t n = positions.size();
  const PackVec origin = spread(positions[0]);  // a pile far from the zero keeps its digits
  const auto mass_of = [&](std::size_t g, std::size_t count) {
    if (count >= kLanes) return load(&masses[g]);
    Pack m = spread(1.0);  // lanes past the end are divided by it
    for (std::size_t i = 0; i < count; ++i) m[i] = masses[g + i];
    return m;
  };
  const Balance balance(parallel_block_sum(n, kBlock, NetWrench{}, [&](std::size_t begin, std::size_t end) {
    PackVec net_force, net_torque, first, diagonal, mixed;
    Pack mass{}, weight{};
    for (std::size_t g = begin; g < end; g += kLanes) {
      const std::size_t count = end - g;
      const PackWrench w = at(g, count);
      const PackVec x = load(&positions[g], count) - origin;
      const Pack m = mass_of(g, count), part = dot(w.force, w.force) / m;
      store(&force[g], w.force, count);
      store(&torque[g], w.torque, count);
      net_force = net_force + w.force;
      net_torque = net_torque + cross(x, w.force) + w.torque;
      mass += head(count) * m;
      weight += part;
      const PackVec moment{part * x.x, part * x.y, part * x.z};
      first = first + moment;
      diagonal = diagonal + PackVec{moment.x * x.x, moment.y * x.y, moment.z * x.z};
      mixed = mixed + PackVec{moment.y * x.z, moment.z * x.x, moment.x * x.y};
    }
    const Vec3 d = sum(diagonal), s = sum(mixed);
    Mat3 second;
    second << d.x(), s.z(), s.y(), s.z(), d.y(), s.x(), s.y(), s.x(), d.z();
    return NetWrench{sum(net_force), sum(net_torque), sum(mass), sum(weight), sum(first), second};
  }));
  const PackVec shift = spread(balance.shift), rotation = spread(balance.rotation);
  parallel_blocks(n, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; g += kLanes) {
      const std::size_t count = end - g;
      const PackVec x = load(&positions[g], count) - origin, f = load(&force[g], count);
      const Pack part = dot(f, f) / mass_of(g, count);
      store(&force[g], fma(part, shift + cross(rotation, x), f), count);
    }
    if (balance.torque != Vec3::Zero())
      for (std::size_t g = begin; g < end; ++g) torque[g] += masses[g] * balance.torque;
  });
}

}  // namespace cairn::gravity
