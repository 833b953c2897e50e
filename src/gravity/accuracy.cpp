#include "gravity/accuracy.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "gravity/direct.h"

namespace cairn::gravity {

namespace {

constexpr std::size_t kSample = 500;
constexpr double kWidest = 0.95;  // opening angle that keeps the expansions convergent
constexpr int kTrials = 6;
constexpr double kFirst = 10.0;  // factor over the error of the first trial

/// Every so many-th point and the exact field there.
struct Sample {
  std::vector<std::size_t> points;
  std::vector<Vec3> acceleration;
};

Sample take_sample(const Points& all) {
  const std::size_t n = all.size(), stride = std::max<std::size_t>(1, n / kSample);
  Sample out;
  for (std::size_t i = stride / 2; i < n; i += stride) out.points.push_back(i);
  out.acceleration.resize(out.points.size());
  DirectSum().evaluate_at(out.points, all, out.acceleration);
  return out;
}

}  // namespace

double rms(std::span<const Vec3> acceleration) {
  if (acceleration.empty()) return 0.0;
  const double sum =
      parallel_sum(acceleration.size(), 0.0, [&](std::size_t i) { return acceleration[i].squaredNorm(); });
  return std::sqrt(sum / static_cast<double>(acceleration.size()));
}

FmmSettings settings_for(double error) {
  return {.theta = kWidest, .order = error > 1e-2 ? 4 : error > 3e-4 ? 5 : error > 3e-5 ? 6 : 7};
}

Accuracy choose_accuracy(const Points& points, double error) {
  check(points);
  const Sample sample = take_sample(points);
  Accuracy trial{settings_for(error), kFirst * error, rms(sample.acceleration), 0.0};
  Fmm method(trial.settings);
  std::vector<Vec3> acceleration(points.size());
  for (int k = 0;; ++k) {
    method.set_tolerance(trial.factor * trial.scale);
    method.evaluate(points, acceleration);
    std::vector<Vec3> difference;
    for (std::size_t s = 0; s < sample.points.size(); ++s)
      difference.push_back(acceleration[sample.points[s]] - sample.acceleration[s]);
    trial.error = trial.scale > 0.0 ? rms(difference) / trial.scale : 0.0;
    const bool good = trial.error <= error;
    if ((good && (trial.error > 0.4 * error || k > 1)) || k == kTrials) return trial;
    trial.factor *= std::clamp(0.7 * error / trial.error, 0.05, 5.0);
  }
}

}  // namespace cairn::gravity
