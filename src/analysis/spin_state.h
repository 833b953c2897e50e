// Mass, motion and rotation of a set of bodies taken as one object.
#pragma once

#include <span>
#include <vector>

#include "body/bodies.h"

namespace cairn {

/// Principal moments I_a <= I_b <= I_c (kg m^2) and their axes, right-handed columns a, b, c in the space
/// frame.
struct PrincipalAxes {
  Vec3 moments = Vec3::Zero();
  Mat3 axes = Mat3::Identity();
};

/// Totals of a set of bodies, in the space frame.
struct SpinState {
  double mass = 0.0;                     ///< kg
  Vec3 center = Vec3::Zero();            ///< m, centre of mass, from the zero of the scene's frame
  Vec3 velocity = Vec3::Zero();          ///< m/s, of the centre of mass
  Vec3 angular_momentum = Vec3::Zero();  ///< kg m^2/s, about the centre of mass: orbital and spins
  Mat3 inertia = Mat3::Zero();           ///< kg m^2, about the centre of mass
};

/// Every body's index, as the set of all.
std::vector<std::uint32_t> all_bodies(const Bodies& bodies);

/// Totals of the given bodies. @throws InputError for an empty set.
SpinState spin_state(const Bodies& bodies, std::span<const std::uint32_t> set);

/// Eigenvalues and eigenvectors of an inertia tensor.
PrincipalAxes principal_axes(const Mat3& inertia);

/// Rotation rate I^-1 L (rad/s) of the rigid body with the set's momentum. Directions without inertia
/// (relative moment below 1e-14) do not rotate.
Vec3 rotation_rate(const SpinState& state);

/// Spin period T = 2 pi I_ee / L_e about the space axis e (s); negative when it turns the other way, infinite
/// when it does not turn.
double spin_period(const SpinState& state, const Vec3& axis);

/// Angle between the axis of largest inertia and L (rad, 0 to pi/2); 0 for L = 0. Where several moments are
/// largest (to 1e-10) the axis of their space nearest to L counts.
double wobble(const SpinState& state);

}  // namespace cairn
