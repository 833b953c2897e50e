// An isolated pile keeps its momentum and angular momentum, whatever its contacts and its gravity do.
#include <gtest/gtest.h>

#include <cstdlib>

#include "contact/stiffness.h"
#include "core/random.h"
#include "physics/experiment.h"
#include "physics/report.h"

namespace cairn {
namespace {

/// 1e5 steps when CAIRN_LONG is set in the environment. The tolerances are the same.
std::uint64_t long_run() {
  return std::getenv("CAIRN_LONG") ? 100'000 : 10'000;
}

/// Aggregates of five shapes thrown together, with every part of the contact law on. Nothing controls their
/// spin.
Experiment falling_pile(int count, const std::string& gravity) {
  Experiment pile(fmt::format(R"(
seed = 7
[[cloud]]
count = {}
filling = 0.2
distribution = "uniform"
size = 4
size_max = 5
density = 3000
material = "rough"
spin_period = 12000
shape = [{{ shape = "dumbbell" }}, {{ shape = "rod4" }}, {{ shape = "diamond" }}, {{ shape = "tetrahedron" }},
         {{ shape = "cube" }}]
[[material]]
name = "rough"
restitution_normal = 0.3
restitution_tangential = 0.3
cohesion = 5
[contact]
max_overlap = 0.1
overlap_limit = 1
steps_per_contact = 12
[gravity]
{}
[[stage]]
name = "collapse"
duration = 1e6
)",
                              count, gravity));
  Bodies& bodies = pile.state.bodies;
  Random random(11, 0);
  const double speed = 0.5 * escape_speed(bodies);
  double reach = 0.0;
  for (const Vec3& x : bodies.position) reach = std::max(reach, x.norm());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies.velocity[b] += speed * (0.5 * random.in_ball() - bodies.position[b] / reach);
    bodies.spin[b] += bodies.mass[b] * bodies.length[b] * 0.1 * speed * random.in_ball();
  }
  pile.scene.stages[0].impact_speed = 0.2 * speed;
  pile.begin();
  return pile;
}

struct Momenta {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double linear_sum = 0.0, angular_sum = 0.0;  ///< of magnitudes
};

/// Angular momentum about the fixed origin.
Momenta momenta(const Bodies& bodies) {
  Momenta m;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vec3 p = bodies.mass[b] * bodies.velocity[b], orbital = bodies.position[b].cross(p);
    m.linear += p;
    m.angular += orbital + bodies.spin[b];
    m.linear_sum += p.norm();
    m.angular_sum += orbital.norm() + bodies.spin[b].norm();
  }
  return m;
}

void expect_momenta_kept(const std::string& gravity, Experiment pile, std::uint64_t steps, double tolerance) {
  const Momenta before = momenta(pile.state.bodies);
  const double energy = pile.kinetic_energy();
  double linear = 0.0, angular = 0.0;
  std::size_t contacts = 0;
  for (std::uint64_t done = 0; done < steps; done += steps / 20) {
    pile.advance(steps / 20);
    contacts = std::max(contacts, pile.state.contacts.records().size());
    const Momenta now = momenta(pile.state.bodies);
    linear = std::max(linear, (now.linear - before.linear).norm() / before.linear_sum);
    angular = std::max(angular, (now.angular - before.angular).norm() / before.angular_sum);
  }
  const std::string what = fmt::format("500 aggregates, whole law, {}: drift of the ", gravity);
  report::error(fmt::format("{}momentum in {} steps, over the sum of magnitudes", what, steps), "conserved",
                linear, tolerance);
  report::error(fmt::format("{}angular momentum in {} steps, over the sum of magnitudes", what, steps),
                "conserved", angular, tolerance);
  // Not an empty promise: the bodies have met, and much of their motion has been lost.
  EXPECT_GT(pile.state.ledger.dissipated, 0.1 * energy);
  EXPECT_GT(contacts, pile.state.bodies.size() / 10);
}

TEST(IsolatedPile, DirectGravityKeepsMomentumAndAngularMomentum) {
  expect_momenta_kept("direct gravity", falling_pile(500, "method = 'direct'"), long_run(), 1e-12);
}

TEST(IsolatedPile, TreeGravityKeepsMomentumAndAngularMomentum) {
  expect_momenta_kept("tree", falling_pile(500, "method = 'tree'"), long_run(), 1e-10);
}

TEST(IsolatedPile, HeldTreeGravityKeepsMomentumAndAngularMomentum) {
  expect_momenta_kept("tree held for 10 steps", falling_pile(500, "method = 'tree'\ninterval = 10"),
                      long_run(), 1e-10);
}

}  // namespace
}  // namespace cairn
