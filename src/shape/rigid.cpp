// From a shape to a rigid body: principal frame, offsets and gravity masses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "shape/gravity_masses.h"
#include "shape/own_mass.h"
#include "shape/principal_frame.h"
#include "shape/shape.h"

namespace cairn {
namespace {

void check(const Shape& shape) {
  if (shape.radii.empty() || shape.radii.size() != shape.centers.size())
    throw InputError("shape '{}': expected at least one sphere, each with a centre and a radius", shape.name);
  for (std::size_t i = 0; i < shape.radii.size(); ++i)
    if (!shape.centers[i].allFinite() || !(shape.radii[i] > 0.0) || !std::isfinite(shape.radii[i]))
      throw InputError("shape '{}': sphere {}: expected a finite centre and a positive radius", shape.name,
                       i);
  if (const auto complaint = check_own_mass(shape))
    throw InputError("shape '{}': {}: {}", shape.name, complaint->key, complaint->what);
}

// Relative Frobenius distance of the inertia of the gravity masses, each with its sphere's own 2/5 m r^2,
// from the body's.
double moment_error(const RigidShape& rigid) {
  Mat3 inertia = Mat3::Zero();
  for (std::size_t i = 0; i < rigid.offsets.size(); ++i)
    inertia += rigid.mass_fractions[i] * ball_inertia(rigid.offsets[i], rigid.radii[i]);
  const Mat3 exact = rigid.inertia.asDiagonal();
  return (inertia - exact).norm() / exact.norm();
}

/// What the shape says of it, or else that of a solid of even density.
MassSpread spread_of(const Shape& shape, const MassProperties& solid) {
  const OwnMass& own = shape.own;
  MassSpread spread{own.center.value_or(solid.centroid), solid.inertia / solid.volume};
  if (!own.of_spheres.empty()) spread = spread_of_spheres(shape);
  if (own.inertia) spread.inertia = *own.inertia;
  return spread;
}

}  // namespace

RigidShape make_rigid(const Shape& shape, MassModel model) {
  check(shape);
  if (model == MassModel::mesh && !shape.source) model = MassModel::union_volume;
  const MassProperties solid = model == MassModel::mesh      ? shape.source->mass
                               : model == MassModel::spheres ? sum_of_spheres(shape)
                                                             : union_of_spheres(shape);
  const MassSpread mass = spread_of(shape, solid);
  const PrincipalFrame frame = principal_frame(mass.inertia);

  RigidShape rigid;
  rigid.name = shape.name;
  rigid.mass_model = model;
  rigid.volume = solid.volume;
  rigid.inertia = frame.moments;
  if (shape.radii.size() == 1 && model != MassModel::mesh && !shape.own.inertia)
    rigid.inertia.setConstant(frame.moments.mean());
  rigid.axes = Quat(frame.axes).normalized();
  rigid.center = mass.center;
  rigid.radii = shape.radii;
  const Quat to_principal = rigid.axes.conjugate();
  std::vector<double> weights = shape.own.of_spheres;
  for (std::size_t i = 0; i < shape.centers.size(); ++i) {
    const double r = shape.radii[i];
    rigid.offsets.push_back(to_principal * (shape.centers[i] - mass.center));
    rigid.bounding_radius = std::max(rigid.bounding_radius, rigid.offsets.back().norm() + r);
    if (shape.own.of_spheres.empty()) weights.push_back(r * r * r);
  }
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= total;
  rigid.mass_fractions = shape.own.of_spheres.empty() ? gravity_masses(rigid.offsets, weights) : weights;
  if (rigid.mass_fractions.empty())
    throw InputError(
        "shape '{}': no positive masses at the sphere centres balance about the centre of mass, which must "
        "lie inside the hull of the centres",
        shape.name);
  rigid.moment_error = moment_error(rigid);
  return rigid;
}

}  // namespace cairn
