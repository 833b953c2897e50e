// Force and torque on walls against the momentum that bodies lose there, and against their weight.
#include <gtest/gtest.h>
#include <omp.h>

#include "analysis/budget.h"
#include "physics/experiment.h"
#include "physics/report.h"

namespace cairn {
namespace {

constexpr double kGravity = 10.0;  // m/s^2

/// Grains in a cubic box of six walls with its middle at the zero, of half the width `half` (m).
std::string grains_in_a_box(double half, const std::string& field, const std::string& material,
                            const std::string& more) {
  std::string text = fmt::format(R"(
[gravity]
method = "none"
{}
[contact]
stiffness = 1e8
[[material]]
name = "surface"
{}
[[stage]]
name = "only"
duration = 1e3
[output]
series_interval = 1
{}
)",
                                 field, material, more);
  for (const char* axis : {"1, 0, 0", "0, 1, 0", "0, 0, 1"})
    for (const double side : {1.0, -1.0}) {
      const Vec3 n = side * Vec3(axis[0] == '1', axis[3] == '1', axis[6] == '1');
      const Vec3 p = -half * n;
      text += fmt::format("[[wall]]\nkind = 'plane'\nnormal = [{}, {}, {}]\npoint = [{}, {}, {}]\n", n.x(),
                          n.y(), n.z(), p.x(), p.y(), p.z());
    }
  return text;
}

std::string flying_grains() {
  std::string text;
  const char* const shapes[] = {"sphere", "tetrahedron", "dumbbell"};
  for (int k = 0; k < 9; ++k)
    text += fmt::format(
        "[[body]]\nshape = '{}'\nsize = 0.4\ndensity = 1000\nposition = [{}, {}, {}]\nvelocity = [{}, {}, "
        "{}]\n"
        "angular_velocity = [1, {}, 2]\n",
        shapes[k % 3], -1.5 + 1.5 * (k % 3), -1.5 + 1.5 * (k / 3), 0.5 - 0.2 * k, 3 - k, 2.0 * k - 5, 1 + k,
        k);
  return text;
}

/// Sum over the walls.
Vec3 total(const std::vector<Vec3>& loads) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : loads) sum += v;
  return sum;
}

TEST(WallLoads, TheImpulsesOnAllWallsAreTheMomentumThatBodiesLose) {
  for (const bool falls : {false, true}) {
    const Vec3 g(0.0, 0.0, falls ? -kGravity : 0.0);
    Experiment e(grains_in_a_box(2.5, fmt::format("field = [0, 0, {}]", g.z()),
                                 "restitution_normal = 0.7\nfriction = 0.5", flying_grains()));
    e.begin();
    const Budget before = budget(e.state.bodies);
    double pushes = 0.0;
    for (int k = 0; k < 4000; ++k) {
      e.advance(1);
      pushes += total(e.state.walls.loads.force).norm() * e.physics.contacts.dt;
    }
    const Budget after = budget(e.state.bodies);
    const WallLoads& loads = e.state.walls.loads;
    const Vec3 lost = before.momentum - after.momentum + before.mass * e.state.clock.time() * g;
    EXPECT_GT(pushes, lost.norm());
    report::error(falls ? "grains that fall and bounce in a box: impulse on its walls, over all blows"
                        : "grains that fly in a box: impulse on its walls, over all blows",
                  "momentum lost", (total(loads.impulse) - lost).norm() / pushes, 1e-11);
    if (falls) continue;
    // Torques are about points of the walls: moved to the zero they are those on the whole box.
    Vec3 turned = total(loads.angular_impulse);
    for (std::size_t w = 0; w < 6; ++w) turned += e.scene.walls[w].point.cross(loads.impulse[w]);
    const Vec3 spun = before.angular_momentum_about_origin - after.angular_momentum_about_origin;
    EXPECT_GT(spun.norm(), 1.0);
    report::error("the same: moment of the impulse about the zero, over all blows (m)",
                  "angular momentum lost", (turned - spun).norm() / pushes, 1e-11);
  }
}

