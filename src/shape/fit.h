// Spheres that stand for a mesh.
#pragma once

#include <functional>

#include "shape/solid_mesh.h"

namespace cairn {

/// How far a fit is.
struct FitProgress {
  std::size_t spheres = 0;  ///< tried now
  double done = 0.0;        ///< part of that trial, to 1
  std::size_t last = 0;     ///< spheres tried before; 0: none
  double rms = 0.0;         ///< that those came to, see FitError
};

struct FitOptions {
  std::size_t spheres = 0;  ///< budget; 0: the fewest found that meet `error`
  double error = 0.0;       ///< RMS distance of the surfaces, in radii of the ball of the mesh's volume
  std::uint64_t seed = 1;
  FitStrategy strategy = FitStrategy::best;
  /// What the bodies will take their mass from. `spheres`: the moments of the sum of spheres are fitted too,
  /// at the price of worse surfaces; a shape with `mesh` or `union_volume` does not need it.
  MassModel mass = MassModel::mesh;
  std::function<void(const FitProgress&)> progress = {};  ///< called now and then
};

inline constexpr std::size_t kMostFitSpheres = 1024;

/// Fits spheres to a solid. The shape's frame has the solid's directions and its centroid as the origin; its
/// reference radius is that of the ball of equal volume. The spheres' volumes balance about the centroid
/// exactly, so that gravity masses exist. The same bits for any number of threads.
/// @throws InputError when `error` is not met by kMostFitSpheres, which is told from fewer where they are far
/// off, or the budget is not in 1..kMostFitSpheres.
Shape fit_spheres(const SolidMesh& solid, const FitOptions& options);

}  // namespace cairn
