// What begins a stage and what a step does every so often.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "shape/library.h"
#include "sim/springs.h"
#include "stage.h"

namespace cairn {
namespace {

/// Two balls of 1 m and 2000 kg/m^3 that press on each other and on a floor.
struct TwoOnFloor : Stage {
  /// `material`: key of the bodies and of the floor.
  explicit TwoOnFloor(const std::string& tables, const std::string& material = {})
      : Stage(R"(
[[body]]
shape = "sphere"
density = 2000
)" + material +
              R"(
[[wall]]
kind = "plane"
point = [0, 0, -0.99]
)" + material +
              tables) {
    const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
    for (const double x : {0.0, 1.99})
      add_body(state.bodies, ball, 0, 1.0, 2000.0, 0, {.position = {x, 0.0, 0.0}});
  }
};

TEST(BeginStage, SpringsKeepTheirForcesAndDashpotsAreMadeAnew) {
  TwoOnFloor two(R"(
[gravity]
method = "none"
[contact]
stiffness = 4e5
[[stage]]
name = "stiffer"
duration = 1
)");
  const ContactMemory<double> old{1.0, 2.0, {0.0, 2e-4, 0.0}, {0.0, 4e-4, 0.0}, 8e-4};
  two.state.k_n = 1e5;
  two.state.walls.contacts = {{1, 0, 0, old}};
  two.begin({{0, 1, old}});
  EXPECT_EQ(two.state.k_n, 4e5);
  // In the plane a ball has 1 + 2.5 a^2 times the mobility of its mass; a is the lever arm of the contact.
  const double damping = damping_ratio(0.55), mass = two.state.bodies.mass[0];
  const auto pairs = two.state.contacts.records();
  const auto& walls = two.state.walls.contacts;
  ASSERT_EQ(pairs.size(), 1u);
  ASSERT_EQ(walls.size(), 2u);  // the other ball touches for the first time
  for (const auto& [m, mu, arm] :
       {std::tuple{pairs[0].memory, 0.5 * mass, 0.995}, std::tuple{walls[1].memory, mass, 0.99}}) {
    EXPECT_NEAR(m.c_n, damping * std::sqrt(4e5 * mu), 1e-9 * m.c_n);
    EXPECT_NEAR(m.c_s, damping * std::sqrt(2.0 / 7.0 * 4e5 * mu / (1.0 + 2.5 * arm * arm)), 1e-9 * m.c_s);
    EXPECT_NEAR(m.slide.y, 0.5e-4, 1e-18);
    EXPECT_NEAR(m.roll.y, 1e-4, 1e-18);
    EXPECT_NEAR(m.twist, 2e-4, 1e-18);
  }
  EXPECT_EQ(walls[0].memory.slide.y, 0.0);
  // Springs of 2/7 4e5 N/m, drawn along y on ball 0 by ball 1; the floor has no hold on ball 0 yet.
  EXPECT_NEAR(two.state.bodies.force[0].y(), 2.0 / 7.0 * 4e5 * 0.5e-4, 1e-9);
  EXPECT_NEAR(two.state.bodies.force[0].x(), -4e5 * 0.01, 1e-6);
  EXPECT_NEAR(two.state.bodies.force[0].z(), 4e5 * 0.01, 1e-6);
}

// Two balls of two materials on a floor of a third: three pairs, and no two of the same stiffness or k_S/k_N.
TEST(BeginStage, SpringsKeepTheirForcesByPairWhenMaterialsChange) {
  TwoOnFloor two(R"(
[[material]]
name = "soft"
stiffness = 2e5
stiffness_ratio = 0.5
[[material]]
name = "hard"
stiffness = 8e5
stiffness_ratio = 0.7
[[material]]
name = "plank"
[gravity]
method = "none"
[contact]
stiffness = 4e5
[[stage]]
name = "two materials"
duration = 1
[[stage]]
name = "one, on a softer floor"
duration = 1
stiffness = 1e5
material = "hard"
)",
                 "material = 'plank'");
  State& state = two.state;
  state.bodies.material = {0, 1};
  two.begin();
  EXPECT_NEAR(two.physics.contacts.laws[1].k_n, 3.2e5, 1e-9);
  const ContactMemory<double> old{1.0, 2.0, {0.0, 2e-4, 0.0}, {0.0, 4e-4, 0.0}, 8e-4};
  std::vector<ContactRecord> pairs{{0, 1, old}};
  state.walls.contacts = {{0, 0, 0, old}, {1, 0, 0, old}};
  leave_stiffness(two.physics, state.bodies, pairs, state.walls.contacts);
  const Physics next = resolve_physics(two.scene, 1, state.bodies, 1e5);
  begin_stage(next, pairs, state, two.scratch);
  const auto series = [](double a, double b) { return 2.0 / (1.0 / a + 1.0 / b); };
  const auto expect = [&](const ContactMemory<double>& m, double k_n, double k_s, double now_n,
                          double now_s) {
    EXPECT_NEAR(m.slide.y / old.slide.y, k_s / now_s, 1e-12);
    EXPECT_NEAR(m.roll.y / old.roll.y, k_n / now_n, 1e-12);
    EXPECT_NEAR(m.twist / old.twist, k_s / now_s, 1e-12);
  };
  const double plain = 2.0 / 7.0;
  expect(state.contacts.records().at(0).memory, series(2e5, 8e5), series(1e5, 5.6e5), 8e5, 5.6e5);
  ASSERT_EQ(state.walls.contacts.size(), 2u);
  expect(state.walls.contacts[0].memory, series(2e5, 4e5), series(1e5, plain * 4e5), series(8e5, 1e5),
         series(5.6e5, plain * 1e5));
  expect(state.walls.contacts[1].memory, series(8e5, 4e5), series(5.6e5, plain * 4e5), series(8e5, 1e5),
         series(5.6e5, plain * 1e5));
}

