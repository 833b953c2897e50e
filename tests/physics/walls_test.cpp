// Walls of every kind against closed forms: blows, rest, rolling, and the motion of the wall.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>

#include "contact/law/pair.h"
#include "core/error.h"
#include "folder.h"
#include "grid_mesh.h"
#include "physics/experiment.h"
#include "physics/report.h"

namespace cairn {
namespace {

constexpr double kGravity = 10.0;  // m/s^2

struct Kind {
  const char* name;
  std::string wall;  // its surface passes through the origin, with the normal z there
};

/// Every kind of wall, and every kind of feature of a mesh.
std::vector<Kind> kinds(const Folder& folder) {
  const std::string square = "v -8 -9 0\nv 9 -9 0\nv 9 8 0\nv -8 8 0\n";
  const auto mesh = [&](const char* name, const std::string& text) {
    return fmt::format("kind = 'mesh'\nfile = \"{}\"\n", folder.write(name, text));
  };
  return {{"plane", "kind = 'plane'\n"},
          {"inside a sphere", "kind = 'sphere'\npoint = [0, 0, 5]\nradius = 5\n"},
          {"outside a sphere", "kind = 'sphere'\npoint = [0, 0, -5]\nradius = 5\nside = 'outside'\n"},
          {"inside a cylinder", "kind = 'cylinder'\npoint = [3, 0, 5]\naxis = [1, 0, 0]\nradius = 5\n"},
          {"outside a cylinder",
           "kind = 'cylinder'\npoint = [0, 0, -5]\naxis = [0, 1, 0]\nradius = 5\nside = 'outside'\n"},
          {"face of a mesh", mesh("face.obj", square + "f 1 2 3\nf 1 3 4\n")},
          {"edge of a mesh", mesh("edge.obj", "v 0 -9 0\nv 0 8 0\nv 7 0 -7\nv -7 0 -7\nf 1 3 2\nf 1 2 4\n")},
          {"vertex of a mesh",
           mesh("tip.obj", "v 0 0 0\nv 7 -6 -7\nv 7 6 -7\nv -8 0 -7\nf 1 2 3\nf 1 3 4\nf 1 4 2\n")}};
}

std::string scene(const std::string& material, const std::string& rest, double stiffness = 1e8) {
  return fmt::format(R"(
[gravity]
method = "none"
field = [0, 0, {}]
[contact]
stiffness = {}
[[material]]
name = "surface"
{}
[[stage]]
name = "only"
duration = 1e3
{}
)",
                     -kGravity, stiffness, material, rest);
}

const char* const kSmooth = "friction = 0\nfriction_rolling = 0\nfriction_twisting = 0\n";

std::string ball(double radius, const std::string& place) {
  return fmt::format("[[body]]\nshape = 'sphere'\nsize = {}\ndensity = 1000\n{}\n", radius, place);
}

double weight(const Experiment& e) {
  return e.state.bodies.mass[0] * kGravity;
}

/// A sphere resting on a level wall below it sinks in by its weight over the stiffness.
double rest_height(double radius, double density, double stiffness) {
  return radius - density * 4.0 / 3.0 * kPi * std::pow(radius, 3) * kGravity / stiffness;
}

TEST(Walls, EveryKindGivesTheRestitutionAskedFor) {
  const Folder folder;
  for (const Kind& kind : kinds(folder)) {
    double worst = 0.0;
    constexpr int phases = 8;
    for (int phase = 0; phase < phases; ++phase) {
      Experiment e(
          scene(std::string(kSmooth) + "restitution_normal = 0.55\n",
                ball(1.0, "position = [0, 0, 1.001]\nvelocity = [0, 0, -0.1]") + "[[wall]]\n" + kind.wall));
      e.scene.gravity.field.setZero();
      e.begin();
      e.state.bodies.position[0].z() = 1.0 + 0.1 * e.physics.contacts.dt * (1.0 + (phase + 0.5) / phases);
      e.begin();
      while (!e.touching()) e.advance(1);
      while (e.touching()) e.advance(1);
      worst = std::max(worst, std::abs(e.state.bodies.velocity[0].z() / 0.1 - 0.55));
      EXPECT_LT(e.state.bodies.velocity[0].head<2>().norm(), 1e-12);
    }
    report::error(fmt::format("{}: restitution 0.55, worst of {} phases, relative", kind.name, phases),
                  "value asked for", worst / 0.55, 0.005);
  }
}

TEST(Walls, AMovingPlaneStrikesASphereAndItsWorkIsKnown) {
  constexpr double speed = 0.1, asked = 0.55;
  constexpr int phases = 8;
  double worst = 0.0, astray = 0.0;
  for (int phase = 0; phase < phases; ++phase) {
    Experiment e(scene(std::string(kSmooth) + "restitution_normal = 0.55\n",
                       ball(1.0, "position = [0, 0, 1.001]") +
                           fmt::format("[[wall]]\nkind = 'plane'\nvelocity = [0, 0, {}]\n", speed)));
    e.scene.gravity.field.setZero();
    e.begin();
    e.state.bodies.position[0].z() = 1.0 + speed * e.physics.contacts.dt * (1.0 + (phase + 0.5) / phases);
    e.begin();
    while (!e.touching()) e.advance(1);
    while (e.touching()) e.advance(1);
    const Ledger& ledger = e.state.ledger;
    worst = std::max(
        worst, std::abs(ledger.wall_work / (e.state.bodies.mass[0] * (1.0 + asked) * speed * speed) - 1.0));
    astray = std::max(astray,
                      std::abs(ledger.wall_work - e.kinetic_energy() - ledger.dissipated) / ledger.wall_work);
  }
  report::error("plane that strikes a sphere at rest, e = 0.55: its work, worst of 8 phases, relative",
                "m (1 + e) V^2", worst, 2e-3);
  report::error("the same: what of its work is neither kinetic energy nor dissipated, worst, relative",
                "energy gained and lost", astray, 1e-3);
}

TEST(Walls, EveryKindCarriesASphereAtRest) {
  const Folder folder;
  for (const Kind& kind : kinds(folder)) {
    Experiment e(
        scene("restitution_normal = 0.3\n", ball(1.0, "position = [0, 0, 1]") + "[[wall]]\n" + kind.wall));
    e.begin();
    e.advance(4000);
    const double sinks = weight(e) / e.physics.k_n;
    report::close(kind.name + std::string(": depth at rest (m)"), "weight over stiffness",
                  1.0 - e.state.bodies.position[0].z(), sinks, 1e-6);
    EXPECT_LT(e.state.bodies.velocity[0].norm(), 1e-9);
    EXPECT_EQ(e.state.walls.contacts.size(), 1u);
    const double falls = weight(e) * (1.0 - e.state.bodies.position[0].z());
    report::close(kind.name + std::string(": energy lost and stored on the way (J)"), "fall of the weight",
                  e.state.ledger.dissipated + e.spring_energy(), falls, 2e-3);
  }
}

TEST(Walls, ASphereBeyondTheWallIsRefused) {
  const Folder folder;
  for (const Kind& kind : kinds(folder)) {
    if (std::string(kind.name).ends_with("mesh")) continue;  // both sides of a mesh hold spheres
    Experiment e(scene("", ball(1.0, "position = [0, 0, -2.5]") + "[[wall]]\n" + kind.wall));
    try {
      e.begin();
      ADD_FAILURE() << kind.name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("sphere 0 of body 0 and wall 0 ("), std::string::npos)
          << error.what();
    }
  }
  Experiment e(scene("", ball(1.0, "position = [0, 0, 0]") + "[[wall]]\n" + kinds(folder)[5].wall));
  EXPECT_THROW(e.begin(), InputError);  // centre on the mesh
}

