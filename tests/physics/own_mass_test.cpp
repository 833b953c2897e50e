// Bodies whose shape files say how their mass is spread: a lamina, loaded dumbbells, a roly-poly.
#include <gtest/gtest.h>

#include <cmath>

#include "folder.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

/// One body of a shape file's text in a scene of one stage, at its file's axes.
Experiment one_body(const Folder& folder, const std::string& shape, const std::string& body,
                    const std::string& contact, const std::string& gravity, const std::string& content = {}) {
  const std::string path = folder.write("grain.toml", shape);
  return Experiment(
      scene_text({}, contact, gravity,
                 fmt::format("[[body]]\nshape = \"{}\"\nmaterial = 'surface'\n{}\n{}", path, body, content)));
}

std::string sphere(const Vec3& center, double radius, double mass = 0.0) {
  const std::string text = fmt::format("[[sphere]]\ncenter = {}\nradius = {}\n", toml(center), radius);
  return mass > 0.0 ? text + fmt::format("mass = {}\n", mass) : text;
}

// Euler's equations of a lamina are a pendulum's: with w1 = A cos f, w2 = A sin f its rate in the plane A is
// constant, f' = w3 and (2 f)'' = -A^2 (I2 - I1) / (I2 + I1) sin(2 f).
TEST(OwnInertia, ALaminaTumblesAsAPendulum) {
  const Folder folder;
  // A plate of 4 x 2 and no thickness, of four balls that are thick.
  const Vec3 moments(4.0 / 12.0, 16.0 / 12.0, 20.0 / 12.0);
  std::string shape = fmt::format("name = 'plate'\n[body]\ninertia = {}\n", toml(moments));
  for (const double x : {-1.5, -0.5, 0.5, 1.5}) shape += sphere({x, 0.0, 0.0}, 0.5);
  const double in_plane = 0.7, dt = 0.01;
  const double k = (moments[1] - moments[0]) / (moments[1] + moments[0]);
  const double swing = 1.0;  // of f
  const double quarter = std::comp_ellint_1(std::sin(swing)) / (in_plane * std::sqrt(k));
  // At the end of a swing f' = 0, and so is w3.
  const Vec3 w(in_plane * std::cos(swing), in_plane * std::sin(swing), 0.0);
  Experiment e = one_body(folder, shape, fmt::format("mass = 3\nangular_velocity = {}", toml(w)),
                          fmt::format("stiffness = 1\ntime_step = {}\nunsafe_time_step = true", dt), "");
  e.begin();
  const Bodies& bodies = e.state.bodies;
  EXPECT_LT((bodies.inertia[0] - 3.0 * moments).norm(), 1e-13);
  EXPECT_NEAR(bodies.mass[0], 3.0, 1e-15);
  const Vec3 spin = bodies.spin[0];
  double in_plane_error = 0.0, before = 0.0, first = 0.0, last = 0.0;
  int crossings = 0;
  while (crossings < 21 && e.state.clock.time() < 1e4) {
    e.advance(1);
    const Vec3 now = bodies.orientation[0].conjugate() * angular_velocity(bodies, 0);
    in_plane_error = std::max(in_plane_error, std::abs(std::hypot(now.x(), now.y()) / in_plane - 1.0));
    const double f = now.y() / now.x(), t = e.state.clock.time();
    if (before * f < 0.0) {
      last = t - dt * f / (f - before);
      if (crossings++ == 0) first = last;
    }
    before = f;
  }
  EXPECT_EQ(crossings, 21);
  EXPECT_EQ(bodies.spin[0], spin);
  report::error("lamina in free flight, ten swings: its rate in its plane, relative", "conserved",
                in_plane_error, 2e-5);
  report::close("the same: period of the swings, s", "pendulum, elliptic integral", (last - first) / 10.0,
                4.0 * quarter, 2e-5);
}

TEST(OwnMasses, AUniformFieldDoesNotTurnALoadedDumbbell) {
  const Folder folder;
  const std::string shape =
      "name = 'loaded'\n" + sphere({-1.0, 0.2, 0.0}, 1.0, 5.0) + sphere({1.0, 0.0, 0.5}, 0.8, 0.25);
  Experiment e =
      one_body(folder, shape, "density = 2000\norientation = [0.3, 0.5, -0.2, 0.7]",
               "stiffness = 1\ntime_step = 0.01\nunsafe_time_step = true", field({0.3, -1.0, 2.0}));
  e.begin();
  e.advance(1000);
  EXPECT_EQ(e.state.bodies.spin[0], Vec3::Zero());
  const Bodies& bodies = e.state.bodies;
  EXPECT_NEAR(bodies.spheres.mass[0] / bodies.spheres.mass[1], 20.0, 1e-12);
  EXPECT_NEAR(bodies.spheres.mass[0] + bodies.spheres.mass[1], bodies.mass[0], 1e-12 * bodies.mass[0]);
  EXPECT_LT((bodies.position[0] - 50.0 * Vec3(0.3, -1.0, 2.0)).norm(), 1e-9);
}

