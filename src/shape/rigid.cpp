// From a shape to a rigid body: principal frame, offsets and gravity masses.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "shape/gravity_masses.h"
#include "shape/shape.h"

namespace cairn {
namespace {

struct PrincipalFrame {
  Vec3 moments;  // ascending
  Mat3 axes;     // columns, right-handed
};

// The index of the largest component; the first of equals.
Eigen::Index dominant(const Vec3& axis) {
  constexpr double tie = 1e-9;
  Eigen::Index index = 0;
  for (Eigen::Index i = 1; i < 3; ++i)
    if (std::abs(axis[i]) > std::abs(axis[index]) + tie) index = i;
  return index;
}

// Two principal axes of equal moment are free to turn about the third: the one after it (cyclically) takes
// the file axis that comes after the third's own.
void turn_pair_to_file_axes(Mat3& axes, Eigen::Index third) {
  const Vec3 normal = axes.col(third);
  const Vec3 file_axis = Vec3::Unit((dominant(normal) + 1) % 3);
  axes.col((third + 1) % 3) = (file_axis - file_axis.dot(normal) * normal).normalized();
  axes.col((third + 2) % 3) = normal.cross(axes.col((third + 1) % 3));
}

// Axes are free up to signs: the right-handed choice that turns least from the file's axes.
void choose_signs(Mat3& axes) {
  for (Eigen::Index i = 0; i < 3; ++i)
    if (axes(dominant(axes.col(i)), i) < 0.0) axes.col(i) *= -1.0;
  const double last = axes.determinant() > 0.0 ? 1.0 : -1.0;
  const Mat3 positive = axes;
  constexpr double tie = 1e-9;
  double best = -4.0;
  for (const auto& [first, second] : {std::pair{1.0, 1.0}, {1.0, -1.0}, {-1.0, 1.0}, {-1.0, -1.0}}) {
    const Mat3 candidate = positive * Vec3(first, second, last * first * second).asDiagonal();
    if (candidate.trace() <= best + tie) continue;
    best = candidate.trace();
    axes = candidate;
  }
}

PrincipalFrame principal_frame(const Mat3& inertia) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
  PrincipalFrame frame{solver.eigenvalues(), solver.eigenvectors()};
  Vec3& moments = frame.moments;
  constexpr double same =
      1e-11;  // moments closer than this are equal: above quadrature round-off, below design
  const bool low_pair = moments[1] - moments[0] < same * moments[2];
  const bool high_pair = moments[2] - moments[1] < same * moments[2];
  if (low_pair && high_pair) {
    moments.setConstant(moments.mean());
    frame.axes.setIdentity();
    return frame;
  }
  if (low_pair || high_pair) {
    const Eigen::Index third = low_pair ? 2 : 0;
    Vec3 normal = frame.axes.col(third);
    if (normal[dominant(normal)] < 0.0) normal = -normal;
    frame.axes.col(third) = normal;
    turn_pair_to_file_axes(frame.axes, third);
    const double mean = 0.5 * (moments[(third + 1) % 3] + moments[(third + 2) % 3]);
    moments[(third + 1) % 3] = moments[(third + 2) % 3] = mean;
  }
  choose_signs(frame.axes);
  return frame;
}

void check(const Shape& shape) {
  if (shape.radii.empty() || shape.radii.size() != shape.centers.size())
    throw InputError("shape '{}': expected at least one sphere, each with a centre and a radius", shape.name);
  for (std::size_t i = 0; i < shape.radii.size(); ++i)
    if (!shape.centers[i].allFinite() || !(shape.radii[i] > 0.0) || !std::isfinite(shape.radii[i]))
      throw InputError("shape '{}': sphere {}: expected a finite centre and a positive radius", shape.name,
                       i);
}

// Relative Frobenius distance of the inertia of the gravity masses, each with its sphere's own 2/5 m r^2,
// from the body's.
double moment_error(const RigidShape& rigid) {
  Mat3 inertia = Mat3::Zero();
  for (std::size_t i = 0; i < rigid.offsets.size(); ++i) {
    const Vec3& d = rigid.offsets[i];
    const double own = 0.4 * rigid.radii[i] * rigid.radii[i];
    inertia += rigid.mass_fractions[i] * ((d.squaredNorm() + own) * Mat3::Identity() - d * d.transpose());
  }
  const Mat3 exact = rigid.inertia.asDiagonal();
  return (inertia - exact).norm() / exact.norm();
}

}  // namespace

RigidShape make_rigid(const Shape& shape, MassModel model) {
  check(shape);
  const MassProperties mass = model == MassModel::spheres ? sum_of_spheres(shape) : union_of_spheres(shape);
  const PrincipalFrame frame = principal_frame(mass.inertia / mass.volume);

  RigidShape rigid;
  rigid.name = shape.name;
  rigid.mass_model = model;
  rigid.volume = mass.volume;
  rigid.inertia = frame.moments;
  rigid.axes = Quat(frame.axes).normalized();
  rigid.center = mass.centroid;
  rigid.radii = shape.radii;
  const Quat to_principal = rigid.axes.conjugate();
  std::vector<double> weights;
  for (std::size_t i = 0; i < shape.centers.size(); ++i) {
    const double r = shape.radii[i];
    rigid.offsets.push_back(to_principal * (shape.centers[i] - mass.centroid));
    rigid.bounding_radius = std::max(rigid.bounding_radius, rigid.offsets.back().norm() + r);
    weights.push_back(r * r * r);
  }
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= total;
  rigid.mass_fractions = gravity_masses(rigid.offsets, weights);
  if (rigid.mass_fractions.empty())
    throw InputError(
        "shape '{}': no positive masses at the sphere centres balance about the centre of mass, which must "
        "lie inside the hull of the centres",
        shape.name);
  rigid.moment_error = moment_error(rigid);
  return rigid;
}

}  // namespace cairn
