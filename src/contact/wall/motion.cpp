#include "contact/wall/motion.h"

#include <cmath>

namespace cairn {

bool WallMotion::moves() const {
  return velocity != Vec3::Zero() || amplitude != Vec3::Zero() || spin != Vec3::Zero();
}

WallPose WallMotion::pose(double now) const {
  const double time = now - since;
  const double omega = 2.0 * kPi * frequency, angle = omega * time + phase;
  WallPose pose;
  pose.shift = time * velocity + std::sin(angle) * amplitude;
  pose.velocity = velocity + omega * std::cos(angle) * amplitude;
  pose.center = center;
  pose.spin = spin;
  pose.turned = spin != Vec3::Zero();
  if (pose.turned) {
    const double rate = spin.norm();
    pose.turn = Eigen::AngleAxisd(rate * time, spin / rate).toRotationMatrix();
  }
  return pose;
}

WallPose WallMotion::mid_step(double end, double dt) const {
  const double swing = kPi * frequency * dt, angle = 0.5 * dt * spin.norm();
  WallPose pose = this->pose(end - 0.5 * dt);
  const Vec3 way = (end - 0.5 * dt - since) * velocity;
  pose.shift = way + std::cos(swing) * (pose.shift - way);  // mean of the two ends
  if (swing > 0.0) pose.velocity = velocity + std::sin(swing) / swing * (pose.velocity - velocity);
  if (angle > 0.0) pose.spin *= std::tan(angle) / angle;
  return pose;
}

double WallMotion::greatest_speed(double reach) const {
  return velocity.norm() + 2.0 * kPi * frequency * amplitude.norm() + spin.norm() * reach;
}

}  // namespace cairn
