// The least-squares problem of a fit: distances between the surfaces of a mesh and of balls.
#pragma once

#include <cmath>

#include "shape/fit_methods.h"

namespace cairn {

/// The cost of a set of balls is half the mean square distance of mesh samples from the nearest ball, plus
/// half that of the exposed surface of the balls from the mesh, plus squares of the weighted errors of
/// the centroid and, on request, the second moments of the sum of balls.
class FitSystem {
 public:
  /// For about `count` balls; `points`: how many on each side at least.
  FitSystem(const FitTarget& target, std::size_t count, std::size_t points, std::uint64_t seed);

  /// Points of equal area on the mesh.
  const std::vector<Vec3>& samples() const { return samples_; }

  /// From now on a relative error of the second moments by `tolerance` costs a third of `surface`.
  void weigh_moments(double surface, double tolerance) {
    moment_weight_ = std::sqrt(surface / 3.0) / tolerance;
  }

  /// Levenberg-Marquardt with at most `evaluations`; returns the cost.
  double improve(Shape& balls, int evaluations) const;

 private:
  using Vec4 = Eigen::Vector4d;
  using Mat4 = Eigen::Matrix4d;
  static constexpr int kMoments = 9;
  using Moments = Eigen::Matrix<double, kMoments, 1>;
  using MomentRows = Eigen::Matrix<double, kMoments, 4>;

  /// Cost, gradient, and the curvature of Gauss and Newton: blocks of each ball, and rows that couple them.
  struct Evaluation {
    double cost = 0.0;
    std::vector<Mat4> curvature;
    std::vector<Vec4> gradient;
    std::vector<MomentRows> rows;
    Moments rest;  // weighted errors of the moments
  };

  Evaluation evaluate(const Shape& balls) const;
  void add_mesh_side(const Shape& balls, Evaluation& e) const;
  void add_ball_side(const Shape& balls, Evaluation& e) const;
  void add_moments(const Shape& balls, Evaluation& e) const;
  static std::vector<Vec4> step(const Evaluation& e, double damping);

  const FitTarget target_;
  std::vector<Vec3> samples_;
  std::vector<Vec3> directions_;
  Mat3 second_;                 // moments of the solid per volume
  double moment_weight_ = 0.0;  // of relative errors of second moments
};

}  // namespace cairn
