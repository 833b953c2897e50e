// The bodies of a scene and the spheres that make them up, as structures of arrays.
#pragma once

#include <vector>

#include "core/math.h"
#include "shape/shape.h"

namespace cairn {

/// With more spheres than these, what can be built again is not kept between its uses: memory is dearer than
/// quick allocations.
inline constexpr std::size_t kManySpheres = 200000;

/// Spheres; sphere i belongs to exactly one body. The spheres of a body are contiguous.
struct Spheres {
  std::vector<double> radius;  ///< m
  std::vector<double> mass;    ///< kg, what gravity pulls; sums to the body's mass
  std::vector<Vec3> offset;    ///< m, from the body's centre of mass, in the body's principal frame
  std::vector<std::uint32_t> body;
  std::vector<Vec3> position;  ///< m, from the centre of the body's cell; derived from the bodies by
                               ///< place_spheres

  std::size_t size() const { return radius.size(); }
};

/// Rigid bodies; a loose sphere is a body of one sphere. Momenta are carried, velocities derived.
struct Bodies {
  // Constant.
  std::vector<double> mass;          ///< kg
  std::vector<double> volume;        ///< m^3
  std::vector<Vec3> inertia;         ///< kg m^2, principal moments
  std::vector<std::uint32_t> shape;  ///< index into the scene's shapes
  std::vector<double> length;        ///< m, the size that scales the shape
  std::vector<std::uint16_t> material;
  std::vector<std::uint32_t> first_sphere;  ///< size() + 1 entries
  std::vector<std::uint16_t> held;      ///< 0: free; k: moves as the k-th prescribed motion; empty: all free
  std::vector<std::uint16_t> wall_set;  ///< 0: all walls touch it; k: those of the k-th set; empty: all 0
  // Pose and momentum.
  std::vector<Vec3> position;     ///< m, centre of mass, from the centre of its cell
  std::vector<Vec3> remainder;    ///< m, what the drifts have rounded off `position`, for the next one
  std::vector<Vec3> velocity;     ///< m/s
  std::vector<Quat> orientation;  ///< principal frame -> space frame
  std::vector<Vec3> spin;         ///< kg m^2/s, angular momentum about the centre of mass, space frame
  // Places far from each other (see cells.h).
  double cell_edge = 0.0;  ///< m, of the cubic cells; 0: no lattice
  std::vector<Vec3> cell;  ///< whole numbers, of each body; empty while all are in cell 0
  // Wrench of the last evaluation, about the centre of mass.
  std::vector<Vec3> force;   ///< N
  std::vector<Vec3> torque;  ///< N m

  Spheres spheres;

  std::size_t size() const { return mass.size(); }
  std::size_t sphere_count(std::size_t b) const { return first_sphere[b + 1] - first_sphere[b]; }
};

/// Whether b moves as prescribed, whatever acts on it.
inline bool is_held(const Bodies& bodies, std::size_t b) {
  return !bodies.held.empty() && bodies.held[b] != 0;
}

/// Where a new body is put.
struct Placement {
  Vec3 position = Vec3::Zero();          ///< m, centre of mass, from `origin`
  Quat orientation = Quat::Identity();   ///< frame of the shape file -> space frame
  Vec3 velocity = Vec3::Zero();          ///< m/s
  Vec3 angular_velocity = Vec3::Zero();  ///< rad/s, space frame
  Vec3 origin = Vec3::Zero();            ///< m; what is far in a place, so that `position` keeps its digits
};

/// Appends one body of the given shape, size (m) and density (kg/m^3).
void add_body(Bodies& bodies, const RigidShape& shape, std::uint32_t shape_index, double size, double density,
              std::uint16_t material, const Placement& placement);

/// Whether b is a sphere whose attitude changes nothing; one sphere can also stand for a mesh.
inline bool is_ball(const Bodies& bodies, std::size_t b) {
  return bodies.sphere_count(b) == 1 && bodies.inertia[b].x() == bodies.inertia[b].z();
}

/// Angular velocity of body b (rad/s, space frame): R I^-1 R^T L.
inline Vec3 angular_velocity(const Bodies& bodies, std::size_t b) {
  const Quat& q = bodies.orientation[b];
  return q * (q.conjugate() * bodies.spin[b]).cwiseQuotient(bodies.inertia[b]);
}

/// Inverse inertia tensor of body b in the space frame (kg^-1 m^-2).
Mat3 inverse_inertia(const Bodies& bodies, std::size_t b);

/// Bodies per block of the loops over all of them. Functions on bodies [begin, end) are for such a block:
/// what follows each other does so while the block is in the cache.
inline constexpr std::size_t kBodyBlock = 128;

/// Sphere centres from the bodies' poses.
void place_spheres(Bodies& bodies, std::size_t begin, std::size_t end);
void place_spheres(Bodies& bodies);

}  // namespace cairn
