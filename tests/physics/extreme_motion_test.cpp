// Motion and contacts at the edge of what is sensible: spins of a turn in twenty steps, blows far harder than
// the stiffness was made for, steps from much too short to much too long, restitution and cohesion at their
// ends.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "physics/report.h"
#include "physics/scenes.h"
#include "shape/library.h"
#include "sim/warnings.h"

namespace cairn {
namespace {

/// The message of what `act` throws; empty when it does not.
template <class Error, class Act>
std::string complaint(Act&& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(ExtremeMotion, ATurnInTwentySteps) {
  for (const std::string shape : {"sphere", "tetrahedron", "dumbbell", "rod4", "diamond", "needle"}) {
    Experiment e(scene_text({}, "stiffness = 1e6", "", body({.shape = shape})));
    e.begin();
    Bodies& bodies = e.state.bodies;
    bodies.spin[0] = bodies.orientation[0] * Vec3(0.8, 0.36, 0.48);
    bodies.spin[0] *= 2.0 * kPi / (20.0 * e.physics.contacts.dt * angular_velocity(bodies, 0).norm());
    const Vec3 spin = bodies.spin[0];
    const double energy = e.kinetic_energy();
    double worst = 0.0;
    for (int k = 0; k < 5000; ++k) {
      e.advance(10);
      worst = std::max(worst, std::abs(e.kinetic_energy() / energy - 1.0));
    }
    report::error(
        fmt::format("{}, one turn in 20 steps, 5e4 steps: rotational energy, worst, relative", shape),
        "conserved", worst, 1e-3);
    EXPECT_EQ((bodies.spin[0] - spin).norm(), 0.0);
    EXPECT_NEAR(bodies.orientation[0].norm(), 1.0, 1e-14);
    const auto said = warnings(e.physics, bodies, {});
    ASSERT_FALSE(said.empty()) << shape;
    EXPECT_NE(said.back().find("rad in a step"), std::string::npos) << said.back();
  }
  report::note(
      "Spins of a turn in 20 steps: angular momentum is exact and the energy error stays bounded, but the "
      "attitude is no longer accurate; the program warns beyond 0.3 rad a step. Take a shorter time_step.");
}

/// Two spheres that meet centrally at `times` the speed the stiffness was made for.
Experiment hard_blow(double times, double overlap_limit) {
  Experiment e(scene_text(
      {.restitution = 0.55}, fmt::format("overlap_limit = {}", overlap_limit), "",
      body({.position = {0, 0, 1.1}, .velocity = {0, 0, -0.01 * times}}) + body({.position = {0, 0, -1}})));
  e.scene.stages[0].impact_speed = 0.01;
  e.begin();
  return e;
}

TEST(ExtremeMotion, BlowsHarderThanTheStiffnessWasMadeFor) {
  for (const double times : {1.0, 10.0, 100.0}) {
    Experiment e = hard_blow(times, 1.0);
    while (!e.touching()) e.advance(1);
    while (e.touching()) e.advance(1);
    report::close(
        fmt::format("a blow {} times faster than impact_speed, overlap_limit 1: restitution", times),
        "value asked for", (e.state.bodies.velocity[0] - e.state.bodies.velocity[1]).z() / (0.01 * times),
        0.55, 0.005);
    report::within("its largest overlap, over the radius", "in proportion to the speed",
                   e.state.ledger.largest_overlap / times, 0.003, 0.01);
  }
  Experiment e = hard_blow(100.0, 0.1);
  const auto said = warnings(e.physics, e.state.bodies, {});
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("raise impact_speed or stiffness"), std::string::npos) << said[0];
  const std::string stopped = complaint<UnstableError>([&] { e.advance(1000000); });
  EXPECT_NE(stopped.find("raise the stiffness"), std::string::npos) << stopped;
  for (const Vec3& v : e.state.bodies.velocity) EXPECT_TRUE(v.allFinite());
  report::note(
      "Blows 100 times faster than impact_speed: the linear law still gives the restitution asked for, but "
      "spheres sink into each other by up to a radius. The program warns at the start when the bodies' "
      "speeds ask for more than overlap_limit, and stops the run when it is passed, naming the keys to "
      "change.");
}

/// Spheres on a face-centred cubic lattice in a periodic box, pressed together a little, that jostle: twelve
/// contacts each. Energies are counted above those of the lattice at rest.
struct Crystal : Stage {
  double at_rest = 0.0;

