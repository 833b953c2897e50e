// Runs of very many steps: what is conserved stays so, what rests stays at rest. CAIRN_LONG=1 runs them
// whole.
#include <gtest/gtest.h>

#include <cstdlib>

#include "analysis/spin_state.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

std::uint64_t steps(double shortened, double whole) {
  return static_cast<std::uint64_t>(std::getenv("CAIRN_LONG") ? whole : shortened);
}

/// Advances by `last` steps and calls look(steps done) at ever longer intervals.
template <class Look>
void watch(Experiment& e, std::uint64_t last, Look&& look) {
  for (std::uint64_t done = 0, next = 1000; done < last; next = std::min(last, next + next / 4)) {
    e.advance(next - done);
    done = next;
    look(static_cast<double>(done));
  }
}

/// A curve of drifts, and the greatest of them; a logarithmic plot has no zero.
struct Drift {
  report::Curve curve;
  double worst = 0.0;
  void add(double steps, double drift) {
    worst = std::max(worst, drift);
    curve.x.push_back(steps);
    curve.y.push_back(std::max(drift, 1e-17));
  }
};

TEST(LongRuns, ThreeSpheresThatRestOnEachOther) {
  // They turn about their mass centre, held by their gravity and a little cohesion, every part of the law on.
  const double side = 2.0 - 1e-6, arm = side / std::sqrt(3.0), rate = 2e-4;
  std::string content;
  for (int k = 0; k < 3; ++k) {
    const double a = 2.0 * kPi * k / 3.0;
    const Vec3 x(arm * std::cos(a), arm * std::sin(a), 0.0);
    content += body({.position = x, .velocity = Vec3(0, 0, rate).cross(x), .spin = {0, 0, rate}});
  }
  Experiment e(
      scene_text({.restitution = 0.5, .friction = 0.5, .rolling = 0.3, .twisting = 0.3, .cohesion = 0.01},
                 "stiffness = 1e3", "method = 'direct'", content));
  e.begin();
  e.advance(20000);  // the springs come to rest
  const auto energy = [&] {
    return mechanical_energy(e) + gravitational_energy(e.physics, e.state, e.scratch) +
           e.state.ledger.dissipated;
  };
  const Budget before = budget(e.state.bodies);
  const double start = energy(), kinetic = e.kinetic_energy();
  Drift momentum{{"angular momentum", {}, {}}}, work{{"energy over the kinetic one", {}, {}}};
  const std::uint64_t last = steps(1e6, 1e8);
  watch(e, last, [&](double done) {
    momentum.add(done, angular_drift(before, budget(e.state.bodies)));
    work.add(done, std::abs(energy() - start) / kinetic);
  });
  EXPECT_EQ(e.state.contacts.records().size(), 3u);
  report::error(
      fmt::format("three spheres resting on each other for {:.0e} steps ({:.0f} turns): angular momentum, "
                  "relative",
                  static_cast<double>(last), e.state.clock.time() * rate / (2.0 * kPi)),
      "conserved", momentum.worst, 1e-11);
  report::error("their energy, over the kinetic energy", "conserved", work.worst, 1e-6);
  report::plot("three-bodies", "Drift of three spheres that rest on each other.",
               {"steps", "drift", true, true}, {momentum.curve, work.curve});
  report::note(
      "Contacts at rest neither heat up nor creep: the drift is that of rounding. CAIRN_LONG=1 makes 1e8 "
      "steps.");
}

/// Volume integral of I1 in a pile (J), from its contacts and from its virial: -W - 2 K_rot and, for
/// aggregates, sum of (x_i - X).(m_i g_i) over their spheres.
std::pair<double, double> trace_of_stress(Experiment& e) {
  const Bodies& bodies = e.state.bodies;
  const Spheres& s = bodies.spheres;
  e.state.contacts.keep_wrenches = true;
  e.advance(1);
  double contacts = 0.0;
  for (std::size_t slot = 0; slot < e.state.contacts.slots(); ++slot) {
    if (!e.state.contacts.touching(slot)) continue;
    const Pair p = e.state.contacts.pair(slot);
    const Vec3 apart = bodies.position[s.body[p.j]] - bodies.position[s.body[p.i]];
    contacts -= apart.dot(Eigen::Map<const Vec3>(e.state.contacts.wrench[slot].force));
  }
  const SpinState whole = spin_state(bodies, all_bodies(bodies));
  double virial = -gravitational_energy(e.physics, e.state, e.scratch);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    virial -= bodies.mass[b] * (bodies.velocity[b] - whole.velocity).squaredNorm();
  for (std::size_t i = 0; i < s.size(); ++i)
    for (std::size_t j = 0; j < s.size(); ++j) {
      if (s.body[i] == s.body[j]) continue;
      const Vec3 d = s.position[j] - s.position[i];
      const Vec3 pull = kGravitationalConstant * s.mass[i] * s.mass[j] / std::pow(d.norm(), 3) * d;
      virial += (s.position[i] - bodies.position[s.body[i]]).dot(pull);
    }
  return {contacts, virial};
}

TEST(LongRuns, APileOfAHundredBodiesKeepsItsSpin) {
  Experiment e(hundred_bodies());
  e.begin();
  e.advance(e.physics.steps + 60000);  // the last grains roll to their places
  const auto rate = [&] {
    return rotation_rate(spin_state(e.state.bodies, all_bodies(e.state.bodies))).norm();
  };
  const double dt = e.physics.contacts.dt;
  const Budget before = budget(e.state.bodies);
  const double start = rate();
  Drift period{{"spin period", {}, {}}}, momentum{{"angular momentum", {}, {}}};
  const std::uint64_t last = steps(2e4, 1e7);
  watch(e, last, [&](double done) {
    momentum.add(done, angular_drift(before, budget(e.state.bodies)));
    period.add(done, std::abs(start / rate() - 1.0));
  });
  const std::string run = fmt::format(
      "a pile of 100 bodies for {:.0e} steps ({:.0f} turns of {:.2f} h)", static_cast<double>(last),
      static_cast<double>(last) * dt * start / (2.0 * kPi), 2.0 * kPi / start / 3600.0);
  report::error(run + ": angular momentum, relative", "conserved", momentum.worst, 1e-11);
  report::error(run + ": spin period, change relative", "a pile at rest", period.curve.y.back(), 1e-5);
  const auto [contacts, virial] = trace_of_stress(e);
  report::close("that pile, rough and cohesive aggregates that spin: volume integral of I1, J",
                "virial: -W - 2 K_rot + sum of (x_i - X).(m_i g_i)", contacts, virial, 1e-3);
  report::note(
      "A settled pile that spins freely keeps its angular momentum to rounding; what its period "
      "changes by is the pile's own settling. The user need do nothing.");
  report::plot("pile-spin", "Drift of a settled pile that spins freely.",
               {"steps", "relative drift", true, true}, {momentum.curve, period.curve});
}

}  // namespace
}  // namespace cairn
