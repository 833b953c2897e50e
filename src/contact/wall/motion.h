// Prescribed motion of a wall: its pose is an exact function of time.
#pragma once

#include "core/math.h"

namespace cairn {

/// Where a wall is and how it moves at one moment. The wall frame is space while the wall is not displaced.
struct WallPose {
  Vec3 shift = Vec3::Zero();  ///< m, of the rotation point
  Mat3 turn = Mat3::Identity();
  bool turned = false;           ///< turn is not the identity
  Vec3 center = Vec3::Zero();    ///< m, rotation point in the wall frame
  Vec3 velocity = Vec3::Zero();  ///< m/s, of the rotation point
  Vec3 spin = Vec3::Zero();      ///< rad/s

  /// The wall-frame coordinates of a point of space.
  Vec3 to_wall(const Vec3& x) const {
    const Vec3 y = x - shift;
    return turned ? Vec3(center + turn.transpose() * (y - center)) : y;
  }
  /// A point of the wall frame in space.
  Vec3 to_space_point(const Vec3& y) const {
    return turned ? Vec3(shift + center + turn * (y - center)) : Vec3(y + shift);
  }
  /// The rotation point in space.
  Vec3 pivot() const { return shift + center; }
  /// A direction of the wall frame in space.
  Vec3 to_space(const Vec3& n) const { return turned ? Vec3(turn * n) : n; }
  /// Velocity (m/s) of the wall's material point at x.
  Vec3 velocity_at(const Vec3& x) const { return velocity + spin.cross(x - shift - center); }
};

/// Translation at constant velocity, sinusoidal oscillation about the place given, and rotation about a point
/// that takes part in both.
struct WallMotion {
  Vec3 velocity = Vec3::Zero();   ///< m/s
  Vec3 amplitude = Vec3::Zero();  ///< m, displacement amplitude sin(2 pi frequency t + phase)
  double frequency = 0.0;         ///< Hz
  double phase = 0.0;             ///< rad
  Vec3 spin = Vec3::Zero();       ///< rad/s
  Vec3 center = Vec3::Zero();     ///< m, a point of the axis of rotation at time 0
  double since = 0.0;             ///< s, time from which it moves so

  bool moves() const;
  WallPose pose(double now) const;
  /// The middle of a step of `dt` that ends at `end`, with the velocity and spin, (2 / dt) tan(angle / 2),
  /// that carry every point of the wall from its place before the step to that after it.
  WallPose mid_step(double end, double dt) const;
  /// Greatest speed (m/s) of a point that keeps the distance `reach` (m) from the rotation point.
  double greatest_speed(double reach) const;
};

}  // namespace cairn
