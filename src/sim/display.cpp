#include "sim/display.h"

#include "analysis/spin_state.h"
#include "body/cells.h"

namespace cairn {

Display make_display(const State& state, const std::vector<std::uint8_t>& remnant) {
  const Bodies& bodies = state.bodies;
  Display out;
  if (bodies.cell_edge > 0.0) {
    std::vector<std::uint32_t> members;
    for (std::uint32_t b = 0; b < bodies.size(); ++b)
      if (remnant[b]) members.push_back(b);
    const double step = kFrameStep * bodies.cell_edge;
    out.origin = step * nearest_multiples(spin_state(bodies, members).center, step);
  }
  out.bodies.resize(bodies.size());
  out.spheres.resize(bodies.spheres.size());
  out.velocities.resize(bodies.spheres.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    out.bodies[b] = place(bodies, b, out.origin);
    Vec3 x = out.bodies[b];
    for (int axis = 0; axis < 3; ++axis)
      if (const double edge = state.box.edge[axis]; edge > 0.0) x[axis] -= std::floor(x[axis] / edge) * edge;
    const Vec3 spin = angular_velocity(bodies, b);
    for (std::uint32_t s = bodies.first_sphere[b]; s < bodies.first_sphere[b + 1]; ++s) {
      const Vec3 arm = bodies.spheres.position[s] - bodies.position[b];
      out.spheres[s] = (x + arm).cast<float>();
      out.velocities[s] = (bodies.velocity[b] + spin.cross(arm)).cast<float>();
    }
  }
  return out;
}

}  // namespace cairn