// The pull of a planet on either mass turns the body as if it hung: rate^2 = 3 gm / r^3 sum m d^2 / I.
TEST(OwnMasses, ALoadedDumbbellSwingsInTheGravityGradient) {
  const Folder folder;
  const std::string shape =
      "name = 'loaded'\n" + sphere({-1.0, 0.0, 0.0}, 0.5, 9.0) + sphere({1.0, 0.0, 0.0}, 1.0, 1.0);
  const double gm = 4e14, distance = 1e7, angle = 1e-3, dt = 1.0;
  Experiment e =
      one_body(folder, shape,
               fmt::format("mass = 10\norientation = [{:.17g}, 0, 0, {:.17g}]", std::cos(0.5 * angle),
                           std::sin(0.5 * angle)),
               fmt::format("stiffness = 1\ntime_step = {}\nunsafe_time_step = true", dt), "",
               fmt::format("[[perturber]]\nname = 'P'\ngm = {}\nposition = [{}, 0, 0]\n", gm, distance));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  const double spread = 9.0 * 0.2 * 0.2 + 1.0 * 1.8 * 1.8, own = 0.4 * (9.0 * 0.25 + 1.0);
  EXPECT_NEAR(bodies.inertia[0].z(), spread + own, 1e-12);
  const double rate = std::sqrt(3.0 * gm / std::pow(distance, 3) * spread / (spread + own));
  double before = angle, first = 0.0, last = 0.0;
  int crossings = 0;
  while (crossings < 11 && e.state.clock.time() < 1e5) {
    e.advance(1);
    e.state.bodies.force[0].setZero();  // held in place: along the line to the planet it would run away
    e.state.bodies.velocity[0].setZero();
    const Quat& q = bodies.orientation[0];
    const double now = 2.0 * std::atan2(q.z(), q.w());
    if (before * now < 0.0) {
      last = e.state.clock.time() - dt * now / (now - before);
      if (crossings++ == 0) first = last;
    }
    before = now;
  }
  EXPECT_EQ(crossings, 11);
  report::close("dumbbell with masses 9 : 1 in a planet's gravity gradient: rate of its swings, rad/s",
                "rate^2 = 3 gm / r^3 sum m d^2 / I", kPi * 10.0 / (last - first), rate, 1e-5);
}

// A ball with a weight inside, h below its middle, rocks on a floor without sliding: rate^2 = M g h / (I + M
// (R - h)^2).
TEST(OwnMasses, ARolyPolyRocks) {
  const Folder folder;
  const std::string shape =
      "name = 'roly-poly'\n" + sphere({0.0, 0.0, 0.0}, 1.0, 1.0) + sphere({0.0, 0.0, -0.6}, 0.3, 3.0);
  const double h = 0.45, inertia = 0.4 * (1.0 + 3.0 * 0.09) + 0.45 * 0.45 + 3.0 * 0.15 * 0.15, mass = 4.0,
               g = 1.0;
  const double rate = std::sqrt(mass * g * h / (inertia + mass * (1.0 - h) * (1.0 - h)));
  const double angle = 0.02, stiffness = 1e5, sag = mass * g / stiffness;
  const std::string path = folder.write("grain.toml", shape);
  // Released tilted about y, the floor already bearing it.
  Experiment e(scene_text(
      {.restitution = 0.5, .friction = 1.0}, fmt::format("stiffness = {}", stiffness), field({0, 0, -g}),
      fmt::format("[[body]]\nshape = \"{}\"\nmaterial = 'surface'\nmass = {}\nposition = {}\norientation = "
                  "[{:.17g}, 0, {:.17g}, 0]\n",
                  path, mass, toml({-h * std::sin(angle), 0.0, 1.0 - sag - h * std::cos(angle)}),
                  std::cos(0.5 * angle), std::sin(0.5 * angle)) +
          wall()));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  EXPECT_NEAR(bodies.inertia[0].z() + bodies.inertia[0].x() + bodies.inertia[0].y(),
              2.0 * inertia + 0.4 * (1.0 + 3.0 * 0.09), 1e-12);
  const double dt = e.physics.contacts.dt;
  double before = angle, first = 0.0, last = 0.0;
  int crossings = 0;
  while (crossings < 5 && e.state.clock.time() < 100.0) {
    e.advance(1);
    const double now = bodies.spheres.position[0].x() - bodies.position[0].x();
    if (before * now < 0.0) {
      last = e.state.clock.time() - dt * now / (now - before);
      if (crossings++ == 0) first = last;
    }
    before = now;
  }
  EXPECT_EQ(crossings, 5);
  report::close("ball with a weight inside on a rough floor: rate of its rocking, rad/s",
                "rate^2 = M g h / (I + M (R - h)^2)", kPi * 4.0 / (last - first), rate, 1e-3);
}

}  // namespace
}  // namespace cairn