/// A floor of triangles of many sizes, its plane through the origin along two unit vectors.
TriangleMesh floor_of_triangles(std::uint32_t cells, const Vec3& along, const Vec3& across) {
  return grid_mesh(cells, [&](double u, double v) -> Vec3 {
    const double x = 24.0 * u - 12.0, y = 24.0 * v - 12.0;
    return (x + 0.2 * std::sin(3 * y)) * along + (y + 0.2 * std::cos(5 * x)) * across;
  });
}

TEST(Walls, FromTriangleToTriangleIsLikeAPlane) {
  for (const double tilt : {0.0, 0.2}) {
    const Vec3 normal = Vec3(-std::sin(tilt), 0, std::cos(tilt)),
               along = Vec3(std::cos(tilt), 0, std::sin(tilt));
    for (const auto& [shape, size] : {std::pair{"sphere", 0.5}, {"tetrahedron", 0.4}}) {
      const std::string text = scene(
          "friction = 0.4\nfriction_rolling = 0.05\nfriction_twisting = 0.1\nrestitution_normal = 0.5\n",
          fmt::format(
              "[[body]]\nshape = '{}'\nsize = {}\ndensity = 1000\nposition = [-2, 0.3, 0.9]\n"
              "velocity = [2.5, 0.9, 0]\nangular_velocity = [0, 1, 3]\norientation = [0.9, 0.1, 0.3, 0.1]\n"
              "[[wall]]\nkind = 'plane'\nnormal = [{:.17g}, 0, {:.17g}]\n",
              shape, size, normal.x(), normal.z()),
          1e7);
      Experiment plane(text), mesh(text);
      mesh.state.walls.walls[0].surface =
          std::make_shared<const MeshSurface>(floor_of_triangles(60, along, Vec3::UnitY()));
      plane.begin();
      mesh.begin();
      double apart = 0.0;
      std::size_t features = 0, touching = 0;
      std::uint32_t last = 0;
      const int steps = static_cast<int>(3.0 / plane.physics.contacts.dt);
      for (int k = 0; k < steps; ++k) {
        plane.advance(1);
        mesh.advance(1);
        apart = std::max(apart, (plane.state.bodies.position[0] - mesh.state.bodies.position[0]).norm());
        ASSERT_EQ(plane.state.walls.contacts.size(), mesh.state.walls.contacts.size()) << k;
        if (mesh.state.walls.contacts.empty()) continue;
        ++touching;
        features += mesh.state.walls.contacts[0].feature != last;
        last = mesh.state.walls.contacts[0].feature;
      }
      EXPECT_GT(features, 8u);
      report::error(
          fmt::format("{} over {} triangles of a floor tilted by {} rad, {} steps in touch: greatest "
                      "distance from the path on the plane (m)",
                      shape, features, tilt, touching),
          "plane", apart, 1e-9);
      EXPECT_LT(mesh.scratch.wall_candidates.renewals(), static_cast<std::size_t>(steps) / 20);
    }
  }
}

