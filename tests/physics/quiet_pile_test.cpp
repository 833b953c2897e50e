// Gravity that is evaluated rarely keeps a quiet spinning pile as gravity of every step does. CAIRN_LONG=1
// runs 1e6 steps.
#include <gtest/gtest.h>

#include <cstdlib>

#include "analysis/spin_state.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

/// Kinetic energy apart from the rigid rotation (J).
double shaking(const Bodies& bodies) {
  const SpinState pile = spin_state(bodies, all_bodies(bodies));
  const Vec3 omega = rotation_rate(pile);
  double energy = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vec3 v = bodies.velocity[b] - pile.velocity - omega.cross(bodies.position[b] - pile.center);
    const Vec3 w = angular_velocity(bodies, b) - omega;
    const Vec3 own = bodies.orientation[b].conjugate() * w;
    energy += 0.5 * bodies.mass[b] * v.squaredNorm() + 0.5 * own.dot(bodies.inertia[b].cwiseProduct(own));
  }
  return energy;
}

struct Quiet {
  double momentum = 0.0;  ///< greatest drift of angular momentum, relative
  double energy = 0.0;    ///< greatest change of the exact total and dissipated energy over |W|
  double shaking = 0.0;   ///< mean over the second half, over |W|
  double steps = 0.0;     ///< between evaluations, at the end
};

Quiet watch(const Experiment& pile, const std::string& gravity, std::uint64_t steps) {
  Experiment e(hundred_bodies());
  e.state.bodies = pile.state.bodies;
  e.scene.stages[0].stiffness = pile.physics.k_n;
  const Scene other = parse_scene("[[body]]\nshape = 'sphere'\ndensity = 1\n[gravity]\n" + gravity +
                                      "\n[[stage]]\nname = 's'\nduration = 1\n",
                                  "gravity.toml", ".");
  e.scene.gravity = other.gravity;
  e.begin(pile.state.contacts.records());
  e.advance(2000);
  Physics exact = e.physics;
  exact.gravity = GravityMethod::direct;
  const auto energy = [&] {
    return mechanical_energy(e) + gravitational_energy(exact, e.state, e.scratch) + e.state.ledger.dissipated;
  };
  const double binding = -gravitational_energy(exact, e.state, e.scratch), start = energy();
  const Budget before = budget(e.state.bodies);
  Quiet out;
  constexpr int kLooks = 20;
  for (int look = 1; look <= kLooks; ++look) {
    e.advance(steps / kLooks);
    out.momentum = std::max(out.momentum, angular_drift(before, budget(e.state.bodies)));
    out.energy = std::max(out.energy, std::abs(energy() - start) / binding);
    if (2 * look > kLooks) out.shaking += shaking(e.state.bodies) / binding / (kLooks / 2);
  }
  out.steps = static_cast<double>(e.state.gravity.steps);
  return out;
}

TEST(QuietPile, RareGravityNeitherShakesItNorTakesItsSpin) {
  const std::uint64_t steps = std::getenv("CAIRN_LONG") ? 1'000'000 : 20'000;
  Experiment pile(hundred_bodies());
  pile.begin();
  pile.advance(pile.physics.steps + 60000);  // they rest on each other, turning once in some hours
  const Quiet exact = watch(pile, "method = 'direct'\ninterval = 1", steps);
  for (const char* gravity : {"method = 'direct'", "method = 'direct'\ninterval = 1000", "error = 1e-3",
                              "error = 1e-2", "error = 0.1"}) {
    const Quiet rare = watch(pile, gravity, steps);
    std::string name = gravity;
    std::replace(name.begin(), name.end(), '\n', ',');
    const std::string what = fmt::format("quiet pile, {} (every {:.0f} steps), {:.0e} steps: ", name,
                                         rare.steps, static_cast<double>(steps));
    EXPECT_GE(rare.steps, 50.0) << what;
    report::error(what + "drift of angular momentum, relative", "conserved", rare.momentum, 1e-10);
    report::error(what + "energy astray over |W|", fmt::format("every step, exact: {:.1e}", exact.energy),
                  rare.energy, std::max(1.2 * exact.energy, 1e-9));
    report::error(what + "kinetic energy apart from the rotation over |W|",
                  fmt::format("every step, exact: {:.1e}", exact.shaking), rare.shaking,
                  std::max(exact.shaking, 1e-12));
  }
}

}  // namespace
}  // namespace cairn
