// How often a run does something.
#pragma once

namespace cairn {

struct Interval {
  enum class Unit { automatic, steps, seconds };
  Unit unit = Unit::automatic;
  double value = 0.0;  ///< time steps or seconds
};

}  // namespace cairn
