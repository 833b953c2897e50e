// The methods behind fit_spheres: on a solid with its centroid at the origin and the volume of the unit ball.
#pragma once

#include <functional>

#include "shape/fit.h"
#include "shape/signed_distance.h"
#include "shape/surface_samples.h"

namespace cairn {

struct FitTarget {
  const SolidMesh& solid;
  const SignedDistance& distance;
  const MassProperties& mass;
};

/// The largest balls, up to a radius, that touch the surface from inside at the given samples: those of the
/// medial axis [shrinking balls: Ma, Bae & Choi 2012, The Visual Computer 28, 7].
Shape medial_balls(const FitTarget& target, const std::vector<SurfaceSample>& touching, double largest = 4.0);

/// Medial balls, each the one that adds most volume to those before [after Favier et al. 1999, Eng. Comput.
/// 16, 467, and Ferellec & McDowell 2010, Granul. Matter 12, 459; set cover in place of their random order].
Shape fit_greedy(const FitTarget& target, std::size_t count, std::uint64_t seed);

/// Least squares over all centres and radii at once of the distances from the mesh to the spheres and from
/// the exposed surface of the spheres to the mesh; spheres that bring least are moved to where they bring
/// most, with some chance in the choice [on the ground of Wang et al. 2006, The Visual Computer 22, 612, and
/// Bradshaw & O'Sullivan 2004, ACM Trans. Graph. 23, 1]. `moments`: the second moments of the sum of spheres
/// are a further term. Calls `tell` with the part that is done, to 1.
Shape fit_best(const FitTarget& target, std::size_t count, std::uint64_t seed, bool moments,
               const std::function<void(double)>& tell);

}  // namespace cairn
