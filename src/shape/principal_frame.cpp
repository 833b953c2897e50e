#include "shape/principal_frame.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace cairn {
namespace {

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

}  // namespace

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

}  // namespace cairn
