// Bodies of one kind on a regular lattice.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "io/scene.h"
#include "pile/region.h"

namespace cairn {

/// Sites of a lattice with nearest neighbours `spacing` (m) apart, from the region's position and turned as
/// it is, that are in the region; ordered so that neighbours are close. One site is at the region's position.
std::vector<Vec3> lattice_sites(LatticeKind kind, double spacing, const Region& region);

/// Adds the lattice's bodies to `bodies`, all of the shape with number `shape_index`.
/// @throws InputError when no site, or more sites than bodies can be counted, are in the region.
void add_lattice(const LatticeSpec& lattice, const Region& region, const RigidShape& shape,
                 std::uint32_t shape_index, std::uint16_t material, std::uint64_t seed, std::uint64_t stream,
                 Bodies& bodies);

}  // namespace cairn
