#include "sim/agitation.h"

#include "analysis/spin_state.h"

namespace cairn {

namespace {

double rigid_energy(const State& state) {
  if (state.anchored()) return 0.0;
  const SpinState whole = spin_state(state.bodies, all_bodies(state.bodies));
  const double moving = 0.5 * whole.mass * whole.velocity.squaredNorm();
  return state.box.periodic() ? moving : moving + 0.5 * rotation_rate(whole).dot(whole.angular_momentum);
}

}  // namespace

double agitation(const State& state, const Budget& total) {
  return total.translational_energy + total.rotational_energy - rigid_energy(state);
}

}  // namespace cairn