TEST(Walls, ASphereRollsInACylinderAtTheFrequencyOfTheClosedForm) {
  constexpr double radius = 0.5, drum = 5.0, angle = 0.02;
  const double height = drum - (drum - rest_height(radius, 1000, 1e8)) * std::cos(angle);
  Experiment e(scene("friction_rolling = 0\nfriction_twisting = 0\n",
                     ball(radius, fmt::format("position = [{:.17g}, 0, {:.17g}]",
                                              (drum - radius) * std::sin(angle), height)) +
                         "[[wall]]\nkind = 'cylinder'\naxis = [0, 1, 0]\nradius = 5\npoint = [0, 0, 5]\n"));
  e.begin();
  std::vector<double> crossings;
  for (double before = 1.0; crossings.size() < 5;) {
    e.advance(1);
    const double x = e.state.bodies.position[0].x();
    if ((before > 0.0) != (x > 0.0))
      crossings.push_back(e.state.clock.time() - e.physics.contacts.dt * x / (x - before));
    before = x;
  }
  const double omega = 2.0 * kPi / (0.5 * (crossings[4] - crossings[0]));
  report::close("sphere rolling inside a cylinder, small swings: angular frequency (rad/s)",
                "sqrt((5/7) g / (R - r))", omega, std::sqrt(5.0 / 7.0 * kGravity / (drum - radius)), 1e-3);
}

