// Energy of a collapse with the whole law, and a smooth pile in equilibrium under its own gravity.
#include <gtest/gtest.h>

#include "analysis/spin_state.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

double energy(Experiment& e) {
  return mechanical_energy(e) + gravitational_energy(e.physics, e.state, e.scratch);
}

struct Balance {
  std::vector<double> time, kinetic, dissipated, error;  ///< s; the rest over the energy injected
  double worst = 0.0;                                    ///< over the energy injected
};

/// A small cloud of aggregates that falls together, every part of the law on.
Balance collapse(int count, double steps_per_contact, double duration) {
  Experiment e(fmt::format(R"(
seed = 5
[[cloud]]
count = {}
filling = 0.2
size = 5
density = 3000
spin_period = 20000
shape = [{{ shape = "dumbbell" }}, {{ shape = "tetrahedron" }}, {{ shape = "diamond" }}, {{ shape = "sphere" }}]
[[material]]
name = "rough"
restitution_normal = 0.3
restitution_tangential = 0.3
cohesion = 5
[contact]
max_overlap = 0.05
overlap_limit = 0.5
steps_per_contact = {}
[gravity]
method = "direct"
interval = 1
[[stage]]
name = "collapse"
duration = {}
)",
                           count, steps_per_contact, duration));
  for (std::size_t b = 0; b < e.state.bodies.size(); ++b)  // thrown together: a fall from rest takes long
    e.state.bodies.velocity[b] -= e.state.bodies.position[b] / 2500.0;
  e.begin();
  const double start = energy(e), thrown = e.kinetic_energy();
  const double potential = gravitational_energy(e.physics, e.state, e.scratch);
  Balance out;
  constexpr int rows = 100;
  std::size_t contacts = 0;
  for (int k = 0; k < rows; ++k) {
    e.advance(e.physics.steps / rows);
    out.time.push_back(e.state.clock.time());
    out.kinetic.push_back(e.kinetic_energy());
    contacts = std::max(contacts, e.state.contacts.records().size());
    out.dissipated.push_back(e.state.ledger.dissipated);
    out.error.push_back(std::abs(energy(e) + e.state.ledger.dissipated - start));
  }
  const double work = thrown + potential - gravitational_energy(e.physics, e.state, e.scratch);
  for (int k = 0; k < rows; ++k) {
    out.kinetic[k] /= work;
    out.dissipated[k] /= work;
    out.error[k] /= work;
    out.worst = std::max(out.worst, out.error[k]);
  }
  EXPECT_GT(out.dissipated.back(), 0.5);
  EXPECT_GE(contacts, static_cast<std::size_t>(count) / 4);
  return out;
}

TEST(Collapse, EnergyIsStoredOrDissipatedToAThousandth) {
  constexpr int count = 20;
  constexpr double duration = 8000.0;  // s
  report::Curve worst{"worst over the collapse", {}, {}};
  for (const double n : {25.0, 50.0, 100.0}) {
    const Balance b = collapse(count, n, duration);
    worst.x.push_back(n);
    worst.y.push_back(b.worst);
    if (n != 50.0) continue;
    report::error(fmt::format("collapse of {} aggregates, default time step: energy injected (start and work "
                              "of gravity) not found again, worst moment, relative",
                              count),
                  "kinetic + springs + dissipated", b.worst, 1e-3);
    report::plot("collapse", "Energies of the collapse over the energy injected, default time step.",
                 {"time (s)", "energy / energy injected"},
                 {{"kinetic", b.time, b.kinetic}, {"dissipated", b.time, b.dissipated}});
  }
  report::within("order of the energy error in the step", "second order", -order_of(worst.x, worst.y), 1.7,
                 3.0);
  report::plot("collapse-order", "Energy gone astray in a collapse against steps per contact.",
               {"steps per contact", "energy error / energy injected", true, true}, {worst});
}

/// Energy that an oblique blow of two dumbbells leaves unaccounted for, over the kinetic energy before; root
/// mean square over the phases of the step at first touch.
double gone_astray(const Surface& surface, double steps_per_contact) {
  constexpr int phases = 5;
  double sum = 0.0;
  for (int k = 0; k < phases; ++k) {
    Experiment e(
        scene_text(surface, fmt::format("stiffness = 1e7\nsteps_per_contact = {}", steps_per_contact), "",
                   body({.shape = "dumbbell", .velocity = {0.1, 0.03, 0.0}, .spin = {0.02, 0.01, 0.03}}) +
                       body({.shape = "dumbbell", .position = {3.75, 0.4, 0.3}})));
    e.begin();
    e.state.bodies.position[1].x() += k * 0.1 * e.physics.contacts.dt / phases;
    e.begin();
    const double before = e.kinetic_energy();
    bool met = false;
    for (double t = 0.0; t < 3.0; t += e.physics.contacts.dt) {
      e.advance(1);
      met |= e.touching();
    }
    EXPECT_TRUE(met && !e.touching());
    sum += std::pow((e.kinetic_energy() + e.state.ledger.dissipated) / before - 1.0, 2);
  }
  return std::sqrt(sum / phases);
}

