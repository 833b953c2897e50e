#include "shape/gravity_masses.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace cairn {
namespace {

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;

constexpr double kBalanced = 1e-9;  // first moment that counts as zero, of the farthest offset
constexpr double kFloor = 1e-3;     // smallest mass, as a share of its weight

// A sum with what rounding takes from it [Knuth, The Art of Computer Programming 2, 4.2.2]: thousands of
// equal terms, as regular shapes have, would else leave more of a residual than a balanced shape may have.
template <class T>
class ExactSum {
 public:
  explicit ExactSum(const T& first) : sum_(first), lost_(first - first) {}
  void add(const T& term) {
    const T sum = sum_ + term, shared = sum - sum_;
    lost_ += (sum_ - (sum - shared)) + (term - shared);
    sum_ = sum;
  }
  T value() const { return sum_ + lost_; }

 private:
  T sum_, lost_;
};

// The problem in coordinates in which sum w_i a_i a_i^T = 1: a_i is 1 and the offset along the principal
// directions of the weighted cloud, in units of its spread there. A direction without spread (lines, planes,
// single spheres) has a_i = 0 and so no condition. At the minimum m_i = w_i max(floor, lambda . a_i), where
// the multipliers lambda maximise a concave, piecewise quadratic dual.
class MassProblem {
 public:
  MassProblem(const std::vector<Vec3>& offsets, const std::vector<double>& weights) : weights_(weights) {
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < offsets.size(); ++i) mean += weights[i] * offsets[i];
    Mat3 spread = Mat3::Zero();
    for (std::size_t i = 0; i < offsets.size(); ++i)
      spread += weights[i] * (offsets[i] - mean) * (offsets[i] - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(spread);

    // The spread along each direction anew: an eigenvalue that should vanish is only known to round-off of
    // the largest one, and would turn a plane into a very thin slab.
    constexpr double flat = 1e-13;  // relative spread that is round-off
    Vec3 width = Vec3::Zero();
    for (std::size_t i = 0; i < offsets.size(); ++i)
      width += weights[i] * (principal.eigenvectors().transpose() * (offsets[i] - mean)).cwiseAbs2();
    width = width.cwiseSqrt();
    Mat3 whiten = Mat3::Zero();
    for (Eigen::Index k = 0; k < 3; ++k)
      if (width[k] > flat * width[2]) whiten.row(k) = principal.eigenvectors().col(k).transpose() / width[k];
    for (const Vec3& offset : offsets) a_.push_back(with_one(whiten * (offset - mean)));
    target_ = with_one(-whiten * mean);
  }

  double share(std::size_t i, const Vec4& lambda) const { return std::max(kFloor, lambda.dot(a_[i])); }

  // How far the masses are from sum 1 and zero first moment; the gradient of the dual.
  Vec4 rest(const Vec4& lambda) const {
    ExactSum<Vec4> sum(target_);
    for (std::size_t i = 0; i < a_.size(); ++i) sum.add(-weights_[i] * share(i, lambda) * a_[i]);
    return sum.value();
  }

  double dual(const Vec4& lambda) const {
    ExactSum<double> sum(target_.dot(lambda));
    for (std::size_t i = 0; i < a_.size(); ++i) {
      const double s = share(i, lambda);
      sum.add(-weights_[i] * s * (lambda.dot(a_[i]) - 0.5 * s));
    }
    return sum.value();
  }

  Mat4 curvature(const Vec4& lambda) const {
    Mat4 sum = Mat4::Zero();
    for (std::size_t i = 0; i < a_.size(); ++i)
      if (lambda.dot(a_[i]) > kFloor) sum += weights_[i] * a_[i] * a_[i].transpose();
    return sum;
  }

 private:
  static Vec4 with_one(const Vec3& v) { return {1.0, v.x(), v.y(), v.z()}; }

  const std::vector<double>& weights_;
  std::vector<Vec4> a_;
  Vec4 target_;
};

}  // namespace

std::vector<double> gravity_masses(const std::vector<Vec3>& offsets, const std::vector<double>& weights) {
  const MassProblem problem(offsets, weights);
  Vec4 lambda = Vec4::UnitX();
  Vec4 rest = problem.rest(lambda);
  constexpr int most_steps = 100;
  constexpr double exact = 1e-16, feasible = 1e-13;
  // Newton's method on the dual: one step where no mass meets the floor, a few where some do.
  for (int step = 0; step < most_steps && rest.norm() > exact; ++step) {
    Mat4 curvature = problem.curvature(lambda);
    curvature.diagonal().array() += 1e-12;  // too few free masses: a long step, which the line search cuts
    const Vec4 direction = curvature.ldlt().solve(rest);
    const double start = problem.dual(lambda), slope = rest.dot(direction);
    constexpr double shortest = 1e-14, noise = 1e-15;
    double length = 1.0;
    while (length > shortest &&
           problem.dual(lambda + length * direction) < start + 0.1 * length * slope - noise)
      length *= 0.5;
    const Vec4 next = lambda + length * direction;
    const Vec4 next_rest = problem.rest(next);
    if (rest.norm() < feasible && next_rest.norm() >= rest.norm()) break;  // only round-off is left
    lambda = next;
    rest = next_rest;
  }
  if (!(rest.norm() < feasible)) return {};
  std::vector<double> masses;
  Vec3 first = Vec3::Zero();
  double farthest = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    masses.push_back(weights[i] * problem.share(i, lambda));
    first += masses[i] * offsets[i];
    farthest = std::max(farthest, offsets[i].norm());
  }
  // A direction without spread cannot be balanced if the centre of mass lies off it.
  if (first.norm() > kBalanced * farthest) return {};
  return masses;
}

}  // namespace cairn
