#include "analysis/spin_state.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numeric>

#include "body/cells.h"
#include "core/elementary.h"
#include "core/error.h"
#include "core/parallel.h"

namespace cairn {
namespace {

// Moments about a reference point near the bodies, so that a pile far from the origin loses nothing.
struct FirstMoments {
  double mass = 0.0;
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();  // times mass

  FirstMoments& operator+=(const FirstMoments& other) {
    mass += other.mass;
    position += other.position;
    velocity += other.velocity;
    return *this;
  }
};

struct SecondMoments {
  Vec3 angular_momentum = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();

  SecondMoments& operator+=(const SecondMoments& other) {
    angular_momentum += other.angular_momentum;
    inertia += other.inertia;
    return *this;
  }
};

}  // namespace

std::vector<std::uint32_t> all_bodies(const Bodies& bodies) {
  std::vector<std::uint32_t> set(bodies.size());
  std::iota(set.begin(), set.end(), 0u);
  return set;
}

SpinState spin_state(const Bodies& bodies, std::span<const std::uint32_t> set) {
  if (set.empty()) throw InputError("an empty set of bodies has no spin state");
  const Vec3 drift = bodies.velocity[set[0]];
  const FirstMoments first = parallel_sum(set.size(), FirstMoments{}, [&](std::size_t k) {
    const std::uint32_t b = set[k];
    const double m = bodies.mass[b];
    return FirstMoments{m, m * separation(bodies, set[0], b), m * (bodies.velocity[b] - drift)};
  });
  const Vec3 center = first.position / first.mass, velocity = first.velocity / first.mass;

  const SecondMoments second = parallel_sum(set.size(), SecondMoments{}, [&](std::size_t k) {
    const std::uint32_t b = set[k];
    const double m = bodies.mass[b];
    const Vec3 arm = separation(bodies, set[0], b) - center;
    const Vec3 speed = (bodies.velocity[b] - drift) - velocity;
    const Mat3 axes = bodies.orientation[b].toRotationMatrix();
    SecondMoments term;
    term.angular_momentum = m * arm.cross(speed) + bodies.spin[b];
    term.inertia = axes * bodies.inertia[b].asDiagonal() * axes.transpose() +
                   m * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    return term;
  });
  return {first.mass, place(bodies, set[0]) + center, drift + velocity, second.angular_momentum,
          second.inertia};
}

PrincipalAxes principal_axes(const Mat3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(0.5 * (inertia + inertia.transpose()));
  PrincipalAxes result{solver.eigenvalues().cwiseMax(0.0), solver.eigenvectors()};
  if (result.axes.determinant() < 0.0) result.axes.col(1) = -result.axes.col(1);
  return result;
}

Vec3 rotation_rate(const SpinState& state) {
  const PrincipalAxes principal = principal_axes(state.inertia);
  Vec3 rate = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (principal.moments[k] <= 1e-14 * principal.moments[2]) continue;
    const Vec3 axis = principal.axes.col(k);
    rate += axis.dot(state.angular_momentum) / principal.moments[k] * axis;
  }
  return rate;
}

double spin_period(const SpinState& state, const Vec3& axis) {
  const Vec3 e = axis.normalized();
  const double momentum = e.dot(state.angular_momentum);
  if (momentum == 0.0) return std::numeric_limits<double>::infinity();
  return 2.0 * kPi * e.dot(state.inertia * e) / momentum;
}

double wobble(const SpinState& state) {
  const PrincipalAxes principal = principal_axes(state.inertia);
  Vec3 along = Vec3::Zero();  // L projected on the axes of largest inertia
  for (int k = 0; k < 3; ++k) {
    if (principal.moments[k] < (1.0 - 1e-10) * principal.moments[2]) continue;
    const Vec3 axis = principal.axes.col(k);
    along += axis.dot(state.angular_momentum) * axis;
  }
  return arc_tangent((state.angular_momentum - along).norm(), along.norm());
}

}  // namespace cairn
