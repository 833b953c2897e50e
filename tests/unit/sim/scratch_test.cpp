// What can be rebuilt may be thrown away: neither that nor the number of threads changes one bit of a run.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>
#include <functional>

#include "body/cells.h"
#include "core/random.h"
#include "grid_mesh.h"
#include "shape/library.h"
#include "stage.h"

namespace cairn {
namespace {

/// A bowl of triangles that covers the plane and turns.
std::shared_ptr<const MeshSurface> bowl() {
  return std::make_shared<const MeshSurface>(grid_mesh(12, [](double u, double v) {
    const double x = 60.0 * u - 30.0, y = 60.0 * v - 30.0;
    return Vec3(x, y, 0.01 * (x * x + y * y) - 14.0);
  }));
}

/// A hundred mixed aggregates thrown together above a plane in a turning bowl, all contact models on.
Stage thrown_together(const std::string& gravity) {
  Stage c(fmt::format(R"(
[[body]]
shape = "sphere"
density = 1
material = "rough"
[[material]]
name = "rough"
cohesion = 20
[[wall]]
kind = "plane"
point = [0, 0, -14]
material = "rough"
[contact]
stiffness = 2e6
overlap_limit = 1
steps_per_contact = 20
[gravity]
{}
field = [0, 0, -0.5]
[[wall]]
kind = "plane"
material = "rough"
oscillation_amplitude = [0, 0, 0.1]
oscillation_frequency = 0.1
angular_velocity = [0, 0.02, 0.1]
[[stage]]
name = "fall"
duration = 1e4
)",
                      gravity));
  const std::vector<std::string> names{"sphere", "rod4", "cube", "tetrahedron"};
  Random random(3, 0);
  std::uint32_t b = 0;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -1; z <= 1; ++z, ++b) {
        const RigidShape shape = make_rigid(load_shape(names[b % 4], "."), MassModel::union_volume);
        add_body(c.state.bodies, shape, b % 4, b % 4 == 1 ? 0.8 : 1.5, 2500.0, 0,
                 {.position = 6.2 * Vec3(x, y, z),
                  .orientation = random.rotation(),
                  .velocity = 1.5 * random.in_ball() - 0.3 * Vec3(x, y, z),
                  .angular_velocity = 0.5 * random.in_ball()});
      }
  c.state.walls.walls[1].surface = bowl();
  c.begin();
  return c;
}

/// A hundred dumbbells in a box that is squeezed, open along z between two planes.
Stage squeezed() {
  Stage c(R"(
[box]
size = [24, 26, 0]
[[body]]
shape = "sphere"
density = 1
[[wall]]
kind = "plane"
point = [0, 0, -13]
[[wall]]
kind = "plane"
point = [0, 0, 13]
normal = [0, 0, -1]
[contact]
stiffness = 2e6
overlap_limit = 1
steps_per_contact = 20
[gravity]
method = "none"
[[stage]]
name = "squeeze"
duration = 1e4
strain_rate = [-0.07, 0.03, 0]
)");
  const RigidShape shape = make_rigid(load_shape("dumbbell", "."), MassModel::union_volume);
  Random random(3, 0);
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = -2; z <= 2; ++z)
        add_body(c.state.bodies, shape, 0, 1.2, 2500.0, 0,
                 {.position = {4.8 * x, 5.2 * y, 4.8 * z},
                  .orientation = random.rotation(),
                  .velocity = 3.0 * random.in_ball(),
                  .angular_velocity = 0.5 * random.in_ball()});
  c.begin();
  return c;
}

