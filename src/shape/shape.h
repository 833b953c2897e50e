// A glued-sphere shape: spheres in a rigid arrangement, in units of a reference radius.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/math.h"

namespace cairn {

/// Whose mass a body has: every sphere's own, overlaps counted as often as they are covered; the volume
/// covered by at least one sphere; or the solid that the spheres stand for (that of `union_volume` for shapes
/// that stand for themselves).
enum class MassModel { spheres, union_volume, mesh };

/// `greedy`: the largest gain of volume first, of balls that lie inside the mesh and touch it twice or more.
/// `best`: balls that may reach out, placed by least squares of the distances between both surfaces.
enum class FitStrategy { greedy, best };

/// Volume, centroid and inertia of a solid of unit density.
struct MassProperties {
  double volume = 0.0;
  Vec3 centroid = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();  ///< about the centroid
};

/// How well spheres stand for a mesh. Distances in reference radii; those between surfaces from samples.
struct FitError {
  double rms = 0.0;               ///< of both directions together
  double rms_from_mesh = 0.0;     ///< from points of the mesh to the surface of the spheres' union
  double rms_from_spheres = 0.0;  ///< from points of that surface to the mesh
  double greatest_from_mesh = 0.0;
  double greatest_from_spheres = 0.0;
  double volume = 0.0;              ///< of the union, relative error
  double centroid = 0.0;            ///< of the union, distance
  double inertia = 0.0;             ///< greatest relative error of a principal moment per mass, union
  double inertia_of_spheres = 0.0;  ///< the same of the sum of spheres
};

/// What else it takes, with the mesh and the number of spheres, to fit the same spheres again.
struct FitRecord {
  FitStrategy strategy = FitStrategy::best;
  MassModel mass = MassModel::mesh;
  std::uint64_t seed = 1;
};

/// The mesh that a shape's spheres stand for.
struct SourceMesh {
  std::string file;            ///< as the shape file names it, relative to itself
  double unit = 1.0;           ///< m, of the file
  double size = 1.0;           ///< m, the reference radius at which the shape is as large as the mesh
  Vec3 origin = Vec3::Zero();  ///< m, of the shape's frame in the mesh's
  MassProperties mass;         ///< in reference radii
  FitError error;
  std::optional<FitRecord> fit = {};  ///< absent from files of other origin
};

/// What a shape file itself says of the mass of a body; what it leaves out follows from the mass model.
struct OwnMass {
  std::vector<double> of_spheres =
      {};                            ///< relative to each other, each spread evenly over its sphere; or empty
  std::optional<Vec3> center = {};   ///< of mass, in reference radii; with `of_spheres` theirs
  std::optional<Mat3> inertia = {};  ///< about the centre of mass, per mass, in reference radii^2
};

/// Spheres as the shape file gives them. Lengths in units of the reference radius ("size" of a body, m).
struct Shape {
  std::string name;
  std::string description;
  std::vector<Vec3> centers;
  std::vector<double> radii;
  std::optional<SourceMesh> source = {};
  OwnMass own = {};
};

/// Sum over spheres; overlaps count as often as they are covered.
MassProperties sum_of_spheres(const Shape& shape);

/// The volume covered by at least one sphere, exact to quadrature round-off (about 1e-12).
MassProperties union_of_spheres(const Shape& shape);

/// A shape ready to become bodies: in its principal frame, origin at the centre of mass, unit size.
struct RigidShape {
  std::string name;
  MassModel mass_model = MassModel::union_volume;
  double volume = 0.0;           ///< in size^3
  Vec3 inertia = Vec3::Zero();   ///< principal moments per mass, I1 <= I2 <= I3, in size^2
  Quat axes = Quat::Identity();  ///< principal frame -> frame of the shape file
  Vec3 center = Vec3::Zero();    ///< centre of mass in the frame of the shape file
  std::vector<Vec3> offsets;     ///< sphere centres, principal frame, origin at the centre of mass
  std::vector<double> radii;
  /// Gravity masses: sum 1, first moment 0; the shape's own, or nearest to proportional to r^3, none below a
  /// thousandth of that.
  std::vector<double> mass_fractions;
  double moment_error = 0.0;     ///< relative mismatch of the point masses' second moments and the inertia
  double bounding_radius = 0.0;  ///< about the centre of mass
};

/// Part of the greatest principal moment by which it may pass the sum of the two others, a lamina's: numbers
/// are rounded.
inline constexpr double kLaminaRounding = 1e-6;

/// What is wrong with a shape's own mass, and the key of a shape file that says it.
struct MassComplaint {
  std::string key, what;
};

/// Whether a body can have the shape's own mass: positive masses of all spheres or of none, a centre that is
/// theirs, principal moments above 0 (1e-9 of the greatest) of which none passes the sum of the two others.
std::optional<MassComplaint> check_own_mass(const Shape& shape);

/// Principal frame, inertia and gravity masses of a shape.
/// @throws InputError when there is no sphere, a number is not finite, no positive gravity masses balance, or
/// what the shape says of its own mass is that of no body.
RigidShape make_rigid(const Shape& shape, MassModel model);

}  // namespace cairn