TEST(BeginStage, DashpotsKeepTheEffectiveMassesOfFirstTouch) {
  TwoOnFloor two(R"(
[gravity]
method = "none"
[contact]
stiffness = 4e5
[[stage]]
name = "the same, or stiffer"
duration = 1
)");
  two.begin();
  const ContactMemory<double> old{1.0, 2.0, {}, {}, 0.0};
  for (const double softer : {1.0, 4.0}) {
    FormerStage former{two.physics, two.state.walls};
    for (PairLaw& law : former.physics.contacts.laws) law.k_n /= softer, law.k_s /= softer;
    former.walls.set_laws(two.physics.materials, two.physics.wall_materials, two.physics.k_n / softer);
    two.state.walls.contacts = {{1, 0, 0, old}};
    begin_stage(two.physics, {{0, 1, old}}, two.state, two.scratch, &former);
    for (const ContactMemory<double>& m :
         {two.state.contacts.records().at(0).memory, two.state.walls.contacts.at(1).memory}) {
      EXPECT_EQ(m.c_n, std::sqrt(softer));
      EXPECT_EQ(m.c_s, 2.0 * std::sqrt(softer));
    }
    // With another restitution in the same proportion; from an elastic one nothing is known.
    for (const double damping : {0.5, 0.0}) {
      FormerStage other{two.physics, two.state.walls};
      for (PairLaw& law : other.physics.contacts.laws) law.damping_n *= damping, law.damping_s *= damping;
      begin_stage(two.physics, {{0, 1, old}}, two.state, two.scratch, &other);
      const ContactMemory<double> m = two.state.contacts.records().at(0).memory;
      if (damping > 0.0)
        EXPECT_EQ(m.c_n, 2.0);
      else
        EXPECT_NEAR(m.c_n, damping_ratio(0.55) * std::sqrt(0.5 * 4e5 * two.state.bodies.mass[0]),
                    1e-9 * m.c_n);
    }
  }
}

TEST(BeginStage, RefusesAContactOfSpheresFarApart) {
  TwoOnFloor two(
      "[gravity]\nmethod = 'none'\n[contact]\nstiffness = 1e5\n[[stage]]\nname = 's'\nduration = 1\n");
  two.state.bodies.position[1].x() = 5.0;
  EXPECT_THROW(two.begin({{0, 1, {}}}), InputError);
}

TEST(Step, GravityIsRenewedAtItsInterval) {
  TwoOnFloor two(R"(
[gravity]
method = "direct"
interval = 3
field = [0, 0, -1e-3]
[contact]
stiffness = 1e5
[[stage]]
name = "hold"
duration = 10
)");
  two.begin();
  const double pull = kGravitationalConstant * std::pow(two.state.bodies.mass[0] / 1.99, 2);
  EXPECT_NEAR(two.state.gravity.from.force[0].x(), pull, 1e-12 * pull);
  EXPECT_NEAR(two.state.gravity.from.force[1].x(), -pull, 1e-12 * pull);
  EXPECT_NEAR(gravitational_energy(two.physics, two.state, two.scratch), -1.99 * pull, 1e-12 * pull);
  for (std::uint64_t k = 1; k < 10; ++k) {
    two.advance(1);
    EXPECT_DOUBLE_EQ(two.state.gravity.time, static_cast<double>(k / 3 * 3) * two.physics.contacts.dt) << k;
  }
}

