// Which spheres may touch which walls before they have moved much.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "contact/wall/filter.h"

namespace cairn {

/// Lists with a skin, by block of bodies: a block renews its list when one of its spheres has moved, relative
/// to a wall, farther than the list allows. A sphere far from all walls may move as far as they are. Smooth
/// walls that move are not listed: asking them is as cheap as watching them.
class WallCandidates {
 public:
  static constexpr std::size_t kBlock = 64;  ///< bodies

  /// A sphere and a wall, or a triangle of it.
  struct Entry {
    std::uint32_t sphere, wall, triangle;
  };

  /// Makes room; lists of other sizes are thrown away.
  void resize(const Bodies& bodies);
  /// The list of a block at the walls' present poses, in the order of sphere, wall, triangle. Blocks may be
  /// asked for at once.
  const std::vector<Entry>& list(std::size_t block, const Bodies& bodies, const std::vector<Wall>& walls,
                                 const std::vector<WallPose>& poses, const WallFilter& filter);

  /// Lists renewed so far.
  std::size_t renewals() const;

 private:
  struct Block {
    std::vector<Entry> entries;
    std::vector<WallPose> poses;  // then; empty: no list yet
    std::size_t renewals = 0;
  };

  bool expired(const Block& block, std::size_t begin, std::size_t end, const Bodies& bodies,
               const std::vector<Wall>& walls, const std::vector<WallPose>& poses) const;
  void renew(Block& block, std::size_t begin, std::size_t end, const Bodies& bodies,
             const std::vector<Wall>& walls, const std::vector<WallPose>& poses, const WallFilter& filter);

  std::vector<Block> blocks_;
  std::vector<Vec3> reference_;  // sphere centres at the renewal
  std::vector<double> reach_;    // m, how far a sphere may move
};

}  // namespace cairn
