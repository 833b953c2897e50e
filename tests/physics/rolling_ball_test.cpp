// A ball that rolls: its attitude, and its way where its spring sits at the limit while the slip turns.
#include <gtest/gtest.h>

#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kRadius = 5.0, kField = 10.0, kTime = 1.5;  // m, m/s^2, s

/// Spin and velocity after kTime of a unit sphere thrown sideways high up on the wall of a bowl.
Eigen::Matrix<double, 6, 1> thrown(double steps_per_contact) {
  constexpr double stiffness = 1e7, angle = 0.7, mass = 2000.0 * 4.0 / 3.0 * kPi;
  const double speed = 3.0, reach = kRadius - 1.0;
  const double press = mass * (kField * std::cos(angle) + speed * speed / reach);
  const Vec3 out(std::sin(angle), 0.0, -std::cos(angle));
  Experiment e(scene_text({.restitution = 0.2, .friction = 0.3, .rolling = 0.1, .twisting = 0.1},
                          fmt::format("stiffness = {}\nsteps_per_contact = {}", stiffness, steps_per_contact),
                          field({0.0, 0.0, -kField}),
                          body({.position = (reach + press / stiffness) * out,
                                .velocity = {0.0, speed, 0.0},
                                .spin = {1.0, 0.0, 3.0}}) +
                              fmt::format("[[wall]]\nkind = 'sphere'\npoint = [0, 0, 0]\nradius = {}\n"
                                          "material = 'surface'\n",
                                          kRadius),
                          kTime));
  e.begin();
  e.advance(e.physics.steps);
  EXPECT_TRUE(e.touching());
  Eigen::Matrix<double, 6, 1> out_state;
  out_state << angular_velocity(e.state.bodies, 0), e.state.bodies.velocity[0];
  return out_state;
}

TEST(RollingBall, TurnsByItsWayOverItsRadius) {
  constexpr double stiffness = 1e7, speed = 0.5, time = 20.0;
  const double lever = 1.0 - 2000.0 * 4.0 / 3.0 * kPi * kField / stiffness;  // it sinks in a little
  const Vec3 along = Vec3(0.6, 0.8, 0.0), axis = Vec3::UnitZ().cross(along);
  const Quat start(0.5, 0.1, -0.7, 0.5);
  Experiment e(scene_text({.restitution = 0.5, .friction = 0.5}, fmt::format("stiffness = {}", stiffness),
                          field({0.0, 0.0, -kField}),
                          body({.position = {0.0, 0.0, lever},
                                .velocity = speed * along,
                                .spin = speed / lever * axis,
                                .orientation = start.normalized()}) +
                              wall(),
                          time));
  e.begin();
  const Quat before = e.state.bodies.orientation[0];
  e.advance(e.physics.steps);
  const double way = e.state.bodies.position[0].dot(along);
  report::close("ball rolling on a plane: way in 20 s, m", "v t", way, speed * time, 1e-6);
  report::error(
      "its attitude then, rad", "way over radius, less its overlap with the plane",
      e.state.bodies.orientation[0].angularDistance(Quat(Eigen::AngleAxisd(way / lever, axis)) * before),
      1e-6);
}

TEST(RollingBall, ThatSlidesLongInABowlConvergesAtSecondOrder) {
  const auto exact = thrown(3200.0);
  const std::vector<double> steps{25.0, 50.0, 100.0, 200.0};
  report::Curve curve{"ball in a bowl", steps, {}};
  for (const double n : steps) curve.y.push_back((thrown(n) - exact).norm() / exact.norm());
  report::near(
      "ball thrown into a bowl, spin and velocity after 1.5 s: order of the error in the step, 25 to 200 "
      "steps per contact",
      "second order", -order_of(curve.x, curve.y), 2.0, 0.25);
  report::error("the same: relative error at 50 steps per contact", "a step 64 times shorter", curve.y[1],
                1e-5);
}

}  // namespace
}  // namespace cairn
