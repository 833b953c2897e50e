// Bodies at the edge of what is sensible: sizes and masses far apart, needles, thousands of glued spheres,
// scenes of microns and of thousands of kilometres.
#include <gtest/gtest.h>

#include "contact/law/pair.h"
#include "physics/report.h"
#include "physics/scenes.h"
#include "shape/library.h"

namespace cairn {
namespace {

/// Unit spheres in a row along x.
Shape row(int count, double spacing) {
  Shape shape{"row", "", {}, {}};
  for (int k = 0; k < count; ++k) {
    shape.centers.emplace_back(spacing * (k - 0.5 * (count - 1)), 0.0, 0.0);
    shape.radii.push_back(1.0);
  }
  return shape;
}

/// Touching unit spheres on a cubic lattice, all within 21.3 radii of the middle.
Shape lattice_ball() {
  constexpr int reach = 10, reach2 = 113;
  Shape shape{"lattice ball", "", {}, {}};
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z)
        if (x * x + y * y + z * z <= reach2) {
          shape.centers.push_back(2.0 * Vec3(x, y, z));
          shape.radii.push_back(1.0);
        }
  return shape;
}

void add(Experiment& e, const RigidShape& shape, const Placement& placement, double density = 2000.0) {
  add_body(e.state.bodies, shape, 1, 1.0, density, 0, placement);
}

TEST(ExtremeSizes, AGrainOfAHundredthHitsASphereOfAMillionTimesItsMass) {
  constexpr double speed = 0.02;
  for (const double sine : {0.0, 0.5}) {  // off the centre line: smooth, so only normal speeds change
    Experiment e(scene_text({.restitution = 0.55}, "stiffness = 1e3", "",
                            body({.position = {0, 0, -1}}) + body({.size = 0.01, .position = {0, 0, 5}})));
    Bodies& bodies = e.state.bodies;
    const Vec3 n(sine, 0.0, std::sqrt(1.0 - sine * sine));
    bodies.position[1] = bodies.position[0] + 1.0101 * n;
    bodies.velocity[1] = {0.0, 0.0, -speed};
    e.begin();
    const auto momentum = [&]() -> Vec3 {
      return bodies.mass[0] * bodies.velocity[0] + bodies.mass[1] * bodies.velocity[1];
    };
    const Vec3 before = momentum();
    pass_blow(e);
    const Vec3 m = (bodies.position[1] - bodies.position[0]).normalized();
    const double left = (bodies.velocity[1] - bodies.velocity[0]).dot(m) / (speed * m.z());
    report::close(fmt::format("radii 1:100, masses 1:1e6, {}: restitution",
                              sine > 0.0 ? "half a radius off the centre" : "central"),
                  "value asked for", left, 0.55, 0.005);
    report::error("the same: momentum gone astray, relative", "conserved",
                  (momentum() - before).norm() / before.norm(), 1e-12);
  }
}

TEST(ExtremeSizes, ThreeGrainsCarryASphereOfAMillionTimesTheirMass) {
  constexpr double radius = 0.01, g = 1e-3, aside = 0.02;
  const double lean = std::asin(aside / (1.0 + radius)), height = radius + (1.0 + radius) * std::cos(lean);
  std::string content = body({.position = {0, 0, height}}) + wall();
  for (int k = 0; k < 3; ++k) {
    const double a = 2.0 * kPi * k / 3.0;
    content += body({.size = radius, .position = {aside * std::cos(a), aside * std::sin(a), radius}});
  }
  Experiment e(
      scene_text({.friction = 1.0, .rolling = 0.5, .twisting = 0.5}, "", field({0, 0, -g}), content));
  e.begin();
  // Three times two springs one behind the other; let go, the sphere sinks to twice the depth of its weight.
  const double stiffness = 1.5 * e.physics.k_n, mass = e.state.bodies.mass[0];
  const double period = 2.0 * kPi * std::sqrt(mass / stiffness);
  const auto speed = [&] { return e.state.bodies.velocity[0].z(); };
  const auto start = static_cast<std::uint64_t>(0.1 * period / e.physics.contacts.dt);
  e.advance(start);
  while (speed() < 0.0) e.advance(1);
  const double deepest = height - e.state.bodies.position[0].z();
  const double half = e.state.clock.time();
  report::close("a sphere let go on three grains of a hundredth of its size: greatest depth, m",
                "2 M g / (3 k / 2)", deepest, 2.0 * mass * g / stiffness, 2e-3);
  report::close("time to the greatest depth, s", "pi sqrt(M / (3 k / 2))", half, 0.5 * period, 2e-3);
  report::note(
      "Size ratio 1:100: the program takes the stiffness from the heaviest body and the step from the "
      "lightest, so a scene of both takes sqrt(mass ratio) = 1000 times as many steps as one of large "
      "spheres alone. Results are as good as for equal spheres; leave out grains that do not matter.");
}

TEST(ExtremeShapes, NeedleOfMomentsOneToTenThousand) {
  const RigidShape needle = make_rigid(row(110, 2.0), MassModel::spheres);
  const double ratio = needle.inertia[0] / needle.inertia[2];
  report::close("needle of 110 spheres: I1 / I3", "(2/5) / (2/5 + (n^2 - 1) / 3)", ratio,
                0.4 / (0.4 + (110.0 * 110.0 - 1.0) / 3.0), 1e-9);
  // A blow on its tip: m_eff = 1 / (1/m + x^2/I + 1/m_ball).
  Experiment e(scene_text({.restitution = 0.55}, "stiffness = 1e8", "", body({.position = {0, 0, 0}})));
  Bodies& bodies = e.state.bodies;
  constexpr double speed = 0.05;
  add(e, needle, {.position = {-109.0, 0.0, 2.001}, .velocity = {0, 0, -speed}});
  e.begin();
  const double arm = 109.0;
  const auto tip_speed = [&] { return bodies.velocity[1].z() - arm * angular_velocity(bodies, 1).y(); };
  pass_blow(e);
  report::close("blow of its tip on a sphere: restitution at the tip", "value asked for",
                (tip_speed() - bodies.velocity[0].z()) / speed, 0.55, 0.005);
  const double mobility =
      1.0 / bodies.mass[0] + 1.0 / bodies.mass[1] + arm * arm / (bodies.mass[1] * needle.inertia[2]);
  report::close("impulse on the sphere, N s", "(1 + e) m_eff v", -bodies.mass[0] * bodies.velocity[0].z(),
                1.55 / mobility * speed, 0.005);
  // Spinning about its length and tumbling, in free flight: the flight's own step errors.
  bodies.position[0].z() = -1e4;  // out of its way
  bodies.spin[1] = bodies.mass[1] * needle.inertia[2] * Vec3(3e-3, 0.05, 0.05);
  const double spin = bodies.spin[1].norm();
  const auto energy = [&] { return 0.5 * bodies.spin[1].dot(angular_velocity(bodies, 1)); };
  const double start = energy();
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    e.advance(100);
    worst = std::max(worst, std::abs(energy() / start - 1.0));
  }
  report::error(
      fmt::format("its free tumble, 1e5 steps, {:.2g} rad about its length a step: energy, relative",
                  e.physics.contacts.dt * bodies.spin[1].norm() / bodies.inertia[1][0]),
      "conserved", worst, 1e-3);
  report::error("angular momentum, relative", "conserved", std::abs(bodies.spin[1].norm() / spin - 1.0),
                1e-12);
  report::note(
      "Needles: the step is taken from the spin and the blow that a tip can meet, so nothing is lost at I1 / "
      "I3 = 1e-4. Needles that spin fast about their length need a time_step of their own; the program "
      "warns.");
}