  Crystal(const Surface& surface, double steps_per_contact, double jostle)
      : Stage("[box]\nsize = [11.3, 11.3, 11.3]\n" +
              scene_text(surface,
                         fmt::format("stiffness = 1e6\noverlap_limit = 0.5\nunsafe_time_step = true\n"
                                     "steps_per_contact = {}",
                                     std::max(10.0, steps_per_contact)),
                         "", body({}), 1e3)) {
    const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
    const double edge = state.box.edge[0], half = edge / 8.0;
    Random random(11, 0);
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y)
        for (int z = 0; z < 8; ++z)
          if ((x + y + z) % 2 == 0)
            add_body(state.bodies, ball, 0, 1.0, 2000.0, 0, {.position = half * Vec3(x, y, z)});
    begin();
    at_rest = spring_energy();
    scene.contact.time_step = physics.contact_time / steps_per_contact;
    for (Vec3& v : state.bodies.velocity) v = jostle * random.in_ball();
    begin();
  }
  /// What is neither there nor known to be lost, over the kinetic energy at the start; infinite after the run
  /// has been stopped as unstable.
  double worst_error(double contact_times) {
    const double start = kinetic_energy();
    const auto steps = static_cast<std::uint64_t>(contact_times * physics.contact_time / physics.contacts.dt);
    double worst = 0.0;
    try {
      for (std::uint64_t k = 0; k < steps; ++k) {
        advance(1);
        worst = std::max(
            worst,
            std::abs(kinetic_energy() + spring_energy() - at_rest + state.ledger.dissipated - start) / start);
      }
    } catch (const UnstableError&) {
      return 1e3;
    }
    return worst;
  }
};

TEST(ExtremeMotion, StepsFromMuchTooShortToMuchTooLong) {
  const Surface smooth{}, rough{.restitution = 0.9, .friction = 0.5, .rolling = 0.5, .twisting = 0.5};
  report::Curve elastic{"elastic, smooth", {}, {}}, all{"every part of the law", {}, {}};
  for (const double steps : {200.0, 100.0, 50.0, 30.0, 20.0, 14.0, 10.0, 7.0, 5.0, 4.0, 3.0}) {
    elastic.x.push_back(steps);
    elastic.y.push_back(std::min(1e3, Crystal(smooth, steps, 0.01).worst_error(100.0)));
    all.x.push_back(steps);
    all.y.push_back(std::min(1e3, Crystal(rough, steps, 0.01).worst_error(20.0)));
  }
  for (const report::Curve& curve : {elastic, all}) {
    report::error(curve.label +
                      ", twelve contacts a sphere, 50 steps per contact: energy gone astray, worst "
                      "moment, over the kinetic energy",
                  "conserved with what is dissipated", curve.y[2], 0.02);
    report::error(curve.label + ", 10 steps per contact, the longest step that is not refused: the same",
                  "bounded", curve.y[6], 0.5);
  }
  report::plot("long-steps",
               "Energy gone astray in a crystal of spheres with twelve contacts each (1000: stopped).",
               {"steps per contact", "error / kinetic energy", true, true}, {elastic, all});
  const std::string refused = complaint<InputError>([] {
    Experiment e(scene_text({}, "stiffness = 1e6\ntime_step = 0.1", "", body({}) + wall()));
    e.begin();
  });
  EXPECT_NE(refused.find("the longest safe one is"), std::string::npos) << refused;
  report::note(
      "Steps longer than a tenth of the shortest contact are refused (unsafe_time_step forces them): a "
      "sphere with twelve contacts is held by stiffer modes than one contact, and breaks the run at 3 to 5 "
      "steps per contact.");
}

TEST(ExtremeMotion, RestitutionToItsEnds) {
  for (const double asked : {0.0, 1e-6, 1e-3, 0.01, 1.0}) {
    Experiment e(scene_text(
        {.restitution = asked}, "stiffness = 1e6", "",
        body({.position = {0, 0, 1.0003}, .velocity = {0, 0, -0.01}}) + body({.position = {0, 0, -1}})));
    e.begin();
    const double energy = mechanical_energy(e);
    while (!e.touching()) e.advance(1);
    for (int k = 0; k < 2000 && e.touching(); ++k) e.advance(1);
    report::near(fmt::format("two spheres, e = {}: speed after over before", asked), "value asked for",
                 (e.state.bodies.velocity[0] - e.state.bodies.velocity[1]).z() / 0.01, asked, 0.01);
    report::error("energy gone astray over that before", "conserved with what is dissipated",
                  std::abs(mechanical_energy(e) + e.state.ledger.dissipated - energy) / energy, 0.02);
  }
  report::note(
      "Restitution 0 is the critically damped contact: bodies stay in touch and creep apart for ever. 0.05 "
      "to 0.1 settles a pile just as fast.");
}

TEST(ExtremeMotion, WallsThatNoStepCanFollow) {
  const auto said = [](const std::string& motion) {
    Experiment e(scene_text({}, "stiffness = 1e6", "", body({.position = {0, 0, 1}}) + wall() + motion));
    e.begin();
    const auto all = warnings(e.physics, e.state.bodies, e.state.walls);
    return fmt::format("{}", fmt::join(all, "\n"));
  };
  EXPECT_EQ(
      said("velocity = [0, 0, 0.01]\noscillation_amplitude = [0, 0, 1e-3]\noscillation_frequency = 1\n"), "");
  const std::string swing = said("oscillation_amplitude = [0, 0, 1e-9]\noscillation_frequency = 1e6\n");
  EXPECT_NE(swing.find("wall 0 (plane, stage.toml:27) oscillates by"), std::string::npos) << swing;
  EXPECT_NE(swing.find("take a time_step of at most 4.8e-08 s"), std::string::npos) << swing;
  const std::string turn = said("angular_velocity = [0, 0, 1000]\n");
  EXPECT_NE(turn.find("wall 0 (plane, stage.toml:27) turns by"), std::string::npos) << turn;
  const std::string fast = said("velocity = [0, 0, 3e4]\n");
  EXPECT_NE(fast.find("bodies and walls that meet at 3e+04 m/s would overlap"), std::string::npos) << fast;
  EXPECT_NE(fast.find("bodies and walls move by"), std::string::npos) << fast;
  report::note(
      "Walls that swing or turn by more than 0.3 rad in a step, or move by half a radius, are warned of with "
      "the "
      "longest time_step that would follow them: their path is exact at every step but not seen between.");
}

TEST(ExtremeMotion, CohesionBeyondTheStiffness) {
  const auto refused = [](double cohesion, const std::string& content) {
    return complaint<InputError>([&] {
      Experiment e(scene_text({.cohesion = cohesion}, "stiffness = 1e6", "", content));
      e.begin();
    });
  };
  const std::string pair = body({.position = {0, 0, 1}}) + body({.position = {0, 0, -1}});
  // c (2 beta R)^2 / k: 0.25 c / 1e6 between two unit spheres, 1e-6 c on a wall.
  EXPECT_EQ(refused(3.9e5, pair), "");
  const std::string said = refused(4.1e5, pair);
  EXPECT_NE(said.find("cohesion"), std::string::npos) << said;
  EXPECT_NE(said.find("contact.stiffness of at least 1.02e+06 N/m"), std::string::npos) << said;
  EXPECT_EQ(refused(0.9e5, wall() + body({.position = {0, 0, 1}})), "");
  EXPECT_NE(refused(1.1e5, wall() + body({.position = {0, 0, 1}})), "");
  // Chosen by the program, the stiffness holds the bodies apart at the overlap aimed at.
  Experiment e(scene_text({.restitution = 0.1, .cohesion = 1e9}, "", "",
                          body({.position = {0, 0, 0.9999}}) + body({.position = {0, 0, -1}})));
  e.begin();
  e.advance(5000);
  report::close("two spheres at a cohesion of 1 GPa, stiffness chosen by the program: overlap at rest, m",
                "max_overlap", 2.0 - (e.state.bodies.position[0] - e.state.bodies.position[1]).norm(), 0.01,
                1e-6);
  report::note(
      "Cohesion that presses spheres together by more than overlap_limit at the stiffness given is refused "
      "with the least stiffness that would do; the stiffness chosen by the program always suffices.");
}

}  // namespace
}  // namespace cairn