TEST(BeginStage, FindsWhatTheErrorOfGravityTakes) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  for (const char* gravity : {"error = 1e-2", "error = 1e-5", "opening_angle = 0.6\norder = 4"}) {
    Stage stage(
        fmt::format("[[body]]\nshape = 'sphere'\ndensity = 1\n[contact]\nstiffness = 1e5\n[gravity]\n{}\n"
                    "[[stage]]\nname = 's'\nduration = 9\n",
                    gravity));
    for (int x = -7; x <= 7; ++x)
      for (int y = -7; y <= 7; ++y)
        for (int z = -7; z <= 7; ++z)
          add_body(stage.state.bodies, ball, 0, 1.0, 2000.0, 0, {.position = 3.0 * Vec3(x, y, z)});
    stage.begin();
    std::vector<Vec3> exact(stage.state.bodies.size());
    const Bodies& bodies = stage.state.bodies;
    gravity::DirectSum().evaluate({bodies.position, bodies.spheres.mass, bodies.first_sphere}, exact);
    double difference = 0.0, size = 0.0;
    for (std::size_t b = 0; b < exact.size(); ++b) {
      difference += (bodies.force[b] / bodies.mass[b] - exact[b]).squaredNorm();
      size += exact[b].squaredNorm();
    }
    const double error = std::sqrt(difference / size);
    EXPECT_NEAR(stage.state.gravity.scale, std::sqrt(size / static_cast<double>(exact.size())),
                1e-2 * stage.state.gravity.scale);
    if (!stage.physics.gravity_error) {
      EXPECT_EQ(stage.state.gravity.factor, 0.0);
      EXPECT_LT(error, 3e-3);
      continue;
    }
    const double asked = *stage.physics.gravity_error;
    EXPECT_GT(stage.state.gravity.factor, 0.0);
    EXPECT_LE(stage.state.gravity.error, asked);
    EXPECT_LE(error, 1.2 * asked);
    EXPECT_GT(error, 0.1 * asked);
  }
}

TEST(Step, SpinIsPrescribedToTheRemnantAtItsInterval) {
  for (const bool include_shed : {false, true}) {
    TwoOnFloor two(fmt::format(R"(
[gravity]
method = "none"
[contact]
stiffness = 1e5
time_step = 1e-3
[[stage]]
name = "spin"
duration = 1
[stage.spin]
path = [[0, 100], [1, 50]]
control_interval = 2e-3
include_shed = {}
)",
                               include_shed));
    two.state.walls.walls.clear();
    two.state.bodies.position[1].x() = 50.0;
    two.state.remnant = {1, 0};
    two.state.clock.stage_start = 40.0;  // the path counts from there
    two.begin();
    two.advance(5);
    // The last correction was at the fourth step.
    const double rate = 2.0 * kPi / (100.0 - 50.0 * 4e-3);
    // Free bodies fly straight on between corrections, so that a far pair keeps a little of the old rate.
    EXPECT_NEAR(angular_velocity(two.state.bodies, 0).z(), rate, 1e-7 * rate);
    EXPECT_NEAR(angular_velocity(two.state.bodies, 1).z(), include_shed ? rate : 0.0, 1e-7 * rate);
    EXPECT_NEAR(two.state.control.shortest_period, 100.0 - 50.0 * 4e-3, 1e-12);
    const Bodies& bodies = two.state.bodies;
    Vec3 angular = Vec3::Zero();
    for (std::size_t b = 0; b < 2; ++b)
      angular += bodies.mass[b] * bodies.position[b].cross(bodies.velocity[b]) + bodies.spin[b];
    const double energy = two.kinetic_energy();
    EXPECT_NEAR(two.state.ledger.control_work, energy, 1e-9 * energy);
    EXPECT_LT((two.state.ledger.control_momentum - angular).norm(), 1e-9 * angular.norm());
  }
}

// Nothing comes nearer to anything in a rigid rotation, however far the spheres go.
TEST(Step, TheListOfATurningPileIsKept) {
  TwoOnFloor two(
      "[gravity]\nmethod = 'none'\n[contact]\nstiffness = 1e5\n[[stage]]\nname = 's'\nduration = 9\n");
  const RigidShape rod = make_rigid(load_shape("rod4", "."), MassModel::union_volume);
  two.state = State{};
  add_body(two.state.bodies, rod, 0, 1.0, 2000.0, 0,
           {.velocity = {1.0, 2.0, 3.0}, .angular_velocity = {0.0, 0.0, 1.0}});
  two.begin();
  two.advance(500);
  EXPECT_GT(two.state.clock.time(), 1.0);
  EXPECT_EQ(two.scratch.list_age, 500u);
}

}  // namespace
}  // namespace cairn
