#include "sim/relax.h"

#include <algorithm>
#include <cmath>

#include "analysis/fragments.h"
#include "analysis/spin_state.h"
#include "body/cells.h"
#include "core/elementary.h"
#include "core/parallel.h"

namespace cairn {

namespace {

/// The bodies of each pile, of one that moves freely only if they are more than one.
void collect_piles(const State& state, Scratch& scratch) {
  const std::vector<std::uint32_t>& pile = state.relaxation.pile;
  scratch.piles.clear();
  for (std::uint32_t b = 0; b < pile.size(); ++b) {
    if (pile[b] == Fragments::kNone) continue;  // held
    if (pile[b] >= scratch.piles.size()) scratch.piles.resize(pile[b] + 1u);
    scratch.piles[pile[b]].push_back(b);
  }
  const std::size_t least = state.anchored() ? 1 : 2;
  std::erase_if(scratch.piles, [&](const auto& bodies) { return bodies.size() < least; });
}

/// The motion of a pile's bodies less that of the pile, which is at rest where walls or held bodies are.
class InnerMotion {
 public:
  InnerMotion(const State& state, const std::vector<std::uint32_t>& pile)
      : bodies_(state.bodies), whole_(spin_state(state.bodies, pile)) {
    if (state.anchored())
      whole_.velocity.setZero();
    else if (!state.box.periodic())
      rate_ = rotation_rate(whole_);
  }
  double mass() const { return whole_.mass; }
  Vec3 velocity(std::size_t b) const {
    return bodies_.velocity[b] - whole_.velocity - rate_.cross(place(bodies_, b, whole_.center));
  }
  /// Angular momentum (kg m^2/s) about the body's mass centre.
  Vec3 spin(std::size_t b) const {
    const Quat& q = bodies_.orientation[b];
    return bodies_.spin[b] - q * (q.conjugate() * rate_).cwiseProduct(bodies_.inertia[b]);
  }
  /// Kinetic energy (J).
  double energy(std::size_t b, const Vec3& velocity, const Vec3& spin) const {
    const Vec3 turned = bodies_.orientation[b].conjugate() * spin;
    return 0.5 * bodies_.mass[b] * velocity.squaredNorm() +
           0.5 * turned.dot(turned.cwiseQuotient(bodies_.inertia[b]));
  }

 private:
  const Bodies& bodies_;
  SpinState whole_;
  Vec3 rate_ = Vec3::Zero();  // rad/s
};

}  // namespace

double relaxation_rate(const RelaxSpec& relax, double k_n, double mass, std::size_t bodies) {
  const auto count = static_cast<double>(bodies);
  return relax.rate.value_or(2.0 * std::sqrt(k_n * count / mass) / cube_root(count));
}

void begin_relaxation(const Physics& physics, State& state, Scratch& scratch) {
  Relaxation& relaxation = state.relaxation;
  relaxation = Relaxation{};
  scratch.piles.clear();
  if (!physics.relax) return;
  relaxation.pile = find_fragments(state.bodies, 0.0, state.box).label;
  relaxation.scale =
      physics.gravity != GravityMethod::none
          ? std::abs(gravitational_energy(physics, state, scratch))
          : std::max(0.0, stored_energy(state.bodies, physics.contacts, state.contacts) +
                              state.walls.stored_energy(state.bodies, physics.contacts, state.clock.time()));
  collect_piles(state, scratch);
  for (const std::vector<std::uint32_t>& pile : scratch.piles) {
    double mass = 0.0;
    for (const std::uint32_t b : pile) mass += state.bodies.mass[b];
    const double steps =
        1.0 / (relaxation_rate(*physics.relax, physics.softest, mass, pile.size()) * physics.contacts.dt);
    relaxation.look = std::max(relaxation.look, static_cast<std::uint64_t>(std::min(steps, 1e15)));
  }
}

void relax(const Physics& physics, State& state, Scratch& scratch) {
  if (scratch.piles.empty()) collect_piles(state, scratch);  // resumed
  Bodies& bodies = state.bodies;
  for (const std::vector<std::uint32_t>& pile : scratch.piles) {
    const InnerMotion inner(state, pile);
    const double left = exponential(
        -relaxation_rate(*physics.relax, physics.softest, inner.mass(), pile.size()) * physics.contacts.dt);
    const double energy = parallel_sum(pile.size(), 0.0, [&](std::size_t k) {
      const std::uint32_t b = pile[k];
      const Vec3 velocity = inner.velocity(b), spin = inner.spin(b);
      bodies.velocity[b] -= (1.0 - left) * velocity;
      bodies.spin[b] -= (1.0 - left) * spin;
      return inner.energy(b, velocity, spin);
    });
    state.ledger.relaxed += (1.0 - left * left) * energy;
  }
}

bool relaxed(const Physics& physics, const State& state, const Scratch& scratch) {
  const std::uint64_t look = state.relaxation.look;
  if (state.clock.step % look != 0 || state.clock.step < 10 * look) return false;
  double energy = 0.0;
  for (const std::vector<std::uint32_t>& pile : scratch.piles) {
    const InnerMotion inner(state, pile);
    energy += parallel_sum(pile.size(), 0.0, [&](std::size_t k) {
      return inner.energy(pile[k], inner.velocity(pile[k]), inner.spin(pile[k]));
    });
  }
  return energy <= physics.relax->quiet * state.relaxation.scale;
}

}  // namespace cairn
