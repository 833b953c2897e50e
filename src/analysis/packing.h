// How densely the interior of a pile is packed, from Voronoi cells [Rycroft 2009, Chaos 19, 041111].
#pragma once

#include <span>

#include "body/bodies.h"

namespace cairn {

/// Local packing fractions: a body's volume over that of the cells of all its spheres, so that what
/// overlapping spheres share counts once.
struct Packing {
  std::size_t bodies = 0;      ///< counted: mass centre in the interior, and cells made
  double total = 0.0;          ///< their volumes together over that of their plain cells
  double total_radical = 0.0;  ///< the same with radical cells
  double mean = 0.0;           ///< of the bodies' fractions, plain cells
  double mean_radical = 0.0;   ///< the same with radical cells
};

/// Packing of the bodies of `set` with their mass centre closer than `radius` (m) to that of the set. Cells
/// are bounded by the box around the set, a largest radius wider on each side. All fractions are NaN when
/// none is so close. Sphere centres must be up to date.
Packing interior_packing(const Bodies& bodies, std::span<const std::uint32_t> set, double radius);

}  // namespace cairn
