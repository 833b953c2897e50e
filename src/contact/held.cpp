#include "contact/held.h"

#include "contact/sweep.h"
#include "core/parallel.h"

namespace cairn {

namespace {

void set_velocities(const WallPose& pose, std::size_t b, Bodies& bodies) {
  const Quat& q = bodies.orientation[b];
  bodies.velocity[b] = pose.velocity_at(bodies.position[b]);
  bodies.spin[b] = q * (q.conjugate() * pose.spin).cwiseProduct(bodies.inertia[b]);
}

void set_motion(const WallPose& start, const WallPose& middle, const WallPose& end, const Vec3& now,
                double radius, SphereMotion& m) {
  const Vec3 half_way = 0.5 * (start.to_space_point(end.to_wall(now)) + now);
  Eigen::Map<Vec3>(m.position) = now;
  m.radius = radius;
  Eigen::Map<Vec3>(m.velocity_mid) = middle.velocity_at(half_way);
  Eigen::Map<Vec3>(m.spin_mid) = middle.spin;
  Eigen::Map<Vec3>(m.velocity) = end.velocity_at(now);
  Eigen::Map<Vec3>(m.spin) = end.spin;
}

}  // namespace

std::vector<WallPose> HeldBodies::poses(double time) const {
  std::vector<WallPose> out;
  for (const WallMotion& motion : motions) out.push_back(motion.pose(time));
  return out;
}

void HeldBodies::list(const Bodies& bodies) {
  body.clear();
  for (std::uint32_t b = 0; b < bodies.held.size(); ++b)
    if (is_held(bodies, b)) body.push_back(b);
}

void HeldBodies::find(const Bodies& bodies, double time) {
  const std::vector<WallPose> now = poses(time);
  list(bodies);
  position.clear();
  orientation.clear();
  for (const std::uint32_t b : body) {
    const WallPose& pose = now[bodies.held[b] - 1];
    position.push_back(pose.to_wall(bodies.position[b]));
    orientation.push_back(pose.turned ? Quat(pose.turn.transpose()) * bodies.orientation[b]
                                      : bodies.orientation[b]);
  }
}

void HeldBodies::place(double time, Bodies& bodies) const {
  const std::vector<WallPose> now = poses(time);
  parallel_for(body.size(), [&](std::size_t k) {
    const std::uint32_t b = body[k];
    const WallPose& pose = now[bodies.held[b] - 1];
    bodies.position[b] = pose.to_space_point(position[k]);
    bodies.remainder[b].setZero();
    bodies.orientation[b] = pose.turned ? (Quat(pose.turn) * orientation[k]).normalized() : orientation[k];
    set_velocities(pose, b, bodies);
    place_spheres(bodies, b, b + 1);
  });
}

void HeldBodies::move(double time, double dt, Bodies& bodies,
                      std::vector<SphereMotion>& sphere_motions) const {
  place(time, bodies);
  const std::vector<WallPose> start = poses(time - dt), end = poses(time);
  std::vector<WallPose> middle;
  for (const WallMotion& motion : motions) middle.push_back(motion.mid_step(time, dt));
  const Spheres& spheres = bodies.spheres;
  parallel_for(body.size(), [&](std::size_t k) {
    const std::uint32_t b = body[k], m = bodies.held[b] - 1u;
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s)
      set_motion(start[m], middle[m], end[m], spheres.position[s], spheres.radius[s], sphere_motions[s]);
  });
}

void HeldBodies::hold(double time, Bodies& bodies) const {
  const std::vector<WallPose> now = poses(time);
  parallel_for(body.size(),
               [&](std::size_t k) { set_velocities(now[bodies.held[body[k]] - 1], body[k], bodies); });
}

double HeldBodies::power(double time, const Vec3& field, const Bodies& bodies) const {
  const std::vector<WallPose> now = poses(time);
  return -parallel_sum(body.size(), 0.0, [&](std::size_t k) {
    const std::uint32_t b = body[k];
    const WallPose& pose = now[bodies.held[b] - 1];
    const Vec3 force = bodies.force[b] - bodies.mass[b] * field;
    return force.dot(pose.velocity_at(bodies.position[b])) + bodies.torque[b].dot(pose.spin);
  });
}

double HeldBodies::kicked(double time, const ContactList& contacts, const Bodies& bodies) const {
  const std::vector<WallPose> now = poses(time);
  double work = 0.0;
  for_each_kick(contacts, [&](std::uint32_t s, const Vec3& impulse, const Vec3& moment) {
    const std::uint32_t b = bodies.spheres.body[s];
    if (!is_held(bodies, b)) return;
    const WallPose& pose = now[bodies.held[b] - 1];
    work -= impulse.dot(pose.velocity_at(bodies.spheres.position[s])) + moment.dot(pose.spin);
  });
  return work;
}

}  // namespace cairn
