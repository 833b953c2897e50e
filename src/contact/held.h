// Held bodies: at rest or moving as prescribed, whatever acts on them. Others meet them as bodies of infinite
// mass, of their own shape.
#pragma once

#include <span>
#include <vector>

#include "contact/history.h"
#include "contact/kinematics.h"
#include "contact/wall/motion.h"

namespace cairn {

struct HeldBodies {
  std::vector<WallMotion> motions;  ///< that Bodies::held counts, from 1
  std::vector<std::uint32_t> body;  ///< those that are held, ascending
  std::vector<Vec3> position;       ///< m, of each, where its motion has not displaced it
  std::vector<Quat> orientation;    ///< the same

  bool empty() const { return body.empty(); }
  /// Takes down which bodies are held.
  void list(const Bodies& bodies);
  /// The same, and from where: their motions lead through their poses at `time` (s).
  void find(const Bodies& bodies, double time);
  /// Puts them and their spheres where they are at `time`, with the velocities of that time.
  void place(double time, Bodies& bodies) const;
  /// The same after a step of dt (s), and how their spheres have moved in it.
  void move(double time, double dt, Bodies& bodies, std::vector<SphereMotion>& motions) const;
  /// Gives them the velocities of `time` again, after kicks.
  void hold(double time, Bodies& bodies) const;
  /// Power (W) that they give all others through the wrenches on them, less that of a uniform field (m/s^2).
  double power(double time, const Vec3& field, const Bodies& bodies) const;
  /// Work (J) that they have done in the contacts that began or ended within the step of the last sweep.
  double kicked(double time, const ContactList& contacts, const Bodies& bodies) const;

 private:
  std::vector<WallPose> poses(double time) const;
};

}  // namespace cairn
