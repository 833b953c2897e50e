#include "app/render/view.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace cairn::render {
namespace {

bool usable(const Ball& ball) {
  return ball.center.allFinite() && std::isfinite(ball.radius) && ball.radius > 0.0;
}

/// Median of one coordinate of the centres, weighted with the balls' volumes.
double weighted_median(const std::vector<Ball>& balls, const std::vector<double>& weight, int axis) {
  std::vector<std::size_t> order(balls.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return balls[a].center[axis] < balls[b].center[axis]; });
  const double half = 0.5 * std::accumulate(weight.begin(), weight.end(), 0.0);
  double sum = 0.0;
  for (const std::size_t i : order) {
    sum += weight[i];
    if (sum >= half) return balls[i].center[axis];
  }
  return balls[order.back()].center[axis];
}

/// The balls nearest to the median that make up the given fraction of the volume.
std::vector<Ball> nearest_fraction(const std::vector<Ball>& balls, double fraction) {
  double largest = 0.0;
  for (const Ball& ball : balls) largest = std::max(largest, ball.radius);
  std::vector<double> weight(balls.size());
  std::transform(balls.begin(), balls.end(), weight.begin(),
                 [&](const Ball& ball) { return std::pow(ball.radius / largest, 3); });
  const Vec3 middle(weighted_median(balls, weight, 0), weighted_median(balls, weight, 1),
                    weighted_median(balls, weight, 2));
  std::vector<std::size_t> order(balls.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (balls[a].center - middle).squaredNorm() < (balls[b].center - middle).squaredNorm();
  });
  const double wanted = fraction * std::accumulate(weight.begin(), weight.end(), 0.0);
  std::vector<Ball> kept;
  double sum = 0.0;
  for (const std::size_t i : order) {
    if (sum >= wanted) break;
    kept.push_back(balls[i]);
    sum += weight[i];
  }
  return kept;
}

}  // namespace

Mat3 camera_frame(const View& view) {
  const auto positive = [](double length) { return std::isfinite(length) && length > 0.0; };
  if (!positive(view.width) || !positive(view.height) || !view.target.allFinite())
    throw InputError("the view needs a finite target and a positive width and height, not {} m x {} m",
                     view.width, view.height);
  if (!(view.field_of_view >= 0.0 && view.field_of_view < 120.0))
    throw InputError("the field of view must be in 0..120 degrees, not {}", view.field_of_view);
  const auto direction = [](const Vec3& v) { return v.allFinite() && v.norm() > 0.0; };
  if (!direction(view.direction) || !direction(view.up) || !direction(view.sun))
    throw InputError("the view's direction, up and sun must be finite vectors other than zero");
  const Vec3 nearer = view.direction.normalized();
  Vec3 right = view.up.normalized().cross(nearer);
  // Looking along `up`: any other axis serves.
  if (right.norm() < 1e-6) right = nearer.unitOrthogonal();
  right.normalize();
  Mat3 rows;
  rows << right.transpose(), nearer.cross(right).transpose(), nearer.transpose();
  return rows;
}

View frame(const std::vector<Ball>& balls, const View& like, const Framing& framing) {
  std::vector<Ball> kept;
  std::copy_if(balls.begin(), balls.end(), std::back_inserter(kept), usable);
  if (kept.empty()) throw InputError("there is nothing to draw: no ball has a finite place and size");
  if (framing.fraction < 1.0) kept = nearest_fraction(kept, framing.fraction);
  View view = like;
  view.width = view.height = 1.0;
  view.target.setZero();
  const Mat3 camera = camera_frame(view);
  Vec3 low = Vec3::Constant(HUGE_VAL), high = Vec3::Constant(-HUGE_VAL);
  for (const Ball& ball : kept) {
    const Vec3 place = camera * ball.center;
    low = low.cwiseMin((place.array() - ball.radius).matrix());
    high = high.cwiseMax((place.array() + ball.radius).matrix());
  }
  view.target = camera.transpose() * (0.5 * (low + high));
  const Vec3 size = (1.0 + 2.0 * framing.margin) * (high - low);
  view.width = size.x();
  view.height = size.y();
  return view;
}

void require_finite(const std::vector<Ball>& balls) {
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Ball& ball = balls[i];
    if (!usable(ball) || !ball.color.allFinite())
      throw InputError("ball {} cannot be drawn: centre ({}, {}, {}) m, radius {} m", i, ball.center.x(),
                       ball.center.y(), ball.center.z(), ball.radius);
  }
}

}  // namespace cairn::render
