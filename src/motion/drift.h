// Kick and drift of rigid bodies: second-order leapfrog; the attitude by a symmetric splitting of the free
// top [Dullweber, Leimkuhler & McLachlan 1997, J. Chem. Phys. 107, 5840]. The angular momentum in space is
// carried and is exact in free flight.
#pragma once

#include <span>
#include <vector>

#include "body/bodies.h"

namespace cairn {

/// Velocity and angular momentum of bodies [begin, end) advance by dt (s) under the wrenches held in them.
void kick(Bodies& bodies, double dt, std::size_t begin, std::size_t end);
void kick(Bodies& bodies, double dt);

/// Positions and attitudes of bodies [begin, end) advance by dt (s) at constant momenta. `spin_mid`, of these
/// bodies, receives the angular velocity of mid-step (rad/s) in the sense of the midpoint rule: a point of
/// the body goes exactly from x0 to x1, seen from the mass centre, with (x1 - x0) / dt = spin_mid x (x0 + x1)
/// / 2. Its length is tan(angle / 2) over dt / 2. So a rigid motion of two bodies is one for their contact
/// too, however long it lasts. Returns whether one has left its cell: then all are to be settled in theirs.
[[nodiscard]] bool drift(Bodies& bodies, double dt, std::size_t begin, std::size_t end,
                         std::span<Vec3> spin_mid);
/// All bodies, settled in their cells.
void drift(Bodies& bodies, double dt, std::vector<Vec3>& spin_mid);

/// Affine motion of a box that grows by the factors `stretch`: centres of bodies [begin, end) go with it,
/// velocities, which are relative to the affine flow, shrink by the same factors (x' = v + E x, v' = F/m - E
/// v; a gas that is compressed heats up as by moving walls).
void deform(Bodies& bodies, const Vec3& stretch, std::size_t begin, std::size_t end);

/// Attitude of a free top with principal moments `inertia` after dt: rotations about axes 1, 2, 3, 2, 1.
Quat rotate_free_top(const Quat& attitude, const Vec3& angular_momentum, const Vec3& inertia, double dt);

}  // namespace cairn
