// How far spheres are from the mesh that they stand for.
#pragma once

#include "shape/signed_distance.h"

namespace cairn {

/// Measures spheres against a solid, in the same frame and units: 20 000 points on either surface, the
/// vertices of the mesh too for the greatest distance.
FitError measure_fit(const Shape& spheres, const SolidMesh& solid, const SignedDistance& distance,
                     const MassProperties& mass);

/// Greatest relative error of a principal moment per volume.
double inertia_error(const MassProperties& got, const MassProperties& wanted);

}  // namespace cairn
