#include "shape/fit.h"

#include <algorithm>
#include <cmath>

#include "core/elementary.h"
#include "core/error.h"
#include "shape/fit_error.h"
#include "shape/fit_methods.h"
#include "shape/gravity_masses.h"

namespace cairn {
namespace {

// Once there are enough spheres for the mesh's rough shape, the error falls no faster than their number grows
// (tests/FITS.md: as its power 0.5 to 0.9); a factor of two for luck.
constexpr std::size_t kTelling = 32;
constexpr double kLuck = 2.0;

/// A solid with its centroid at the origin and the volume of the unit ball.
struct Standard {
  SolidMesh solid;
  MassProperties mass;
  SignedDistance distance;

  static SolidMesh scaled(SolidMesh solid, const Vec3& origin, double size) {
    for (Vec3& x : solid.surface.vertices) x = (x - origin) / size;
    return solid;
  }
  Standard(const SolidMesh& given, const Vec3& origin, double size)
      : solid(scaled(given, origin, size)), mass(mass_of(solid.surface)), distance(solid) {}
};

/// Moves the balls as a whole so that their volumes balance about the origin.
void balance(Shape& balls) {
  const Vec3 off = sum_of_spheres(balls).centroid;
  for (Vec3& c : balls.centers) c -= off;
}

bool has_gravity_masses(const Shape& balls) {
  double total = 0.0;
  std::vector<double> weights;
  for (const double r : balls.radii) total += r * r * r;
  for (const double r : balls.radii) weights.push_back(r * r * r / total);
  return !gravity_masses(balls.centers, weights).empty();
}

/// `before`: tells how many spheres were tried last, and what they came to.
Shape fit(const Standard& standard, const FitOptions& options, std::size_t count,
          const FitProgress& before = {}) {
  const FitTarget target{standard.solid, standard.distance, standard.mass};
  const auto tell = [&](double done) {
    if (options.progress) options.progress({count, done, before.last, before.rms});
  };
  tell(0.0);
  Shape balls = options.strategy == FitStrategy::greedy
                    ? fit_greedy(target, count, options.seed)
                    : fit_best(target, count, options.seed, options.mass == MassModel::spheres, tell);
  if (options.strategy == FitStrategy::best || !has_gravity_masses(balls)) balance(balls);
  balls.source = SourceMesh{};
  balls.source->error = measure_fit(balls, standard.solid, standard.distance, standard.mass);
  return balls;
}

/// The fewest balls that meet the error, as far as a search by halves can tell.
Shape fewest(const Standard& standard, const FitOptions& options) {
  std::size_t low = 0, high = 1;
  Shape best;
  FitProgress before;
  const auto attempt = [&](std::size_t count) {
    Shape shape = fit(standard, options, count, before);
    before.last = count;
    before.rms = shape.source->error.rms;
    return shape;
  };
  for (;; low = high, high *= 2) {
    best = attempt(high);
    const double rms = best.source->error.rms;
    if (rms <= options.error) break;
    const double least = rms * static_cast<double>(high) / static_cast<double>(kMostFitSpheres) / kLuck;
    if (high >= kMostFitSpheres || (high >= kTelling && least > options.error))
      throw InputError("an RMS distance of {:g} is out of reach of {} spheres, the most: {} come to {:.3g}",
                       options.error, kMostFitSpheres, high, rms);
  }
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    Shape shape = attempt(middle);
    const bool met = shape.source->error.rms <= options.error;
    if (met) best = std::move(shape);
    (met ? high : low) = middle;
  }
  return best;
}

}  // namespace

Shape fit_spheres(const SolidMesh& solid, const FitOptions& options) {
  if (options.spheres > kMostFitSpheres || (options.spheres == 0 && !(options.error > 0.0)))
    throw InputError("expected a budget of 1 to {} spheres or a positive error", kMostFitSpheres);
  const MassProperties mass = mass_of(solid.surface);
  const double size = cube_root(mass.volume / (4.0 / 3.0 * kPi));
  const Standard standard(solid, mass.centroid, size);
  Shape shape = options.spheres > 0 ? fit(standard, options, options.spheres) : fewest(standard, options);
  shape.source->fit = FitRecord{options.strategy, options.mass, options.seed};
  shape.source->size = size;
  shape.source->origin = mass.centroid;
  shape.source->mass = {4.0 / 3.0 * kPi, Vec3::Zero(), mass.inertia / (cubed(size) * squared(size))};
  return shape;
}

}  // namespace cairn