TEST(ExtremeShapes, SpheresOfOneBodyThatOverlapAlmostWholly) {
  constexpr int count = 41;
  constexpr double spacing = 0.05;
  const RigidShape shape = make_rigid(row(count, spacing), MassModel::union_volume);
  // Planes half-way between neighbours cut the solid into two caps' worth of one sphere and slabs.
  const double cap = 1.0 - 0.5 * spacing, lens = 2.0 * kPi * cap * cap * (3.0 - cap) / 3.0;
  const double sphere = 4.0 / 3.0 * kPi;
  report::close("41 spheres 1/20 of a radius apart: volume over that of a sphere",
                "sum of spheres less lenses", shape.volume / sphere, count - (count - 1) * lens / sphere,
                1e-10);
  report::Curve measured{"measured", {}, {}, false}, closed{"n springs and n dashpots", {}, {}};
  for (const int n : {2, 4, 6, 8, 12, 16, 24, 32, 41})
    for (const double restitution : {1.0, 0.8}) {
      const RigidShape flat = make_rigid(row(n, spacing), MassModel::union_volume);
      Experiment e(scene_text({.restitution = restitution}, "stiffness = 1e6", "", wall() + body({})));
      e.state.bodies = Bodies{};
      add(e, flat, {.position = {0, 0, 1.0003}, .velocity = {0, 0, -0.02}});
      e.begin();
      double dashpots = 0.0;  // C_N of all
      for (int k = 0; k < 4000 && (k < 100 || e.touching()); ++k) {
        e.advance(1);
        if (dashpots == 0.0)
          for (const WallContact& c : e.state.walls.contacts) dashpots += c.memory.c_n;
      }
      const double left = e.state.bodies.velocity[0].z() / 0.02;
      // Each dashpot is made for its own contact alone: m_eff = 1 / (1 / M + x^2 / I).
      const double mass = e.state.bodies.mass[0], along = e.state.bodies.inertia[0][2], k_n = 1e6;
      double expected_dashpots = 0.0;
      for (int k = 0; k < n; ++k) {
        const double x = spacing * (k - 0.5 * (n - 1));
        expected_dashpots += damping_ratio(restitution) * std::sqrt(k_n / (1.0 / mass + x * x / along));
      }
      EXPECT_NEAR(dashpots, expected_dashpots, 1e-9 * dashpots);
      const double zeta = 0.5 * expected_dashpots / std::sqrt(n * k_n * mass);
      const double expected = zeta < 1.0 ? std::exp(-kPi * zeta / std::sqrt(1.0 - zeta * zeta)) : 0.0;
      const std::string what =
          fmt::format("flat on {} spheres at once, e = {}: speed after over before", n, restitution);
      report::near(what, "n springs and n dashpots", left, expected, 4e-4 * n);
      if (restitution == 1.0) continue;
      for (report::Curve* curve : {&measured, &closed}) curve->x.push_back(n);
      measured.y.push_back(left);
      closed.y.push_back(expected);
    }
  report::plot("flat-landing", "Restitution of a body that lands flat on n spheres; 0.8 for one of them.",
               {"spheres that touch at once", "speed after over before"}, {closed, measured});
  report::note(
      "A face of n spheres lands on n springs: its contact lasts sqrt(n) times less than the step was chosen "
      "for, and n dashpots brake it, so that the restitution of flat landings is below the value asked for "
      "(plot). Use fewer, larger spheres for flat faces, or more steps per contact.");
}

