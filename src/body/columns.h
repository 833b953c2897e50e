// All arrays with an entry for each body or sphere, for those who move entries about.
#pragma once

#include "body/bodies.h"

namespace cairn {

/// Calls f with each array that has an entry per sphere, of all the Spheres given.
template <class F, class... S>
void for_each_sphere_column(F&& f, S&&... spheres) {
  f(spheres.radius...);
  f(spheres.mass...);
  f(spheres.offset...);
  f(spheres.body...);
  f(spheres.position...);
}

/// The same with an entry per body, of all the Bodies given; `cell` is empty where none has left cell 0,
/// `held` and `wall_set` where none is held or apart from a wall. `first_sphere` is not among them.
template <class F, class... B>
void for_each_body_column(F&& f, B&&... bodies) {
  f(bodies.mass...);
  f(bodies.volume...);
  f(bodies.inertia...);
  f(bodies.shape...);
  f(bodies.length...);
  f(bodies.material...);
  f(bodies.held...);
  f(bodies.wall_set...);
  f(bodies.position...);
  f(bodies.remainder...);
  f(bodies.velocity...);
  f(bodies.orientation...);
  f(bodies.spin...);
  f(bodies.cell...);
  f(bodies.force...);
  f(bodies.torque...);
}

}  // namespace cairn
