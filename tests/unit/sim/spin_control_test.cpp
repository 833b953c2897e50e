// The pile on its path, what belongs to it, and the verdict that it has failed.
#include "sim/spin_control.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/spin_state.h"
#include "shape/library.h"
#include "stage.h"

namespace cairn {
namespace {

/// Four balls of density 2000 in a tetrahedron, looked at every 10 s along a path given by keys.
struct Pile : Stage {
  explicit Pile(const std::string& keys, double speed = 0.0)
      : Stage(
            "[[body]]\nshape = 'sphere'\ndensity = 2000\n[contact]\nstiffness = 1e6\n[gravity]\nmethod = "
            "'direct'\n[[stage]]\nname = 'spin'\nduration = 10000\ntime_step = 10\n[stage.spin]\n" +
            keys + "\n[output]\n") {
    scene.contact.unsafe_time_step = true;
    const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
    for (const Vec3& x :
         {Vec3(1.2, 0.0, 0.0), Vec3(-0.6, 1.05, 0.0), Vec3(-0.6, -1.05, 0.0), Vec3(0.0, 0.0, height)})
      add_body(state.bodies, ball, 0, 1.0, 2000.0, 0,
               {.position = x, .velocity = speed * Vec3(x.y(), x.z(), x.x())});
    begin();
  }
  /// The next step, led by hand: the top ball at this height.
  void look(double z) {
    ++state.clock.step;
    state.bodies.position[3].z() = z;
    place_spheres(state.bodies);
    control_spin(physics, scratch.everyone, state);
  }
  static constexpr double height = 1.7;
};

constexpr const char* kHeld =
    "path = [[0, 1e5]]\naxis_drop = 0.1\naxis_hold = 50\ncheck_interval = 10\nremnant_gap = 5";

TEST(SpinControl, AFallCountsWhenItLasts) {
  Pile pile(kHeld);
  pile.state.region_volume = 20.0;
  const Control& control = pile.state.control;
  EXPECT_TRUE(control.settled);
  const double whole = control.start_ratio;
  for (int k = 0; k < 4; ++k) pile.look(1.2);  // for 30 s only
  EXPECT_FALSE(control.failed);
  EXPECT_EQ(control.fall_time, 10.0);
  pile.look(Pile::height);  // and back
  EXPECT_LT(control.fall_time, 0.0);
  EXPECT_EQ(pile.state.region_volume, 20.0);
  for (int k = 0; k < 5; ++k) pile.look(1.2);
  EXPECT_FALSE(control.failed);
  pile.look(1.1);
  EXPECT_TRUE(control.failed);               // 50 s after it began
  EXPECT_EQ(pile.state.region_volume, 0.0);  // the shape it was cut to is gone
  EXPECT_FALSE(control.active);
  EXPECT_EQ(control.failure_time, 60.0);
  EXPECT_EQ(control.failure_period, 1e5);
  EXPECT_LT(control.failure_ratio, 0.9 * whole);
  EXPECT_EQ(control.limit_ratio, 0.9 * whole);
  pile.look(Pile::height);  // the verdict stays
  EXPECT_EQ(control.failure_time, 60.0);
}

TEST(SpinControl, NoFallCountsBeforeThePileHasBeenAtRest) {
  Pile pile(kHeld, 1e-3);  // some times its speed of escape
  const Control& control = pile.state.control;
  EXPECT_FALSE(control.settled);
  EXPECT_EQ(control_warnings(pile.physics, pile.state).size(), 2u);  // not at rest, and a jump of the spin
  for (int k = 0; k < 10; ++k) pile.look(1.2);
  EXPECT_FALSE(control.settled);
  for (Vec3& v : pile.state.bodies.velocity) v.setZero();
  for (Vec3& l : pile.state.bodies.spin) l.setZero();
  pile.look(1.2);
  EXPECT_TRUE(control.settled);
  EXPECT_EQ(control.start_time, 110.0);
  for (int k = 0; k < 20; ++k) pile.look(1.2);  // its shape at rest
  EXPECT_FALSE(control.failed);
}

TEST(SpinControl, SpinGoesOverSmoothlyInTheRamp) {
  Pile pile("path = [[0, 1e5]]\nramp = 400\ncheck_interval = 1e4\nremnant_gap = 5");
  EXPECT_TRUE(control_warnings(pile.physics, pile.state).empty());
  const auto rate = [&] {
    return 2.0 * kPi /
           spin_period(spin_state(pile.state.bodies, all_bodies(pile.state.bodies)), Vec3::UnitZ());
  };
  for (int k = 1; k <= 50; ++k) {
    pile.look(Pile::height);
    const double u = std::min(1.0, 10.0 * k / 400.0);
    EXPECT_NEAR(rate(), 2.0 * kPi / 1e5 * u * u * (3.0 - 2.0 * u), 1e-12 * 2.0 * kPi / 1e5);
    EXPECT_EQ(pile.state.control.shortest_period, k < 40 ? 0.0 : 1e5);
  }
}

TEST(SpinControl, LooksOftenEnoughToKnowTheFailurePeriodToAThousandthOfAnHour) {
  const std::string path = "path = [[0, 18000], [1000, 17000], [3000, 17000], [7000, 10000], [9000, 9990]]\n";
  Pile pile(path + "remnant_gap = 5");
  double before = 18000.0;
  std::uint64_t looks = 0;
  for (int k = 1; k <= 1000; ++k) {
    const std::uint64_t due = pile.state.control.next_check;
    pile.look(Pile::height);
    if (pile.state.clock.step < due) continue;
    ++looks;
    const double now = target_period(pile.physics, pile.state.control, pile.state.clock.stage_time());
    // A step of 10 s changes the period by up to 17.5 s; else 3.6 s, and the step in which that is reached.
    EXPECT_LE(std::abs(now - before), 17.6);
    if (k > 710) {
      EXPECT_LE(std::abs(now - before), 3.6);
    }
    before = now;
  }
  EXPECT_LT(looks, 650u);  // rarely while the path rests: a twentieth of 1/sqrt(4 pi G rho / 3), 66 s
}

TEST(SpinControl, APileThatLosesAGrainIsSpunWithoutIt) {
  Pile pile("path = [[0, 1e5]]\ncheck_interval = 10\nremnant_gap = 0.5");
  EXPECT_EQ(pile.state.remnant, (std::vector<std::uint8_t>{1, 1, 1, 1}));
  pile.look(4.0);
  EXPECT_EQ(pile.state.remnant, (std::vector<std::uint8_t>{1, 1, 1, 0}));
  pile.look(Pile::height);
  EXPECT_EQ(pile.state.remnant, (std::vector<std::uint8_t>{1, 1, 1, 1}));
}

}  // namespace
}  // namespace cairn
