// Runs in a periodic box against the same runs without its borders, and against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "shape/library.h"
#include "sim/step.h"

namespace cairn {
namespace {

struct Case {
  Scene scene;
  Physics physics;
  State state;
  Scratch scratch;

  Case(const std::string& keys, const std::string& stage)
      : scene(parse_scene(fmt::format("{}\n[[body]]\nshape = 'sphere'\ndensity = 1\n[contact]\nstiffness = "
                                      "1e6\n[gravity]\nmethod = 'none'\n[[stage]]\nname = 'a'\nduration = "
                                      "100\n{}",
                                      keys, stage),
                          "box.toml", ".")) {
    if (scene.box) state.box.edge = scene.box->size;
  }
  void add(const std::string& shape, const Placement& placement) {
    add_body(state.bodies, make_rigid(load_shape(shape, "."), MassModel::union_volume), 0, 1.0, 2500.0, 0,
             placement);
  }
  void begin() {
    state.remnant.assign(state.bodies.size(), 1);
    physics = resolve_physics(scene, 0, state.bodies, *scene.contact.stiffness);
    begin_stage(physics, {}, state, scratch);
    state.clock.dt = physics.contacts.dt;
  }
  void advance(int steps) {
    for (int k = 0; k < steps; ++k) step(physics, state, scratch);
  }
};

/// Two cohesive dumbbells that stick to each other, roll and fly on: through several borders of a box.
Case stuck_pair(const std::string& keys, const Vec3& apart) {
  Case c(keys + "\n[[material]]\nname = 'm'\ncohesion = 1e5\n", "");
  c.add("dumbbell",
        {.position = {0.25, 0.5, 0.0}, .velocity = {1.3, 0.4, -0.9}, .angular_velocity = {0.1, 0.2, 0}});
  c.add("dumbbell", {.position = Vec3(0.25, 0.5, 1.96875) + apart, .velocity = {1.3, 0.38, -0.9}});
  c.begin();
  return c;
}

TEST(Box, PairThatFliesThroughBordersKeepsItsContacts) {
  Case open = stuck_pair("", Vec3::Zero());
  Case boxed = stuck_pair("[box]\nsize = [8, 16, 0]\n", Vec3(-16.0, 32.0, 0.0));
  for (int k = 0; k < 20; ++k) {
    open.advance(500);
    boxed.advance(500);
    const auto a = open.state.contacts.records(), b = boxed.state.contacts.records();
    ASSERT_GT(a.size(), 0u);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t r = 0; r < a.size(); ++r) {
      EXPECT_EQ(a[r].i, b[r].i);
      EXPECT_EQ(a[r].j, b[r].j);
      EXPECT_NEAR(a[r].memory.slide.x, b[r].memory.slide.x, 1e-11);
      EXPECT_NEAR(a[r].memory.roll.y, b[r].memory.roll.y, 1e-11);
    }
  }
  const Bodies &a = open.state.bodies, &b = boxed.state.bodies;
  EXPECT_GT(a.position[0].x(), 24.0);  // three borders away
  EXPECT_LT((a.position[0] - b.position[0]).norm(), 1e-9);
  EXPECT_LT((a.position[1] - b.position[1] - Vec3(16.0, -32.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((a.spin[0] - b.spin[0]).norm(), 1e-9 * a.spin[0].norm());
}

TEST(Box, TwoBodiesMeetAcrossTheBorder) {
  Case c("[box]\nsize = [12, 12, 12]\n", "");
  c.add("sphere", {.position = {1.5, 0.0, 0.0}, .velocity = {-0.5, 0.0, 0.0}});
  c.add("sphere", {.position = {10.0, 0.0, 0.0}});
  c.begin();
  c.advance(static_cast<int>(4.0 / c.physics.contacts.dt));
  EXPECT_GT(c.state.ledger.dissipated, 0.0);
  EXPECT_LT(c.state.bodies.velocity[1].x(), -0.1);
  EXPECT_NEAR(c.state.bodies.velocity[0].x() + c.state.bodies.velocity[1].x(), -0.5, 1e-14);
}

// Bodies that never meet are a gas of one: velocities go as 1 / edge, places with the box.
TEST(Box, CompressionHeatsAGasAndMovesItAffinely) {
  Case c("[box]\nsize = [40, 50, 60]\n", "strain_rate = [-0.01, 0, 0.02]\n");
  const Vec3 x(3.0, -20.0, 7.0), v(0.4, 0.3, -0.2);
  c.add("dumbbell", {.position = x, .velocity = v, .angular_velocity = {0.0, 0.0, 0.3}});
  c.begin();
  const Vec3 spin = c.state.bodies.spin[0];
  c.advance(2000);
  const double t = c.state.clock.time();
  const Vec3 rate(-0.01, 0.0, 0.02), stretch = (t * rate).array().exp();
  EXPECT_EQ(c.state.box.edge, Vec3(c.state.strain.edge(t)));
  EXPECT_LT((c.state.box.edge - Vec3(40, 50, 60).cwiseProduct(stretch)).norm(), 1e-12);
  EXPECT_LT((c.state.bodies.velocity[0] - v.cwiseQuotient(stretch)).norm(), 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    const double r = rate[axis];  // x' = v exp(-r t) + r x
    const double own = r == 0.0 ? v[axis] * t : v[axis] * std::sinh(r * t) / r;
    EXPECT_NEAR(c.state.bodies.position[0][axis], x[axis] * stretch[axis] + own,
                1e-8);  // the step is second order
  }
  EXPECT_EQ(c.state.bodies.spin[0], spin);
}

TEST(Box, StrainEndsAtThePackingFractionAskedFor) {
  Case c("[box]\nsize = [10, 10, 10]\n", "strain_rate = [-0.1, -0.1, -0.1]\npacking = 0.005\n");
  c.add("sphere", {.position = {1.0, 2.0, 3.0}});
  c.begin();
  const double end = std::log(0.005 / (4.0 / 3.0 * kPi / 1000.0)) / 0.3;
  while (c.state.clock.time() < 1.5 * end) c.advance(1);
  EXPECT_NEAR(packing_fraction(c.physics, c.state.box), 0.005, 1e-14);
  EXPECT_EQ(c.state.box.rate, Vec3(Vec3::Zero()));
  const Vec3 edge = c.state.box.edge;
  c.advance(10);
  EXPECT_EQ(c.state.box.edge, edge);
}

TEST(Box, TooSmallOrTooWideOrTooFastIsRefused) {
  Case small("[box]\nsize = [5, 20, 20]\n", "");
  small.add("sphere", {});
  EXPECT_THROW(small.begin(), InputError);
  Case shrinking("[box]\nsize = [7, 20, 20]\n", "strain_rate = [-1, 0, 0]\n");
  shrinking.add("sphere", {});
  shrinking.begin();
  EXPECT_THROW(shrinking.advance(100000), UnstableError);
  Case growing("[box]\nsize = [7, 20, 20]\n", "strain_rate = [0, 10, 0]\n");
  growing.add("sphere", {});
  growing.begin();
  EXPECT_THROW(growing.advance(100000), UnstableError);
  EXPECT_LT(growing.state.box.edge.y(), 2e12);
  Case fast("[box]\nsize = [9, 20, 20]\n", "strain_rate = [0, 0, -1e3]\n");
  fast.add("sphere", {});
  EXPECT_THROW(fast.begin(), InputError);  // of one step
  Case away("[box]\nsize = [9, 20, 20]\n", "strain_rate = [1, 0, 0]\npacking = 0.5\n");
  away.add("sphere", {});
  EXPECT_THROW(away.begin(), InputError);
}

}  // namespace
}  // namespace cairn
