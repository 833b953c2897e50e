// Walls that a load moves along an axis.
#pragma once

#include <vector>

#include "core/math.h"

namespace cairn {

/// A wall of mass m that moves along the unit vector e under a load F and what bodies do to it:
/// m s'' = F + f.e - c s', beside its prescribed motion.
struct WallDrive {
  Vec3 axis = Vec3::UnitZ();
  double load = 0.0;     ///< N, along the axis
  double mass = 1.0;     ///< kg
  double damping = 0.0;  ///< kg/s
};

/// Where driven walls are: leapfrog, as bodies. By the walls' numbers in the scene; others rest.
struct DrivenWalls {
  std::vector<double> place, speed;  ///< m, m/s, along the axis

  void resize(std::size_t walls) {
    place.resize(walls, 0.0);
    speed.resize(walls, 0.0);
  }
  /// Half a kick (s), under the force (N) of the bodies along the axis, and the drift of the step.
  void begin_step(std::size_t wall, const WallDrive& drive, double force, double dt) {
    speed[wall] += 0.5 * dt / drive.mass * (drive.load + force - drive.damping * speed[wall]);
    place[wall] += dt * speed[wall];
  }
  /// The other half, with an impulse (N s) besides; drag is that of the end, so that both halves together are
  /// of second order.
  void end_step(std::size_t wall, const WallDrive& drive, double force, double kick, double dt) {
    const double half = 0.5 * dt / drive.mass;
    speed[wall] =
        (speed[wall] + half * (drive.load + force) + kick / drive.mass) / (1.0 + half * drive.damping);
  }
};

}  // namespace cairn
