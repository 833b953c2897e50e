// Every number of a checkpoint has a range, and nothing is written that is not finite.
#include "sim/check_state.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/error.h"
#include "shape/library.h"
#include "sim/observe.h"

namespace cairn {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Three dumbbells in the middle of the second of three stages, and two of their contacts.
struct Checkpoint {
  State state;
  ContactColumns contacts;
  WallColumns walls;

  Checkpoint() {
    const RigidShape shape = make_rigid(load_shape("dumbbell", "."), MassModel::union_volume);
    for (int b = 0; b < 3; ++b) add_body(state.bodies, shape, 0, 1.0, 1000.0, 0, {.position = Vec3(b, b, 0)});
    state.bodies.remainder.assign(3, Vec3::Zero());
    state.remnant = {1, 0, 1};
    state.clock = {1, 30, 40, 500, 10.0, 0.5};
    state.stage_starts = {0.0, 10.0};
    state.k_n = 1e6;
    state.walls.resize(1);
    state.bodies.held = {0, 0, 1};
    state.held = {
        .motions = {{}}, .body = {2}, .position = {Vec3::Zero()}, .orientation = {Quat::Identity()}};
    for (gravity::Wrenches* w : {&state.gravity.from, &state.gravity.to, &state.gravity.evaluated}) {
      w->force.assign(3, Vec3::Ones());
      w->torque.assign(3, Vec3::Ones());
    }
    state.gravity.places.assign(6, Vec3::Ones());
    state.gravity.steps = 7;
    state.gravity.due = 35;
    state.gravity.interval = 3.5;
    state.control.active = true;
    state.control.next_check = 38;
    contacts.assign({{0, 2, {1.0, 2.0, {3.0, 4.0, 5.0}, {6.0, 7.0, 8.0}, 9.0}},
                     {1, 4, {1.0, 2.0, {3.0, 4.0, 5.0}, {6.0, 7.0, 8.0}, 9.0}}});
  }

