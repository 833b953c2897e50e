#include "shape/fit_system.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math.h"
#include "core/parallel.h"
#include "core/random.h"

namespace cairn {
namespace {

constexpr double kCentroidWeight = 30.0;

constexpr double kIdle = 1e-3;  // relative gain of an evaluation that is not worth it

/// The balls as arrays.
struct Columns {
  std::vector<double> x, y, z, r;
  explicit Columns(const Shape& balls) {
    for (const Vec3& c : balls.centers) {
      x.push_back(c.x());
      y.push_back(c.y());
      z.push_back(c.z());
    }
    r = balls.radii;
  }
};

}  // namespace

FitSystem::FitSystem(const FitTarget& target, std::size_t count, std::size_t points, std::uint64_t seed)
    : target_(target) {
  constexpr std::size_t samples_of_ball = 48, directions_of_ball = 64;
  for (const SurfaceSample& s :
       sample_surface(target.solid.surface, std::max(points, samples_of_ball * count), seed + 1))
    samples_.push_back(s.point);
  directions_ = spiral_directions(std::max(2 * points / count, directions_of_ball));
  const Quat turn = Random(seed, 2).rotation();
  for (Vec3& u : directions_) u = turn * u;
  const Mat3& inertia = target.mass.inertia;
  second_ = (0.5 * inertia.trace() * Mat3::Identity() - inertia) / target.mass.volume;
}

void FitSystem::add_mesh_side(const Shape& balls, Evaluation& e) const {
  const Columns columns(balls);
  const std::size_t count = balls.radii.size();
  std::vector<std::uint32_t> owner(samples_.size());
  std::vector<double> gap(samples_.size());
  parallel_blocks(samples_.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<double> d(count);
    for (std::size_t s = begin; s < end; ++s) {
      const double px = samples_[s].x(), py = samples_[s].y(), pz = samples_[s].z();
      for (std::size_t b = 0; b < count; ++b) {
        const double x = px - columns.x[b], y = py - columns.y[b], z = pz - columns.z[b];
        d[b] = std::sqrt(x * x + y * y + z * z) - columns.r[b];
      }
      const auto least = std::min_element(d.begin(), d.end());
      owner[s] = static_cast<std::uint32_t>(least - d.begin());
      gap[s] = *least;
    }
  });
  const double weight = 0.5 / static_cast<double>(samples_.size());
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    const std::size_t b = owner[s];
    const Vec3 arm = samples_[s] - balls.centers[b];
    Vec4 slope;
    slope << -arm / std::max(arm.norm(), 1e-300), -1.0;
    e.cost += weight * gap[s] * gap[s];
    e.gradient[b] += weight * gap[s] * slope;
    e.curvature[b] += weight * slope * slope.transpose();
  }
}

void FitSystem::add_ball_side(const Shape& balls, Evaluation& e) const {
  const std::size_t count = balls.radii.size();
  struct Side {
    double squares = 0.0, area = 0.0;
    Vec4 gradient = Vec4::Zero();
    Mat4 curvature = Mat4::Zero();
  };
  std::vector<Side> sides(count);
  parallel_blocks(count, 1, [&](std::size_t b, std::size_t) {
    const Vec3& center = balls.centers[b];
    const double radius = balls.radii[b], area = radius * radius;
    std::vector<std::pair<double, std::uint32_t>> near;  // those that cover most come first
    for (std::uint32_t k = 0; k < count; ++k)
      if (const double gap = (balls.centers[k] - center).norm() - balls.radii[k]; k != b && gap < radius)
        near.push_back({gap, k});
    std::sort(near.begin(), near.end());
    Side& side = sides[b];
    for (const Vec3& u : directions_) {
      const Vec3 x = center + radius * u;
      const bool covered = std::any_of(near.begin(), near.end(), [&](const auto& other) {
        const std::uint32_t k = other.second;
        return (x - balls.centers[k]).squaredNorm() < balls.radii[k] * balls.radii[k];
      });
      if (covered) continue;
      const SignedDistance::Answer answer = target_.distance(x);
      Vec4 slope;
      slope << answer.normal, answer.normal.dot(u);
      side.squares += area * answer.distance * answer.distance;
      side.area += area;
      side.gradient += area * answer.distance * slope;
      side.curvature += area * slope * slope.transpose();
    }
  });
  double total = 0.0;
  for (const Side& side : sides) total += side.area;
  for (std::size_t b = 0; b < count; ++b) {
    e.cost += 0.5 * sides[b].squares / total;
    e.gradient[b] += 0.5 / total * sides[b].gradient;
    e.curvature[b] += 0.5 / total * sides[b].curvature;
  }
}

