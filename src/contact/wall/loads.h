// What bodies do to walls: measured, of no effect on anything.
#pragma once

#include <vector>

#include "core/math.h"

namespace cairn {

/// Force and torque on one wall, and what contacts that began or ended within the step have given besides.
struct WallLoad {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();       ///< N, N m
  Vec3 kick = Vec3::Zero(), angular_kick = Vec3::Zero();  ///< N s, N m s

  WallLoad& operator+=(const WallLoad& other) {
    force += other.force;
    torque += other.torque;
    kick += other.kick;
    angular_kick += other.angular_kick;
    return *this;
  }
};

/// The same of all walls of a scene, by their numbers there. Torques are about the walls' rotation points.
struct WallLoads {
  std::vector<Vec3> force, torque;             ///< N, N m: of the last evaluation
  std::vector<Vec3> impulse, angular_impulse;  ///< N s, N m s: given since `since`
  double since = 0.0;                          ///< s

  void resize(std::size_t walls) {
    for (auto* column : {&force, &torque, &impulse, &angular_impulse}) column->resize(walls, Vec3::Zero());
  }
  /// After a step of dt (s) that ends with this load: a wrench acts for half a step on either side of its
  /// evaluation.
  void add(std::size_t wall, const WallLoad& now, double dt) {
    impulse[wall] += 0.5 * dt * (force[wall] + now.force) + now.kick;
    angular_impulse[wall] += 0.5 * dt * (torque[wall] + now.torque) + now.angular_kick;
    force[wall] = now.force;
    torque[wall] = now.torque;
  }
  /// Begins to sum anew.
  void restart(double time) {
    for (auto* column : {&impulse, &angular_impulse}) column->assign(column->size(), Vec3::Zero());
    since = time;
  }
};

}  // namespace cairn
