#include "sim/observe.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shape/library.h"
#include "stage.h"

namespace cairn {
namespace {

/// Two dumbbells side by side that press on each other with both spheres, and a ball far away, moving.
struct Sight : Stage {
  explicit Sight(const std::string& tables)
      : Stage(R"(
[[body]]
shape = "sphere"
density = 2000
[gravity]
method = "direct"
[contact]
stiffness = 1e6
[[stage]]
name = "look"
duration = 10
)" + tables) {
    const RigidShape pair = make_rigid(load_shape("dumbbell", "."), MassModel::union_volume),
                     ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
    for (const double y : {0.0, 1.99})
      add_body(state.bodies, pair, 0, 1.0, 2000.0, 0, {.position = {0.0, y, 0.0}});
    add_body(state.bodies, ball, 1, 1.0, 2000.0, 0,
             {.position = {30.0, 0.0, 0.0}, .velocity = {0.0, 2.0, 0.0}});
    begin();
    state.clock.stage_start = 5.0;
  }
  Observation look() { return observe(physics, state, scratch, 0.1); }
};

TEST(Observe, CountsContactsRemnantAndFragments) {
  Sight sight("");
  const Observation o = sight.look();
  const double pair = sight.state.bodies.mass[0], ball = sight.state.bodies.mass[2];
  EXPECT_EQ(o.contacts, 2.0);
  EXPECT_DOUBLE_EQ(o.coordination, 4.0 / 5.0);
  EXPECT_EQ(o.touching_bodies, 1.0);
  EXPECT_EQ(o.fragments, 2.0);
  EXPECT_EQ(o.shed_bodies, 1.0);
  EXPECT_DOUBLE_EQ(o.remnant_mass_fraction, 2.0 * pair / (2.0 * pair + ball));
  EXPECT_EQ(o.remnant, (std::vector<std::uint8_t>{1, 1, 0}));
  EXPECT_EQ(sight.state.remnant, (std::vector<std::uint8_t>{1, 1, 1}));  // looking changes nothing
  EXPECT_NEAR(o.axis_a, 3.99, 1e-9);  // across both, and more than along one of them
  EXPECT_NEAR(o.axis_c, 2.0, 1e-9);
  EXPECT_NEAR(o.c_over_a, 2.0 / 3.99, 1e-9);
  EXPECT_LT(o.all_c_over_a, 0.1);
}

TEST(Observe, LargestOverlapIsThatSinceTheRowBefore) {
  Sight sight("");
  EXPECT_NEAR(sight.look().largest_overlap, 0.01, 1e-9);
  sight.state.ledger.recent_overlap = 0.0;  // as a row is written
  EXPECT_EQ(sight.look().largest_overlap, 0.0);
  EXPECT_NEAR(sight.state.ledger.largest_overlap, 0.01, 1e-9);
  step(sight.physics, sight.state, sight.scratch);
  EXPECT_NEAR(sight.look().largest_overlap, 0.01, 1e-3);
}

TEST(Observe, EnergiesAndMomenta) {
  Sight sight("[stage.spin]\npath = [[0, 100], [10, 50]]\n");
  sight.state.clock.step = sight.physics.steps / 2;
  sight.state.ledger.dissipated = 7.0;
  sight.state.ledger.control_work = 8.0;
  sight.state.ledger.start_momentum = {0.0, 0.0, 3.0};
  const Observation o = sight.look();
  const Bodies& bodies = sight.state.bodies;
  const double pair = bodies.mass[0], ball = bodies.mass[2], p = 2.0 * ball;
  EXPECT_NEAR(o.time, 10.0, 0.01);
  EXPECT_NEAR(o.spin_target, 75.0, 0.05);  // half-way along the path, which starts with the stage
  EXPECT_DOUBLE_EQ(o.kinetic, 0.5 * ball * 4.0);
  EXPECT_EQ(o.rotational, 0.0);
  EXPECT_NEAR(o.elastic, 2.0 * 0.5 * 1e6 * 1e-4, 1e-6);
  EXPECT_EQ(o.dissipated, 7.0);
  EXPECT_EQ(o.control_work, 8.0);
  EXPECT_DOUBLE_EQ(o.momentum_y, p);
  EXPECT_NEAR(o.momentum_drift, std::hypot(p, 3.0) / p, 1e-12);
  // Ball and pair of dumbbells about their mass centre: reduced mass times lever times relative speed.
  const double reduced = 2.0 * pair * ball / (2.0 * pair + ball);
  EXPECT_NEAR(o.angular_z, reduced * 30.0 * 2.0, 1e-9 * o.angular_z);
  EXPECT_GT(o.angular_drift, 0.5);  // nothing at the start, nothing given
  sight.state.ledger.control_momentum = {o.angular_x, o.angular_y, o.angular_z};
  EXPECT_LT(sight.look().angular_drift, 1e-15);
}

TEST(Observe, WallsCountAsContactsAndEndConservation) {
  Sight sight("[[wall]]\nkind = 'plane'\npoint = [0, 0, -0.995]\n");
  const Observation o = sight.look();
  EXPECT_EQ(o.contacts, 2.0 + 5.0);
  EXPECT_DOUBLE_EQ(o.coordination, (4.0 + 5.0) / 5.0);
  EXPECT_NEAR(o.elastic, 2.0 * 0.5 * 1e6 * 1e-4 + 5.0 * 0.5 * 1e6 * 25e-6, 1e-6);
  EXPECT_TRUE(std::isnan(o.momentum_drift));
  EXPECT_TRUE(std::isnan(o.angular_drift));
  EXPECT_TRUE(std::isnan(o.spin_target));
}

TEST(Observe, RowFollowsTheColumns) {
  Observation o;
  o.time = 1.0;
  o.gravity_miss = 3.0;
  const std::vector<double> values = row(o);
  const std::vector<SeriesColumn> columns = series_columns();
  ASSERT_EQ(values.size(), columns.size());
  EXPECT_EQ(values.front(), 1.0);
  EXPECT_EQ(columns.front().name, "time");
  EXPECT_EQ(values.back(), 3.0);
  EXPECT_EQ(columns.back().name, "gravity_miss");
}

}  // namespace
}  // namespace cairn