TEST(ExtremeShapes, BodiesOfFiveThousandSpheresCollide) {
  const RigidShape ball = make_rigid(lattice_ball(), MassModel::spheres);
  const double count = static_cast<double>(ball.radii.size());
  ASSERT_GT(count, 5000.0);
  Experiment e(scene_text({.friction = 0.5, .rolling = 0.3, .twisting = 0.3}, "stiffness = 1e11", "",
                          body({.position = {0, 0, 0}})));
  e.state.bodies = Bodies{};
  Bodies& bodies = e.state.bodies;
  add(e, ball, {.velocity = {0, 0, 0.5}, .angular_velocity = {0.01, -0.02, 0.0}});
  add(e, ball,
      {.position = {5.0, 3.0, 43.5}, .orientation = Quat(0.8, 0.2, -0.3, 0.4), .velocity = {0, 0, -0.5}});
  e.begin();
  const Budget before = budget(bodies);
  const double energy = mechanical_energy(e);
  for (int k = 0; k < 20000 && !e.touching(); ++k) e.advance(1);
  ASSERT_TRUE(e.touching());
  e.advance(3000);
  const Budget after = budget(bodies);
  report::error(
      fmt::format("two lattice balls of {} spheres: momentum after their blow, over the sum of |p|", count),
      "conserved", momentum_drift(before, after), 1e-13);
  report::error("their angular momentum, over the sum of magnitudes", "conserved",
                angular_drift(before, after), 1e-12);
  report::close("their energy: kinetic, springs and dissipated, J", "before",
                mechanical_energy(e) + e.state.ledger.dissipated, energy, 2e-3);
  report::note(
      "Bodies of thousands of spheres behave as others do; each shape of them costs half a second at the "
      "start. Only spheres near the surface ever touch: leave the inner ones out and give the density "
      "instead.");
}

