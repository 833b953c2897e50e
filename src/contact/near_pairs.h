// Pairs of near spheres, whatever cells or images of a periodic box they are in.
#pragma once

#include <span>
#include <vector>

#include "contact/box.h"
#include "contact/search.h"

namespace cairn {

/// Keeps its scratch memory, as NeighbourSearch does.
class NearPairs {
 public:
  /// All pairs of spheres of different bodies, not both held, whose centres are closer than the sum of their
  /// `reach` (m, at least the radius), sorted by (i, j). Sphere centres must be up to date.
  /// @throws UnstableError for a position that is not finite, InputError for an unusable reach and for a box
  /// so small that a sphere could see another one in two images (an edge up to 4 times the longest reach).
  void find(const Bodies& bodies, const Box& box, std::span<const double> reach, std::vector<Pair>& pairs);
  /// All whose surfaces are closer than `gap` (m, >= 0).
  void find(const Bodies& bodies, const Box& box, double gap, std::vector<Pair>& pairs);

 private:
  void find_across_cells(const Bodies& bodies, std::span<const double> reach, std::vector<Pair>& pairs);
  /// Body of each sphere; held ones are all the same.
  const std::vector<std::uint32_t>& groups(const Bodies& bodies);
  void find_in_box(const Bodies& bodies, const Box& box, std::span<const double> reach,
                   std::vector<Pair>& pairs);

  NeighbourSearch search_;
  // Spheres in plain coordinates, and after them their images near the box.
  std::vector<Vec3> positions_;
  std::vector<double> reach_;
  std::vector<std::uint32_t> body_, original_;
  std::vector<std::uint32_t> groups_;
};

/// Centre of sphere s from the zero of the scene's frame (m), rounded where that is far.
inline Vec3 sphere_place(const Bodies& bodies, std::size_t s) {
  if (bodies.cell.empty()) return bodies.spheres.position[s];
  return bodies.spheres.position[s] + bodies.cell_edge * bodies.cell[bodies.spheres.body[s]];
}

}  // namespace cairn
