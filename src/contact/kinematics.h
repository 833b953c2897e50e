// How every sphere moves in the step: what the contact sweep reads, packed into two cache lines per sphere.
#pragma once

#include <span>
#include <vector>

#include "body/bodies.h"

namespace cairn {

/// Position at the end of the drift; velocity of the centre and spin in mid-step, and predicted for the end.
struct alignas(128) SphereMotion {
  double position[3];
  double radius;
  double velocity_mid[3];
  double spin_mid[3];  ///< angular velocity of the body, rad/s
  double velocity[3];
  double spin[3];  ///< angular velocity of the body, rad/s
};
static_assert(sizeof(SphereMotion) == 128);

/// Fills `motions` of the spheres of bodies [begin, end) after the drift: half-step velocities are in the
/// bodies, `spin_mid` holds the mean angular velocity of each of these bodies over the drift, and the last
/// wrench predicts the end of the step. In a box that grows at `rate` (1/s) the affine flow about the zero is
/// added to velocities. There is room in `motions`.
void compute_motions(const Bodies& bodies, std::span<const Vec3> spin_mid, double dt, const Vec3& rate,
                     std::size_t begin, std::size_t end, std::vector<SphereMotion>& motions);
/// Of all bodies; `motions` gets the size.
void compute_motions(const Bodies& bodies, std::span<const Vec3> spin_mid, double dt,
                     std::vector<SphereMotion>& motions, const Vec3& rate = Vec3::Zero());
/// Of all bodies, when nothing but their cells has changed.
void move_motions(const Spheres& spheres, std::vector<SphereMotion>& motions);

}  // namespace cairn