TEST(ExtremeContacts, ASphereStruckBySixtyAtOnce) {
  constexpr int count = 60;
  constexpr double small = 0.2;
  std::string content = body({.position = {0, 0, 0}});
  for (int k = 0; k < count; ++k) {  // a Fibonacci spiral
    const double z = 1.0 - (2 * k + 1.0) / count, a = kPi * (3.0 - std::sqrt(5.0)) * k;
    const Vec3 n(std::sqrt(1.0 - z * z) * std::cos(a), std::sqrt(1.0 - z * z) * std::sin(a), z);
    content += body({.size = small, .position = 1.2004 * n, .velocity = -0.05 * n});
  }
  for (const double steps : {50.0, 200.0}) {
    Experiment e(scene_text({}, fmt::format("stiffness = 1e6\nsteps_per_contact = {}", steps), "", content));
    e.begin();
    const double energy = mechanical_energy(e);
    const Budget before = budget(e.state.bodies);
    std::size_t most = 0;
    while (most == 0 || e.touching()) {
      e.advance(1);
      most = std::max(most, e.state.contacts.records().size());
      ASSERT_LT(e.state.clock.step, 100000u);
    }
    const Budget after = budget(e.state.bodies);
    EXPECT_EQ(most, 60u);
    report::close(
        fmt::format("sixty elastic contacts of one sphere, {} steps per contact: energy after, J", steps),
        "before", mechanical_energy(e), energy, steps > 100.0 ? 2e-5 : 3e-4);
    report::error("the same: momentum, over the sum of |p|", "conserved", momentum_drift(before, after),
                  1e-13);
  }
  report::note("The number of contacts of a sphere has no limit, and needs nothing of the user.");
}

/// Some mixed bodies that fall on a floor and on each other under their own gravity and a field, all parts of
/// the law on; lengths `scale` times as large. With densities falling as 1 / scale^2 velocities stay the same
/// and times grow with the lengths.
Stage heap(double scale) {
  Stage e(
      scene_text({.restitution = 0.5, .friction = 0.7, .rolling = 0.5, .twisting = 0.6, .cohesion = 100.0},
                 "max_overlap = 0.0625\noverlap_limit = 0.5", "method = 'direct'", body({}) + wall()));
  e.scene.materials[0].cohesion /= scale * scale;
  e.scene.gravity.field = {0.0, 0.0, -2.0 / scale};
  e.scene.stages[0].duration *= scale;
  int k = 0;
  for (const char* name : {"tetrahedron", "sphere", "cube", "dumbbell", "diamond", "sphere"}) {
    const RigidShape shape = make_rigid(load_shape(name, "."), MassModel::union_volume);
    const double level = 3.0 + 5.0 * k++;
    add_body(e.state.bodies, shape, static_cast<std::uint32_t>(k), scale, 2e3 / (scale * scale), 0,
             {.position = scale * Vec3(0.3 * (k % 3), 0.2 * (k % 2), level),
              .orientation = Quat(0.5, 0.5, -0.5, 0.5),
              .velocity = {0.1 * (k % 2), 0.05, -1.0},
              .angular_velocity = Vec3(0.1, 0.2, -0.1) / scale});
  }
  e.begin();
  return e;
}

TEST(ExtremeScales, MicronsAndThousandsOfKilometresAreTheSameScene) {
  const Stage home = [] {
    Stage e = heap(1.0);
    e.advance(static_cast<std::uint64_t>(14.0 / e.physics.contacts.dt));

    return e;
  }();
  ASSERT_GT(home.state.contacts.records().size() + home.state.walls.contacts.size(), 5u);
  for (const int power : {-20, 20}) {  // powers of two: every product scales without rounding
    const double scale = std::ldexp(1.0, power);
    Stage e = heap(scale);
    e.advance(home.state.clock.step);
    double worst = 0.0;
    for (std::size_t b = 0; b < e.state.bodies.size(); ++b) {
      worst = std::max(
          worst, (e.state.bodies.position[b] / scale - home.state.bodies.position[b]).cwiseAbs().maxCoeff());
      worst =
          std::max(worst, (e.state.bodies.velocity[b] - home.state.bodies.velocity[b]).cwiseAbs().maxCoeff());
    }
    report::error(fmt::format("a heap of bodies of {:.3g} m, places over size and "
                              "velocities in m/s, against one of bodies of 1 m",
                              scale),
                  "the same numbers", worst, 0.0);
  }
  for (const double size : {1e-6, 1e6}) {
    const Vec3 apart(0.0, 0.0, 2.001 * size), velocity(0.0, 0.0, -0.01);
    Experiment e(
        scene_text({.restitution = 0.55}, "", "",
                   body({.size = size}) + body({.size = size, .position = apart, .velocity = velocity})));
    e.begin();
    pass_blow(e);
    report::close(
        fmt::format("two spheres of {} m at 1 cm/s, stiffness chosen by the program: restitution", size),
        "value asked for", (e.state.bodies.velocity[1] - e.state.bodies.velocity[0]).z() / 0.01, 0.55, 0.005);
  }
  report::note(
      "Lengths from microns to thousands of kilometres run alike, bit for bit where the scale is a power of "
      "two: no length, mass or time is built in.");
}

}  // namespace
}  // namespace cairn