TEST(Ledger, AccountsForTheEnergyOfABlowToSecondOrder) {
  const std::pair<const char*, Surface> surfaces[] = {
      {"dashpots", {.restitution = 0.55}},
      {"dashpots and cohesion", {.restitution = 0.55, .cohesion = 1e3}},
      {"friction", {.friction = 0.3}},
      {"friction and dashpots", {.restitution = 0.55, .friction = 0.3}},
      {"all", {.restitution = 0.55, .friction = 0.3, .rolling = 0.3, .twisting = 0.3, .cohesion = 1e3}}};
  std::vector<report::Curve> curves;
  for (const auto& [name, surface] : surfaces) {
    report::Curve curve{name, {25.0, 50.0, 100.0}, {}};
    for (const double n : curve.x) curve.y.push_back(gone_astray(surface, n));
    report::error(
        fmt::format("oblique blow of two dumbbells, {}: energy gone astray at 50 steps per contact, "
                    "over the kinetic energy before",
                    name),
        "kinetic + dissipated", curve.y[1], 1e-3);
    report::within(fmt::format("{}: order of that error", name), "second order", -order_of(curve.x, curve.y),
                   1.7, 3.0);
    curves.push_back(curve);
  }
  report::plot("ledger", "Energy of an oblique blow that the ledger does not find.",
               {"steps per contact", "energy / kinetic energy before", true, true}, curves);
}

/// A pile of smooth equal spheres, settled under its own gravity.
Experiment settled_pile(int count) {
  Experiment e("seed = 3\n" + scene_text({.restitution = 0.05}, "steps_per_contact = 20", "method = 'direct'",
                                         cloud("sphere", count, 10.0, 3000.0), 2e4));
  e.begin();
  const double dt = e.physics.contacts.dt;
  for (std::uint64_t k = 0; k < e.physics.steps; ++k) {
    e.advance(1);
    // A drag ends the long ringing of the pile; weak at first, or the spheres would sink through honey.
    const double part = static_cast<double>(k) / static_cast<double>(e.physics.steps);
    const double drag = part < 0.4 ? 0.0 : part < 0.8 ? 1.0 / 400.0 : 1.0 / 60.0;  // 1/s
    for (Vec3& v : e.state.bodies.velocity) v *= 1.0 - drag * dt;
  }
  return e;
}

TEST(SmoothPile, ObeysTheVirialAndItsHydrostaticProfile) {
  Experiment e = settled_pile(200);
  e.state.contacts.keep_wrenches = true;
  e.advance(1);
  const Bodies& bodies = e.state.bodies;
  const double gravity = gravitational_energy(e.physics, e.state, e.scratch);
  const SpinState whole = spin_state(bodies, all_bodies(bodies));
  report::error("kinetic energy left, over |W|", "settled", e.kinetic_energy() / -gravity, 1e-5);

  // Trace of each grain's stress times its volume: -sum (c - X).f.
  std::vector<double> trace(bodies.size(), 0.0);
  double total = 0.0;
  for (std::size_t slot = 0; slot < e.state.contacts.slots(); ++slot) {
    if (!e.state.contacts.touching(slot)) continue;
    const Pair p = e.state.contacts.pair(slot);
    const Vec3 d = bodies.spheres.position[p.j] - bodies.spheres.position[p.i];
    const double virial = -d.dot(Eigen::Map<const Vec3>(e.state.contacts.wrench[slot].force));
    trace[p.i] += 0.5 * virial;  // equal spheres: each has half of the lever
    trace[p.j] += 0.5 * virial;
    total += virial;
  }
  report::close("volume integral of I1, J", "-W (virial theorem at rest)", total, -gravity, 5e-3);

  // A uniform ball of the same mass that carries the same -W = 3 G M^2 / 5 R.
  const double radius = 0.6 * kGravitationalConstant * whole.mass * whole.mass / -gravity;
  const double density = whole.mass / (4.0 / 3.0 * kPi * std::pow(radius, 3));
  const double centre = 2.0 / 3.0 * kPi * kGravitationalConstant * density * density * radius * radius;
  report::Curve grains{"grains in shells", {}, {}, false}, fluid{"uniform ball", {}, {}};
  constexpr int shells = 5;
  double worst = 0.0;
  for (int k = 0; k < shells; ++k) {
    const double inner = radius * std::cbrt(static_cast<double>(k) / shells),
                 outer = radius * std::cbrt((k + 1.0) / shells);
    double sum = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const double r = (bodies.position[b] - whole.center).norm();
      if (r >= inner && (r < outer || k == shells - 1)) sum += trace[b];
    }
    const double pressure = sum / 3.0 / (4.0 / 3.0 * kPi * (std::pow(outer, 3) - std::pow(inner, 3)));
    const double mean_square =
        0.6 * (std::pow(outer, 5) - std::pow(inner, 5)) / (std::pow(outer, 3) - std::pow(inner, 3));
    const double expected = centre * (1.0 - mean_square / (radius * radius));
    worst = std::max(worst, std::abs(pressure - expected) / centre);
    grains.x.push_back(std::sqrt(mean_square) / radius);
    grains.y.push_back(pressure);
  }
  for (int k = 0; k <= 40; ++k) {
    fluid.x.push_back(k / 40.0);
    fluid.y.push_back(centre * (1.0 - fluid.x.back() * fluid.x.back()));
  }
  report::error(
      "pressure in five shells of equal volume against a uniform ball, worst, over that of the centre",
      "(2/3) pi G rho^2 (R^2 - r^2)", worst, 0.15);
  report::plot("hydrostatic", "Pressure in a settled pile of smooth spheres.",
               {"distance from the centre / R", "pressure (Pa)"}, {fluid, grains});
}

}  // namespace
}  // namespace cairn
