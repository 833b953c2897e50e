#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/elementary.h"
#include "core/parallel.h"
#include "core/random.h"
#include "shape/fit_error.h"
#include "shape/fit_methods.h"
#include "shape/fit_system.h"

namespace cairn {
namespace {

constexpr std::size_t kFewest = 200, kOfEach = 30, kMost = 1500;  // medial balls, for each that is wanted
constexpr std::size_t kRoughPoints = 1500, kFinePoints = 4000;    // on either side, at least
constexpr std::size_t kGlance = 3000;                             // samples for a first look at a candidate
constexpr std::uint64_t kRounds = 25;
constexpr std::size_t kTrials = 4;                           // of a round, the best of which counts
constexpr int kFirst = 40, kOnTheWay = 12, kLast = 60;       // evaluations
constexpr double kNoise = 1.0;                               // in the logarithm of gains and losses
constexpr double kShallow = 0.35;                            // largest radius at first when moments count
constexpr double kMoments = 0.015;                           // relative error of the inertia that will do
constexpr double kMomentsOnTheWay = 0.08, kTightest = 1e-3;  // relative errors of moments that count

/// The mesh's samples and which of the present balls is nearest to each.
class Gaps {
 public:
  Gaps(const std::vector<Vec3>& samples, const Shape& balls)
      : samples_(samples),
        first_(samples.size(), kFar),
        second_(samples.size(), kFar),
        owner_(samples.size(), 0) {
    for (std::size_t b = 0; b < balls.radii.size(); ++b) add(balls.centers[b], balls.radii[b]);
  }

  void add(const Vec3& center, double radius) {
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const double d = (samples_[s] - center).norm() - radius;
      if (d < first_[s]) {
        second_[s] = first_[s];
        first_[s] = d;
        owner_[s] = balls_;
      } else if (d < second_[s]) {
        second_[s] = d;
      }
    }
    ++balls_;
  }

  /// How much the sum of squares would fall with this ball, over every `stride`th sample.
  double gain(const Vec3& center, double radius, std::size_t stride = 1) const {
    double sum = 0.0;
    for (std::size_t s = 0; s < samples_.size(); s += stride) {
      const double d = (samples_[s] - center).norm() - radius;
      if (d < first_[s]) sum += first_[s] * first_[s] - d * d;
    }
    return sum;
  }

  /// How much the sum of squares would rise without each ball.
  std::vector<double> losses() const {
    std::vector<double> loss(balls_, 0.0);
    for (std::size_t s = 0; s < samples_.size(); ++s)
      loss[owner_[s]] += second_[s] * second_[s] - first_[s] * first_[s];
    return loss;
  }

 private:
  static constexpr double kFar = 1.0;
  const std::vector<Vec3>& samples_;
  std::vector<double> first_, second_;
  std::vector<std::size_t> owner_;
  std::size_t balls_ = 0;
};

/// Adds to `balls` the candidates of greatest gain, one after the other.
void insert(Shape& balls, std::size_t count, const Shape& candidates, const std::vector<Vec3>& samples,
            double noise, Random& random) {
  Gaps gaps(samples, balls);
  std::vector<std::pair<double, std::size_t>> order(candidates.radii.size());
  std::vector<double> taste;  // of each candidate
  for (std::size_t c = 0; c < order.size(); ++c)
    taste.push_back(exponential(noise * random.uniform(-1.0, 1.0)));
  const std::size_t stride = 1 + samples.size() / kGlance;
  parallel_blocks(order.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      order[c] = {-taste[c] * gaps.gain(candidates.centers[c], candidates.radii[c], stride), c};
  });
  std::sort(order.begin(), order.end());
  constexpr std::size_t looked_at = 48;  // of the head of the list, whose gains are counted anew
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t head = std::min(looked_at, order.size());
    parallel_blocks(head, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        order[k].first = -taste[order[k].second] *
                         gaps.gain(candidates.centers[order[k].second], candidates.radii[order[k].second]);
    });
    std::sort(order.begin(), order.end());
    const std::size_t c = order.front().second;
    balls.centers.push_back(candidates.centers[c]);
    balls.radii.push_back(candidates.radii[c]);
    gaps.add(candidates.centers[c], candidates.radii[c]);
    order.front().first = std::numeric_limits<double>::max();
    std::rotate(order.begin(), order.begin() + 1, order.end());
  }
}

