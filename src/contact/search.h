// Neighbour search: pairs of spheres of different bodies whose surfaces are close.
#pragma once

#include <compare>
#include <memory>
#include <span>
#include <vector>

#include "core/math.h"

namespace cairn {

/// Two spheres, i < j.
struct Pair {
  std::uint32_t i, j;
  auto operator<=>(const Pair&) const = default;  // by i, then j
};

/// Whether the vector (x, y, z) is shorter than limit (m, limit >= 0), decided on the squares in double
/// precision.
inline bool closer_than(double x, double y, double z, double limit) {
  return x * x + y * y + z * z < limit * limit;
}

/// Search on a hierarchy of grids [Ogarko & Luding 2012, Comput. Phys. Commun. 183, 931]: spheres are sorted
/// into levels by size in powers of four, each level has cells as wide as its largest sphere, and a sphere
/// looks into its own level and all coarser ones. Neither time nor memory depends on the extents. The object
/// keeps its scratch memory, so that repeated searches of one scene allocate next to nothing.
class NeighbourSearch {
 public:
  NeighbourSearch();
  ~NeighbourSearch();
  NeighbourSearch(NeighbourSearch&&) noexcept;
  NeighbourSearch& operator=(NeighbourSearch&&) noexcept;

  /// All pairs with |xi - xj| < (ri + rj) + gap and body[i] != body[j], sorted by (i, j); lengths in m, gap
  /// >= 0. The verdict on each pair is that of `closer_than`; the result does not depend on the number of
  /// threads.
  /// @throws UnstableError for a position that is not finite, InputError for an unusable radius or gap.
  void find(std::span<const Vec3> positions, std::span<const double> radii,
            std::span<const std::uint32_t> body, double gap, std::vector<Pair>& pairs);

 private:
  struct Grids;
  std::unique_ptr<Grids> grids_;
};

}  // namespace cairn
