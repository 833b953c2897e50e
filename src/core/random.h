// Counter-based random numbers: Philox4x32-10 [Salmon et al. 2011, SC11, "Parallel random numbers: as easy as
// 1, 2, 3"]. A number depends on (seed, stream, index) alone, so results do not depend on threads or order.
#pragma once

#include <array>
#include <cstdint>

#include "core/math.h"

namespace cairn {

class Random {
 public:
  /// Independent sequences for different (seed, stream) pairs.
  Random(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}

  std::uint64_t bits();  ///< 64 random bits
  double uniform();      ///< uniform in [0, 1)
  double uniform(double low, double high);
  Vec3 direction();  ///< uniform on the unit sphere
  Vec3 in_ball();    ///< uniform in the unit ball
  Quat rotation();   ///< uniform over rotations [Shoemake 1992]

 private:
  std::uint64_t seed_, stream_, counter_ = 0;
};

/// One Philox4x32-10 block.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

}  // namespace cairn