TEST(WallLoads, AFloorBearsTheWeightOfItsBed) {
  std::string bed;
  double mass = 0.0;
  for (int k = 0; k < 12; ++k) {
    const double r = 0.5 - 0.01 * k;
    bed += fmt::format("[[body]]\nshape = 'sphere'\nsize = {}\ndensity = 1000\nposition = [{}, {}, {}]\n", r,
                       -0.5 + k % 2, -0.5 + (k / 2) % 2, -0.5 + k / 4);
    mass += 1000.0 * 4.0 / 3.0 * kPi * r * r * r;
  }
  Experiment e(grains_in_a_box(1.0, fmt::format("field = [0, 0, {}]", -kGravity),
                               "restitution_normal = 0.05\nrestitution_tangential = 0.05\nfriction = 0.3",
                               bed));
  e.scene.walls[5].point.z() = 9.0;  // the lid is far away
  e.state.walls.walls = make_walls(e.scene);
  e.begin();
  for (int k = 0; k < 40 && (k == 0 || e.kinetic_energy() > 1e-16); ++k) e.advance(2000);
  const WallLoads& loads = e.state.walls.loads;
  report::close("bed at rest in a box: force on its floor (N)", "weight, less what the sides bear",
                loads.force[4].z(), -mass * kGravity - (total(loads.force).z() - loads.force[4].z()), 1e-6);
  report::close("the same: force on all walls (N)", "weight", -total(loads.force).z(), mass * kGravity, 1e-6);
  EXPECT_LT(total(loads.force).head<2>().norm(), 1e-6 * mass * kGravity);
  EXPECT_EQ(loads.force[5], Vec3::Zero());
}

TEST(WallLoads, TorqueIsAboutTheRotationPointWhereItIsNow) {
  // A drum whose axis moves: a ball at rest in its lowest point.
  Experiment e(R"(
[[body]]
shape = "sphere"
size = 0.5
density = 1000
position = [0, 3, 0.4999]
velocity = [2, 0, 0]
[[wall]]
kind = "plane"
velocity = [2, 0, 0]
rotation_point = [-1, 1, -7]
[gravity]
method = "none"
[contact]
stiffness = 1e7
[[stage]]
name = "only"
duration = 1
)");
  e.begin();
  e.advance(3);
  const WallLoads& loads = e.state.walls.loads;
  const Vec3 at = e.state.bodies.position[0] - (Vec3(-1, 1, -7) + e.state.clock.time() * Vec3(2, 0, 0));
  ASSERT_LT(loads.force[0].z(), -100.0);
  EXPECT_LT((loads.torque[0] - at.cross(loads.force[0])).norm(), 1e-9 * loads.torque[0].norm());
}

TEST(WallLoads, AreTheSameForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  std::vector<Vec3> found;
  for (const int n : {1, 3}) {
    omp_set_num_threads(n);
    std::string grains;
    for (int k = 0; k < 400; ++k)
      grains += fmt::format(
          "[[body]]\nshape = 'sphere'\nsize = 0.45\ndensity = 1000\nposition = [{}, {}, {}]\nvelocity = [{}, "
          "{}, "
          "-3]\n",
          -3.5 + k % 8, -3.5 + (k / 8) % 8, -3.5 + k / 64, 3 - k % 5, 3 - k % 7);
    Experiment e(grains_in_a_box(4.0, "", "friction = 0.5", grains));
    e.begin();
    e.advance(600);
    for (const auto* column : {&e.state.walls.loads.impulse, &e.state.walls.loads.angular_impulse})
      found.insert(found.end(), column->begin(), column->end());
  }
  omp_set_num_threads(threads);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(found[k], found[12 + k]);
  EXPECT_GT(found[4].norm(), 1.0);
}

}  // namespace
}  // namespace cairn