TEST(Walls, AnOscillatingPlaneDrivesASphereWithThePhaseOfTheOscillator) {
  constexpr double frequency = 6.0, amplitude = 1e-3, stiffness = 1e7;
  Experiment e(scene("restitution_normal = 0.55\n",
                     ball(1.0, fmt::format("position = [0, 0, {:.17g}]", rest_height(1.0, 1000, stiffness))) +
                         fmt::format("[[wall]]\nkind = 'plane'\noscillation_amplitude = [0, 0, {}]\n"
                                     "oscillation_frequency = {}\n",
                                     amplitude, frequency),
                     stiffness));
  constexpr int per_period = 1000;
  e.scene.stages[0].duration = 30 / frequency;
  e.scene.stages[0].time_step = 1.0 / (frequency * per_period);
  e.begin();
  e.advance(20 * per_period);
  std::complex<double> response = 0.0;
  const double omega = 2.0 * kPi * frequency;
  for (int k = 0; k < 10 * per_period; ++k) {
    e.advance(1);
    ASSERT_TRUE(e.touching());
    const double z = e.state.bodies.position[0].z() - rest_height(1.0, 1000, stiffness);
    response += z * std::polar(1.0, -omega * e.state.clock.time());
  }
  response *= std::complex<double>(0.0, 2.0 / (10 * per_period));  // sin is -i/2 e^(i w t) + ...
  const double mass = e.state.bodies.mass[0], damping = damping_ratio(0.55) * std::sqrt(stiffness * mass);
  const std::complex<double> drive(stiffness, omega * damping),
      closed = amplitude * drive / (drive - mass * omega * omega);
  report::close("sphere on an oscillating plane: amplitude (m)", "driven oscillator", std::abs(response),
                std::abs(closed), 1e-3);
  report::near("sphere on an oscillating plane: phase behind the plane (rad)", "driven oscillator",
               -std::arg(response), -std::arg(closed), 1e-3);
}

TEST(Walls, AConveyorCarriesASphereToTwoSeventhsOfItsSpeed) {
  constexpr double speed = 2.0, friction = 0.2;
  const auto rides = [&](const std::string& shape, double size, double z) {
    return Experiment(
        scene(fmt::format("friction = {}\nfriction_rolling = 0\nfriction_twisting = 0\n", friction),
              fmt::format("[[body]]\nshape = '{}'\nsize = {}\ndensity = 1000\nposition = [0, 0, {:.17g}]\n"
                          "[[wall]]\nkind = 'plane'\nvelocity = [{}, 0, 0]\n",
                          shape, size, z, speed)));
  };
  Experiment e = rides("sphere", 1.0, rest_height(1.0, 1000, 1e8));
  e.begin();
  const auto until = [](Experiment& run, double time) {
    while (run.state.clock.time() < time) run.advance(1);
  };
  until(e, 0.2);
  report::close("sphere sliding on a conveyor: speed after 0.2 s (m/s)", "mu g t",
                e.state.bodies.velocity[0].x(), friction * kGravity * e.state.clock.time(), 5e-3);
  until(e, 1.0);
  report::close("sphere rolling on a conveyor: speed (m/s)", "(2/7) of the conveyor's",
                e.state.bodies.velocity[0].x(), 2.0 / 7.0 * speed, 1e-3);
  report::close("sphere rolling on a conveyor: surface speed of its spin (m/s)", "(5/7) of the conveyor's",
                -angular_velocity(e.state.bodies, 0).y(), 5.0 / 7.0 * speed, 1e-3);

  Experiment slab = rides("slab", 1.0, 1.0);
  double low = 0.0;
  for (std::size_t s = 0; s < slab.state.bodies.spheres.size(); ++s)
    low = std::min(low, slab.state.bodies.spheres.position[s].z() - slab.state.bodies.spheres.radius[s]);
  slab.state.bodies.position[0].z() -= low;
  place_spheres(slab.state.bodies);
  slab.begin();
  until(slab, 0.5);
  report::close("slab sliding on a conveyor: speed after 0.5 s (m/s)", "mu g t",
                slab.state.bodies.velocity[0].x(), friction * kGravity * slab.state.clock.time(), 1e-2);
  until(slab, 2.0);
  report::close("slab riding a conveyor: speed (m/s)", "the conveyor's", slab.state.bodies.velocity[0].x(),
                speed, 1e-3);
}

