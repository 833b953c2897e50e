#include "contact/wall/motion.h"

#include <cmath>

#include "core/elementary.h"

namespace cairn {

bool WallMotion::moves() const {
  return velocity != Vec3::Zero() || amplitude != Vec3::Zero() || spin != Vec3::Zero();
}

WallPose WallMotion::pose(double now) const {
  const double time = now - since;
  const double omega = 2.0 * kPi * frequency, angle = omega * time + phase;
  WallPose pose;
  const auto [sine, cosine] = sine_and_cosine(angle);
  pose.shift = time * velocity + sine * amplitude;
  pose.velocity = velocity + omega * cosine * amplitude;
  pose.center = center;
  pose.spin = spin;
  pose.turned = spin != Vec3::Zero();
  if (pose.turned) {
    const double rate = spin.norm();
    pose.turn = rotation(rate * time, spin / rate).toRotationMatrix();
  }
  return pose;
}

WallPose WallMotion::mid_step(double end, double dt) const {
  const double swing = kPi * frequency * dt, angle = 0.5 * dt * spin.norm();
  WallPose pose = this->pose(end - 0.5 * dt);
  const Vec3 way = (end - 0.5 * dt - since) * velocity;
  const auto [sine, cosine] = sine_and_cosine(swing);
  pose.shift = way + cosine * (pose.shift - way);  // mean of the two ends
  if (swing > 0.0) pose.velocity = velocity + sine / swing * (pose.velocity - velocity);
  if (angle > 0.0) {
    const SineAndCosine half = sine_and_cosine(angle);
    pose.spin *= half.sine / (half.cosine * angle);
  }
  return pose;
}

double WallMotion::greatest_speed(double reach) const {
  return velocity.norm() + 2.0 * kPi * frequency * amplitude.norm() + spin.norm() * reach;
}

}  // namespace cairn
