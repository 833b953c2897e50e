#include "shape/fit_error.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "shape/principal_frame.h"
#include "shape/surface_samples.h"
#include "shape/union_surface.h"

namespace cairn {
namespace {

constexpr std::size_t kSamples = 20000;  // on either surface
constexpr std::size_t kMostVertices = 100000;
constexpr std::size_t kStride = 4;  // of the points that bound a distance from above

struct Distances {
  double squares = 0.0, greatest = 0.0;
  Distances& operator+=(const Distances& other) {
    squares += other.squares;
    greatest = std::max(greatest, other.greatest);
    return *this;
  }
};

}  // namespace

double inertia_error(const MassProperties& got, const MassProperties& wanted) {
  const Vec3 a = principal_frame(got.inertia / got.volume).moments;
  const Vec3 b = principal_frame(wanted.inertia / wanted.volume).moments;
  return ((a - b).cwiseQuotient(b)).cwiseAbs().maxCoeff();
}

FitError measure_fit(const Shape& spheres, const SolidMesh& solid, const SignedDistance& distance,
                     const MassProperties& mass) {
  const UnionSurface surface(spheres);
  const std::vector<UnionPoint> points = surface.sample(2 * kSamples);
  const auto from_spheres = parallel_sum(points.size(), Distances{}, [&](std::size_t p) {
    const double d = distance(points[p].point).distance;
    return Distances{d * d, std::abs(d)};
  });
  const auto from = [&](const Vec3& x) {
    double near = HUGE_VAL;
    for (std::size_t p = 0; p < points.size(); p += kStride)
      near = std::min(near, (points[p].point - x).squaredNorm());
    const double d = surface.distance(x, std::sqrt(near));
    return Distances{d * d, std::abs(d)};
  };
  const std::vector<SurfaceSample> samples = sample_surface(solid.surface, kSamples, 0);
  const auto from_mesh =
      parallel_sum(samples.size(), Distances{}, [&](std::size_t s) { return from(samples[s].point); });
  const auto& vertices = solid.surface.vertices;
  const auto from_vertices = parallel_sum(std::min(vertices.size(), kMostVertices), Distances{},
                                          [&](std::size_t v) { return from(vertices[v]); });

  FitError error;
  error.rms_from_mesh = std::sqrt(from_mesh.squares / static_cast<double>(samples.size()));
  error.rms_from_spheres = std::sqrt(from_spheres.squares / static_cast<double>(points.size()));
  error.rms = std::sqrt(
      0.5 * (error.rms_from_mesh * error.rms_from_mesh + error.rms_from_spheres * error.rms_from_spheres));
  error.greatest_from_mesh = std::max(from_mesh.greatest, from_vertices.greatest);
  error.greatest_from_spheres = from_spheres.greatest;
  const MassProperties covered = union_of_spheres(spheres);
  error.volume = covered.volume / mass.volume - 1.0;
  error.centroid = (covered.centroid - mass.centroid).norm();
  error.inertia = inertia_error(covered, mass);
  error.inertia_of_spheres = inertia_error(sum_of_spheres(spheres), mass);
  return error;
}

}  // namespace cairn