/// The same bodies thrown together as they fly over the border of a cell.
Stage over_the_border() {
  Stage c = thrown_together("method = 'tree'\ninterval = 7");
  Bodies& bodies = c.state.bodies;
  bodies.cell_edge = cell_edge(0.8);
  displace(
      bodies,
      1e5 * bodies.cell_edge * Vec3::UnitX() + 0.75 * bodies.cell_edge * Vec3::UnitZ() - Vec3(0.0, 0.0, 3.0),
      Vec3(0.0, 0.0, 30.0));
  c.state.walls.walls.clear();
  c.begin();
  return c;
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

void expect_same_bits(const State& a, const State& b) {
  EXPECT_TRUE(same_bits(a.bodies.position, b.bodies.position));
  EXPECT_TRUE(same_bits(a.bodies.cell, b.bodies.cell));
  EXPECT_EQ(a.box.edge, b.box.edge);
  EXPECT_TRUE(same_bits(a.bodies.velocity, b.bodies.velocity));
  EXPECT_TRUE(same_bits(a.bodies.spin, b.bodies.spin));
  EXPECT_TRUE(same_bits(a.bodies.force, b.bodies.force));
  EXPECT_TRUE(same_bits(a.bodies.torque, b.bodies.torque));
  for (std::size_t i = 0; i < a.bodies.size(); ++i)
    EXPECT_EQ(a.bodies.orientation[i].coeffs(), b.bodies.orientation[i].coeffs());
  const auto same_records = [](const std::vector<ContactRecord>& x, const std::vector<ContactRecord>& y) {
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_EQ(x[k].i, y[k].i);
      EXPECT_EQ(x[k].j, y[k].j);
      EXPECT_EQ(std::memcmp(&x[k].memory, &y[k].memory, sizeof x[k].memory), 0);
    }
  };
  same_records(a.contacts.records(), b.contacts.records());
  ASSERT_EQ(a.walls.contacts.size(), b.walls.contacts.size());
  for (std::size_t k = 0; k < a.walls.contacts.size(); ++k) {
    const WallContact &x = a.walls.contacts[k], &y = b.walls.contacts[k];
    EXPECT_EQ(std::tuple(x.sphere, x.wall, x.feature), std::tuple(y.sphere, y.wall, y.feature));
    EXPECT_EQ(std::memcmp(&x.memory, &y.memory, sizeof x.memory), 0);
  }
  EXPECT_EQ(a.ledger.dissipated, b.ledger.dissipated);
  EXPECT_EQ(a.ledger.wall_work, b.ledger.wall_work);
  EXPECT_EQ(a.ledger.largest_overlap, b.ledger.largest_overlap);
}

constexpr int kSteps = 1000;

void expect_scratch_can_go(const std::function<Stage()>& make, bool walls = true) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // one thread: a scene this small gains nothing from more
  Stage kept = make(), thrown = make();
  Random random(4, 0);
  int times = 0;
  for (int k = 0; k < kSteps; ++k) {
    kept.advance(1);
    if (random.uniform() < 0.05) {
      Scratch fresh;
      std::swap(thrown.scratch, fresh);
      prepare_scratch(thrown.physics, thrown.state, thrown.scratch);
      ++times;
    }
    thrown.advance(1);
  }
  omp_set_num_threads(threads);
  EXPECT_GT(times, 10);
  EXPECT_GT(kept.state.contacts.records().size(), walls ? 10u : 3u);
  EXPECT_TRUE(!walls || !kept.state.walls.contacts.empty());
  expect_same_bits(kept.state, thrown.state);
}

TEST(Scratch, CanBeThrownAwayAtAnyStepWithDirectGravity) {
  expect_scratch_can_go([] { return thrown_together("method = 'direct'"); });
}
TEST(Scratch, CanBeThrownAwayAtAnyStepWithHeldTreeGravity) {
  expect_scratch_can_go([] { return thrown_together("method = 'tree'\ninterval = 7"); });
}
TEST(Scratch, CanBeThrownAwayAtAnyStepWithGravityEvaluatedWhenNeeded) {
  expect_scratch_can_go([] { return thrown_together("method = 'tree'\ninterval = 'auto'"); });
}
TEST(Scratch, CanBeThrownAwayAtAnyStepInAStrainedBox) {
  expect_scratch_can_go(squeezed);
}
TEST(Scratch, CanBeThrownAwayAtAnyStepWhileBodiesChangeCells) {
  expect_scratch_can_go(over_the_border, false);
}

TEST(Threads, NumberOfThreadsDoesNotChangeOneBit) {
  const int threads = omp_get_max_threads();
  const auto run = [](int n) {
    omp_set_num_threads(n);
    Stage c = thrown_together("method = 'tree'");
    c.advance(kSteps);
    return c;
  };
  const Stage one = run(1), two = run(2);
  omp_set_num_threads(threads);
  EXPECT_GT(one.state.contacts.records().size(), 10u);
  expect_same_bits(one.state, two.state);
}

}  // namespace
}  // namespace cairn