void FitSystem::add_moments(const Shape& balls, Evaluation& e) const {
  // Moments per volume: centroid, then xx, yy, zz, xy, xz, yz.
  const std::size_t count = balls.radii.size();
  const auto terms = [](const Vec3& c, double r) {
    Moments m;
    const double own = r * r / 5.0;
    m << c, c.x() * c.x() + own, c.y() * c.y() + own, c.z() * c.z() + own, c.x() * c.y(), c.x() * c.z(),
        c.y() * c.z();
    return m;
  };
  double volume = 0.0;
  Moments mean = Moments::Zero();
  for (std::size_t b = 0; b < count; ++b) {
    const double v = cubed(balls.radii[b]);
    volume += v;
    mean += v * terms(balls.centers[b], balls.radii[b]);
  }
  mean /= volume;
  Moments wanted, weight;
  wanted << 0.0, 0.0, 0.0, second_(0, 0), second_(1, 1), second_(2, 2), second_(0, 1), second_(0, 2),
      second_(1, 2);
  const double scale = moment_weight_ / (second_.trace() / 1.5);  // of the mean moment of inertia
  weight << Vec3::Constant(kCentroidWeight), Eigen::Matrix<double, 6, 1>::Constant(scale);
  e.rest = weight.cwiseProduct(mean - wanted);
  for (std::size_t b = 0; b < count; ++b) {
    const Vec3& c = balls.centers[b];
    const double r = balls.radii[b], share = r * r * r / volume;
    MomentRows rows = MomentRows::Zero();
    rows.topLeftCorner<3, 3>().setIdentity();
    for (int k = 0; k < 3; ++k) {
      rows(3 + k, k) = 2.0 * c[k];
      rows(3 + k, 3) = 0.4 * r;
    }
    rows(6, 0) = c.y(), rows(6, 1) = c.x();
    rows(7, 0) = c.z(), rows(7, 2) = c.x();
    rows(8, 1) = c.z(), rows(8, 2) = c.y();
    rows *= share;
    rows.col(3) += 3.0 * share / r * (terms(c, r) - mean);
    e.rows[b] = weight.asDiagonal() * rows;
    e.gradient[b] += e.rows[b].transpose() * e.rest;
  }
}

FitSystem::Evaluation FitSystem::evaluate(const Shape& balls) const {
  const std::size_t count = balls.radii.size();
  Evaluation e;
  e.curvature.assign(count, Mat4::Zero());
  e.gradient.assign(count, Vec4::Zero());
  e.rows.resize(count);
  add_mesh_side(balls, e);
  add_ball_side(balls, e);
  add_moments(balls, e);
  e.cost += e.rest.squaredNorm();
  return e;
}

// Blocks on the diagonal plus a few full rows: inverted by the formula of Sherman, Morrison and Woodbury.
std::vector<FitSystem::Vec4> FitSystem::step(const Evaluation& e, double damping) {
  const std::size_t count = e.gradient.size();
  double typical = 0.0;
  for (const Mat4& h : e.curvature) typical += h.trace() / (4.0 * static_cast<double>(count));
  std::vector<Eigen::LDLT<Mat4>> blocks;
  Eigen::Matrix<double, kMoments, kMoments> inner = Eigen::Matrix<double, kMoments, kMoments>::Identity();
  Moments right = Moments::Zero();
  for (std::size_t b = 0; b < count; ++b) {
    Mat4 h = e.curvature[b];
    h.diagonal() += damping * h.diagonal() + Vec4::Constant(1e-2 * typical);
    blocks.emplace_back(h);
    inner += e.rows[b] * blocks[b].solve(e.rows[b].transpose());
    right += e.rows[b] * blocks[b].solve(e.gradient[b]);
  }
  const Moments common = inner.ldlt().solve(right);
  std::vector<Vec4> steps;
  for (std::size_t b = 0; b < count; ++b)
    steps.push_back(-blocks[b].solve(e.gradient[b] - e.rows[b].transpose() * common));
  return steps;
}

double FitSystem::improve(Shape& balls, int evaluations) const {
  const std::size_t count = balls.radii.size();
  Evaluation now = evaluate(balls);
  double damping = 0.1;
  int idle = 0;
  for (int n = 1; n < evaluations; ++n) {
    const std::vector<Vec4> steps = step(now, damping);
    Shape trial = balls;
    for (std::size_t b = 0; b < count; ++b) {
      const double longest = 0.5 * balls.radii[b];
      const double size = steps[b].cwiseAbs().maxCoeff();
      const Vec4 move = size > longest ? Vec4(longest / size * steps[b]) : steps[b];
      trial.centers[b] += move.head<3>();
      trial.radii[b] += move[3];
    }
    Evaluation then = evaluate(trial);
    if (then.cost < now.cost) {
      idle = then.cost > (1.0 - kIdle) * now.cost ? idle + 1 : 0;
      balls = std::move(trial);
      now = std::move(then);
      if (idle == 3) break;
      damping = std::max(0.3 * damping, 1e-4);
    } else {
      damping *= 4.0;
      if (damping > 1e4) break;
    }
  }
  return now.cost;
}

}  // namespace cairn
