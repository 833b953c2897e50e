// Which bodies a wall can touch.
#pragma once

#include "body/bodies.h"
#include "contact/wall/wall.h"

namespace cairn {

class WallFilter {
 public:
  /// `sets`: for each set of Bodies::wall_set, from 1, and each wall whether they touch.
  WallFilter(const Bodies& bodies, const std::vector<Wall>& walls,
             std::vector<std::vector<std::uint8_t>> sets)
      : bodies_(bodies), walls_(walls), sets_(std::move(sets)) {}

  /// Held bodies and prescribed walls have nothing to do with each other.
  bool touches(std::uint32_t wall, std::size_t body) const {
    if (!bodies_.wall_set.empty() && bodies_.wall_set[body] > 0 && !sets_[bodies_.wall_set[body] - 1u][wall])
      return false;
    return !is_held(bodies_, body) || walls_[wall].drive;
  }

 private:
  const Bodies& bodies_;
  const std::vector<Wall>& walls_;
  std::vector<std::vector<std::uint8_t>> sets_;
};

}  // namespace cairn
