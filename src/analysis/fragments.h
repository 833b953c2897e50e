// Fragments: clusters of bodies that touch or nearly touch (friends of friends).
#pragma once

#include <limits>
#include <vector>

#include "body/bodies.h"
#include "contact/box.h"
#include "contact/history.h"

namespace cairn {

/// Clusters in order of decreasing mass, ties by the smallest body; cluster 0 is the largest remnant.
struct Fragments {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> label;  ///< cluster of every body; kNone of a held one
  std::vector<double> mass;          ///< kg, of every cluster
  std::vector<std::uint32_t> count;  ///< bodies in every cluster

  std::size_t size() const { return mass.size(); }
  /// Bodies of one cluster, ascending.
  std::vector<std::uint32_t> members(std::uint32_t cluster) const;
};

/// Links bodies that are not held, any of whose spheres' surfaces are closer than gap (m, >= 0), in a box
/// also of their images. Sphere centres must be up to date. What touches by `contacts` need not be looked
/// for: the result is the same, and for a pile in one piece far quicker.
/// @throws UnstableError for a position that is not finite, InputError for an unusable gap.
Fragments find_fragments(const Bodies& bodies, double gap, const Box& box = {},
                         const ContactList* contacts = nullptr);

}  // namespace cairn