  /// What is said of it; empty: nothing.
  std::string fault() {
    try {
      check_pile(state, 1, contacts, checkpoint_fields(state, contacts.table(), walls));
      check_checkpoint(state, 3, 1);
      Physics physics;
      physics.steps = 40;
      physics.contacts.dt = 0.5;
      physics.gravity = GravityMethod::direct;
      physics.spin.emplace().check_interval = 4.0;  // 8 steps
      check_stage(state, physics);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
};

struct Damage {
  const char* said;
  std::function<void(Checkpoint&)> work;
};

TEST(CheckState, RefusesWhatDoesNotFit) {
  ASSERT_EQ(Checkpoint().fault(), "");
  const std::vector<Damage> damages{
      {"as many poses", [](auto& c) { c.state.bodies.position.pop_back(); }},
      {"as many poses", [](auto& c) { c.state.bodies.remainder.clear(); }},
      {"body 1 is not finite", [](auto& c) { c.state.bodies.velocity[1].y() = kNan; }},
      {"body 2 is not finite", [](auto& c) { c.state.bodies.spin[2].x() = kInfinity; }},
      {"body 0 is not finite", [](auto& c) { c.state.bodies.torque[0].z() = kNan; }},
      {"body 1: expected a unit quaternion", [](auto& c) { c.state.bodies.orientation[1].w() = 2.0; }},
      {"body 1: expected a unit quaternion", [](auto& c) { c.state.bodies.orientation[1].x() = 1e300; }},
      {"material", [](auto& c) { c.state.bodies.material[2] = 1; }},
      {"cell", [](auto& c) { c.state.bodies.cell.assign(3, Vec3::Zero()); }},
      {"whole numbers",
       [](auto& c) {
         c.state.bodies.cell.assign(3, Vec3(0.5, 0.0, 0.0));
         c.state.bodies.cell_edge = 8.0;
       }},
      {"spheres 1 and 2147483647 cannot touch", [](auto& c) { c.contacts.j[1] = 2147483647; }},
      {"spheres 2 and 2 cannot touch", [](auto& c) { c.contacts.i[0] = 2; }},
      {"spheres 0 and 1 cannot touch", [](auto& c) { c.contacts.j[0] = 1; }},  // of one body
      {"are not in their order",
       [](auto& c) {
         c.contacts.i[1] = 0;
         c.contacts.j[1] = 2;
       }},
      {"negative damping", [](auto& c) { c.contacts.memory.c_n[1] = -1.0; }},
      {"negative damping", [](auto& c) { c.contacts.memory.c_s[0] = kNan; }},
      {"as many of each", [](auto& c) { c.contacts.memory.roll.pop_back(); }},
      {"contacts/slide of row 1", [](auto& c) { c.contacts.memory.slide[1].x() = kNan; }},
      {"contacts/twist of row 0", [](auto& c) { c.contacts.memory.twist[0] = -kInfinity; }},
      {"clock/stage:", [](auto& c) { c.state.clock.stage = 3; }},
      {"clock/step:", [](auto& c) { c.state.clock.step = 41; }},
      {"clock/steps", [](auto& c) { c.state.clock.steps = std::uint64_t{1} << 60; }},
      {"clock/total_steps", [](auto& c) { c.state.clock.total_steps = 29; }},
      {"clock/stage_start:", [](auto& c) { c.state.clock.stage_start = -1.0; }},
      {"clock/dt", [](auto& c) { c.state.clock.dt = 0.0; }},
      {"clock/dt", [](auto& c) { c.state.clock.dt = kNan; }},
      {"clock/steps, clock/dt", [](auto& c) { c.state.clock.dt = 0.25; }},
      {"one for each stage", [](auto& c) { c.state.stage_starts.pop_back(); }},
      {"times in order", [](auto& c) { c.state.stage_starts[0] = 11.0; }},
      {"times in order", [](auto& c) { c.state.stage_starts[1] = 1e9; }},
      {"as many forces", [](auto& c) { c.state.gravity.from.force.pop_back(); }},
      {"do not belong together", [](auto& c) { c.state.gravity.steps = 0; }},
      {"as many as spheres", [](auto& c) { c.state.gravity.places.pop_back(); }},
      {"gravity/attitude", [](auto& c) { c.state.gravity.attitude.w() = kNan; }},
      {"gravity/interval", [](auto& c) { c.state.gravity.interval = 0.0; }},
      {"times in order", [](auto& c) { c.state.gravity.evaluated_time = 1.0; }},
      {"gravity/due", [](auto& c) { c.state.gravity.due = 38; }},
      {"gravity/due", [](auto& c) { c.state.gravity.due = 29; }},
      {"relaxation", [](auto& c) { c.state.relaxation.pile.assign(3, 0); }},
      {"relaxation", [](auto& c) { c.state.relaxation.look = 0; }},
      {"control/next_check", [](auto& c) { c.state.control.next_check = 39; }},
      {"control/next_check", [](auto& c) { c.state.control.next_check = 30; }},
      {"control/next_check", [](auto& c) { c.state.control.next_check = std::uint64_t(-1); }},
      {"gravity/omega", [](auto& c) { c.state.gravity.omega.x() = kNan; }},
      {"as many as walls", [](auto& c) { c.state.walls.driven.speed.clear(); }},
      {"driven/place", [](auto& c) { c.state.walls.driven.place[0] = kNan; }},
      {"as many poses as held bodies", [](auto& c) { c.state.held.orientation.clear(); }},
      {"held/position", [](auto& c) { c.state.held.position[0].z() = kInfinity; }},
      {"expected unit quaternions", [](auto& c) { c.state.held.orientation[0].w() = 0.5; }},
      {"remnant",
       [](auto& c) {
         c.state.remnant = {0, 0, 0};
       }},
      {"remnant", [](auto& c) { c.state.remnant[0] = 7; }},
      {"box/edge", [](auto& c) { c.state.box.edge.x() = -1.0; }},
      {"strain", [](auto& c) { c.state.strain.until = kNan; }},
      {"region_volume", [](auto& c) { c.state.region_volume = -1.0; }},
      {"stiffness", [](auto& c) { c.state.k_n = -1.0; }},
      {"ledger", [](auto& c) { c.state.ledger.largest_overlap = kNan; }},
      {"ledger/dissipated", [](auto& c) { c.state.ledger.dissipated = kNan; }},
      {"control/failure_time", [](auto& c) { c.state.control.failure_time = kInfinity; }},
      {"frame/velocity", [](auto& c) { c.state.frame.velocity.y() = kNan; }},
  };
  for (const Damage& damage : damages) {
    Checkpoint altered;
    damage.work(altered);
    const std::string said = altered.fault();
    EXPECT_NE(said.find(damage.said), std::string::npos) << damage.said << " expected, found: " << said;
  }
}

/// The line of the UnstableError that `work` throws.
std::string unstable(const std::function<void()>& work) {
  try {
    work();
  } catch (const UnstableError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(CheckState, NothingIsWrittenThatIsNotFinite) {
  Checkpoint c;
  const auto fields = [&] { return checkpoint_fields(c.state, c.contacts.table(), c.walls); };
  EXPECT_EQ(unstable([&] { require_finite(fields(), 12.5); }), "nothing");  // strain/until is infinite
  c.state.bodies.velocity[2].x() = kInfinity;
  EXPECT_EQ(unstable([&] { require_finite(fields(), 12.5); }),
            "velocity of body 2 is not finite at t = 12.5 s");
  c.state.bodies.velocity[2].x() = 0.0;
  c.state.ledger.wall_power = kNan;
  EXPECT_EQ(unstable([&] { require_finite(fields(), 12.5); }),
            "ledger/wall_power is not finite at t = 12.5 s");
}

TEST(CheckState, ARowIsNanOnlyWhereItsColumnSaysSo) {
  const std::vector<SeriesColumn> columns = series_columns();
  std::vector<double> row(columns.size(), 0.0);
  std::size_t may = 0;
  for (std::size_t c = 0; c < row.size(); ++c) {
    row[c] = kNan;
    const std::string said = unstable([&] { require_documented(columns, row, 3.0); });
    may += said == "nothing";
    if (columns[c].name == "kinetic_energy") {
      EXPECT_EQ(said, "kinetic_energy is NaN at t = 3 s");
    }
    if (columns[c].name == "spin_target") {
      EXPECT_EQ(said, "nothing");
    }
    row[c] = 0.0;
  }
  EXPECT_LT(may, 8u);
}

}  // namespace
}  // namespace cairn