void remove_least(Shape& balls, std::size_t count, const std::vector<Vec3>& samples, double noise,
                  Random& random) {
  std::vector<double> loss = Gaps(samples, balls).losses();
  for (double& l : loss) l *= exponential(noise * random.uniform(-1.0, 1.0));
  std::vector<std::size_t> order(loss.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return loss[a] < loss[b]; });
  std::vector<char> gone(loss.size(), 0);
  for (std::size_t n = 0; n < count; ++n) gone[order[n]] = 1;
  Shape left;
  for (std::size_t b = 0; b < loss.size(); ++b)
    if (!gone[b]) {
      left.centers.push_back(balls.centers[b]);
      left.radii.push_back(balls.radii[b]);
    }
  balls = std::move(left);
}

}  // namespace

Shape fit_best(const FitTarget& target, std::size_t count, std::uint64_t seed, bool moments,
               const std::function<void(double)>& tell) {
  const std::vector<SurfaceSample> touching =
      sample_surface(target.solid.surface, std::clamp(kOfEach * count, kFewest, kMost), seed);
  // Large balls overlap in the core, which makes it too heavy in a sum of spheres.
  const Shape medial = moments ? medial_balls(target, touching, kShallow) : medial_balls(target, touching);
  // Balls of the medial axis, and the same reaching out of the surface.
  const auto candidates = [&](double reach) {
    Shape all = medial;
    all.centers.insert(all.centers.end(), medial.centers.begin(), medial.centers.end());
    for (const double r : medial.radii) all.radii.push_back(r + reach);
    return all;
  };
  FitSystem rough(target, count, kRoughPoints, seed);
  Random random(seed, 3);
  Shape balls;
  insert(balls, count, candidates(0.3 / std::sqrt(static_cast<double>(count))), rough.samples(), 0.0, random);
  double cost = rough.improve(balls, kFirst);
  if (moments) {
    rough.weigh_moments(cost, kMomentsOnTheWay);
    cost = rough.improve(balls, kFirst);
  }
  double share = 0.2;  // of the balls that move in a round
  for (std::uint64_t round = 0; round < kRounds && count > 1; ++round) {
    tell(static_cast<double>(round) / static_cast<double>(kRounds));
    std::array<Shape, kTrials> trials;
    std::array<double, kTrials> costs;
    const Shape all = candidates(std::sqrt(cost));
    parallel_blocks(kTrials, 1, [&](std::size_t k, std::size_t) {
      Random dice(seed, 4 + round * kTrials + k);
      const double part = share * dice.uniform() * static_cast<double>(count);
      const auto moved = static_cast<std::size_t>(std::max(1.0, part));
      trials[k] = balls;
      remove_least(trials[k], moved, rough.samples(), kNoise, dice);
      insert(trials[k], moved, all, rough.samples(), kNoise, dice);
      costs[k] = rough.improve(trials[k], kOnTheWay);
    });
    const auto best = static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
    const bool better = costs[best] < cost;
    share = better ? std::min(0.3, 1.2 * share) : 0.85 * share;
    if (!better) continue;
    balls = std::move(trials[best]);
    cost = costs[best];
  }
  FitSystem fine(target, count, kFinePoints, seed);
  if (!moments) {
    fine.improve(balls, kLast);
    return balls;
  }
  for (double tolerance = kMomentsOnTheWay; tolerance > kTightest; tolerance *= 0.5) {
    fine.weigh_moments(cost, tolerance);
    cost = fine.improve(balls, kLast);
    if (inertia_error(sum_of_spheres(balls), target.mass) < kMoments) break;
  }
  return balls;
}

}  // namespace cairn