TEST(Walls, ADrumSpinsASphereUp) {
  constexpr double drum = 5.0, radius = 0.5, turn = 0.5, friction = 0.02;
  Experiment e(
      scene(fmt::format("friction = {}\nfriction_rolling = 0\nfriction_twisting = 0\n", friction),
            ball(radius, fmt::format("position = [0, 0, {:.17g}]", rest_height(radius, 1000, 1e8))) +
                fmt::format("[[wall]]\nkind = 'cylinder'\naxis = [0, 1, 0]\nradius = 5\npoint = [0, 7, 5]\n"
                            "angular_velocity = [0, {}, 0]\n",
                            turn)));
  e.begin();
  const auto spin = [&] { return angular_velocity(e.state.bodies, 0).y(); };
  while (e.state.clock.time() < 3.0) e.advance(1);
  report::close("sphere sliding in a turning drum: spin after 3 s (rad/s)", "(5/2) mu g t / r", spin(),
                2.5 * friction * kGravity * e.state.clock.time() / radius, 2e-3);
  while (e.state.clock.time() < 6.0) e.advance(1);
  const double swing = 2.0 * kPi / std::sqrt(5.0 / 7.0 * kGravity / (drum - radius));
  double mean = 0.0;
  const int steps = static_cast<int>(2.0 * swing / e.physics.contacts.dt);
  for (int k = 0; k < steps; ++k) {
    e.advance(1);
    mean += spin() / steps;
  }
  report::close("sphere rolling in a turning drum: mean spin over two swings (rad/s)", "Omega R / r", mean,
                turn * drum / radius, 1e-3);
  report::close("turning drum: its work (J)", "kinetic and potential energy gained, and lost",
                e.state.ledger.wall_work,
                e.kinetic_energy() + e.spring_energy() + e.state.ledger.dissipated +
                    weight(e) * (e.state.bodies.position[0].z() - radius),
                1e-3);
}

/// Energies (J) of eight grains in a closed box of triangles that is shaken and turned for 2 s.
struct Shaken {
  double gained, lost, work;
};
Shaken shaken(const std::string& material, double steps_per_contact) {
  const Folder folder;
  const std::string box =
      folder.write("box.off",
                   "OFF\n8 6 0\n-5 -5 -5\n5 -5 -5\n-5 5 -5\n5 5 -5\n-5 -5 5\n5 -5 5\n-5 5 5\n5 5 5\n"
                   "4 0 1 3 2\n4 4 5 7 6\n4 0 1 5 4\n4 2 3 7 6\n4 0 2 6 4\n4 1 3 7 5\n");
  constexpr std::array shapes{"tetrahedron", "sphere", "rod4"};
  std::string bodies;
  std::size_t k = 0;
  for (const double x : {-2.2, 2.2})
    for (const double y : {-2.2, 2.2})
      for (const double z : {-2.5, 2.0}) {
        bodies += fmt::format(
            "[[body]]\nshape = '{}'\nsize = {}\ndensity = 2000\nposition = [{}, {}, {}]\n"
            "velocity = [{}, {}, 0]\n",
            shapes[k % 3], k % 3 == 1 ? 1.0 : 0.7, x, y, z, -0.2 * x, 0.3 * z);
        ++k;
      }
  Experiment e(scene(
      material,
      bodies + fmt::format("[[wall]]\nkind = 'mesh'\nfile = \"{}\"\noscillation_amplitude = [0.1, 0, 0.2]\n"
                           "oscillation_frequency = 0.7\noscillation_phase = 0.5\n"
                           "angular_velocity = [0.3, 0.8, 0.1]\n",
                           box),
      4e8));
  e.scene.contact.steps_per_contact = steps_per_contact;
  e.begin();
  const auto energy = [&] {
    double sum = e.kinetic_energy() + e.spring_energy();
    for (std::size_t b = 0; b < e.state.bodies.size(); ++b)
      sum += e.state.bodies.mass[b] * kGravity * e.state.bodies.position[b].z();
    return sum;
  };
  const double start = energy();
  while (e.state.clock.time() < 2.0) e.advance(1);
  return {energy() - start, e.state.ledger.dissipated, e.state.ledger.wall_work};
}

TEST(Walls, WorkOfAShakenAndTurnedBoxIsFoundInItsGrains) {
  const Shaken elastic = shaken(std::string(kSmooth) + "restitution_normal = 1\n", 50);
  EXPECT_EQ(elastic.lost, 0.0);
  report::close("shaken and turned box of elastic, frictionless aggregates: work of the walls (J)",
                "energy gained", elastic.work, elastic.gained, 1e-4);
  const std::vector<double> steps{25, 50, 100, 200};
  std::vector<double> errors;
  for (const double n : steps) {
    const Shaken rough = shaken("friction = 0.5\n", n);
    errors.push_back(std::abs(rough.gained + rough.lost - rough.work) / rough.lost);
  }
  report::error(
      "the same with all resistances, 50 steps per contact: energy not accounted for, over the energy lost",
      "energy gained and lost", errors[1], 1e-3);
  report::near("order of that error, 25 to 200 steps per contact", "second order",
               -std::log(errors.back() / errors.front()) / std::log(steps.back() / steps.front()), 2.0, 0.3);
}

}  // namespace
}  // namespace cairn
