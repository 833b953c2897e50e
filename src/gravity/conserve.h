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

  bool operator==(const Wrenches&) const = default;
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

/// Sums over groups that tell what a balance takes. A group's weight is |F|^2 / m, roughly.
struct NetWrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();  ///< about the origin
  double mass = 0.0, weight = 0.0;
  Vec3 first = Vec3::Zero();   ///< of the weight
  Mat3 second = Mat3::Zero();  ///< of the weight

  NetWrench& operator+=(const NetWrench& other);
};

/// Wrenches on kLanes groups.
struct PackWrench {
  PackVec force, torque;
};

/// Masses (kg) of the `count` groups from g on; 1 in lanes past them, which are divided by it.
inline Pack load_masses(std::span<const double> masses, std::size_t g, std::size_t count) {
  if (count >= kLanes) return load(&masses[g]);
  Pack m = spread(1.0);
  for (std::size_t i = 0; i < count; ++i) m[i] = masses[g + i];
  return m;
}

/// The change of wrenches that leaves no net force and no net torque: of forces by weight (shift + rotation x
/// X), which is the smallest change relative to |F| / sqrt(m) that does it; what torque they have no lever
/// for is taken from the groups' own torques, in proportion to mass.
class Balance {
 public:
  /// For the wrenches at(g, count), the PackWrench of the `count` groups from g on, on groups at `positions`
  /// (m), of `masses` (kg). Sums run in a fixed order, in parallel.
  template <class At>
  Balance(std::span<const Vec3> positions, std::span<const double> masses, const At& at);

  /// The wrenches on kLanes groups at x (m), of masses m, with the change.
  PackWrench operator()(const PackVec& x, Pack m, const PackWrench& w) const {
    const PackVec lever = x - origin_;
    const Pack weight = weight_of(w.force, m);
    return {fma(weight, shift_ + cross(rotation_, lever), w.force), fma(m, torque_, w.torque)};
  }

 private:
  /// To four digits: the same wherever it is needed.
  static Pack weight_of(const PackVec& force, Pack mass) {
    return dot(force, force) * rough_reciprocal(mass);
  }
  void set(const NetWrench& net);

  PackVec origin_;  // a pile far from the zero keeps its digits
  PackVec shift_, rotation_;
  PackVec torque_;  // over mass
};

template <class At>
Balance::Balance(std::span<const Vec3> positions, std::span<const double> masses, const At& at)
    : origin_(spread(positions[0])) {
  set(parallel_block_sum(positions.size(), 512, NetWrench{}, [&](std::size_t begin, std::size_t end) {
    PackVec net_force, net_torque, first, diagonal, mixed;
    Pack mass{}, weight{};
    for (std::size_t g = begin; g < end; g += kLanes) {
      const std::size_t count = end - g;
      const PackWrench w = at(g, count);
      const PackVec x = load(&positions[g], count) - origin_;
      const Pack m = load_masses(masses, g, count), part = weight_of(w.force, m);
      net_force = net_force + w.force;
      net_torque = net_torque + cross(x, w.force) + w.torque;
      mass += count >= kLanes ? m : head(count) * m;
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
}

}  // namespace cairn::gravity
