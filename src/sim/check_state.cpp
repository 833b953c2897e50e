#include "sim/check_state.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "analysis/fragments.h"
#include "core/error.h"
#include "sim/spin_control.h"

namespace cairn {
namespace {

void require(bool good, std::string_view what) {
  if (!good) throw InputError("checkpoint: {}", what);
}

void check_cells(const Bodies& bodies) {
  constexpr double kLargest = 9e15;  // whole numbers up to here are exact
  const double edge = bodies.cell_edge;
  require(std::isfinite(edge) && edge >= 0.0, "cell_edge: expected 0 or more");
  if (bodies.cell.empty()) return;
  require(bodies.cell.size() == bodies.size() && edge > 0.0, "cell: expected as many as bodies, and an edge");
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vec3& cell = bodies.cell[b];
    if (!(cell.cwiseAbs().maxCoeff() < kLargest) || cell != Vec3(cell.array().round()))
      throw InputError("checkpoint: cell of body {}: expected whole numbers", b);
  }
}

void check_clock(const Clock& clock, const std::vector<double>& starts, std::size_t stages) {
  require(clock.stage < stages, "clock/stage: expected a stage of the scene");
  require(clock.step <= clock.steps, "clock/step: expected no more than clock/steps");
  require(clock.step <= clock.total_steps, "clock/total_steps: expected no fewer than clock/step");
  require(std::isfinite(clock.stage_start) && clock.stage_start >= 0.0,
          "clock/stage_start: expected a time from 0 s");
  require(std::isfinite(clock.dt) && (clock.dt > 0.0 || clock.steps == 0),
          "clock/dt: expected more than 0 s");
  // A last stage that takes no time has begun, too.
  require(starts.size() == clock.stage + 1 || (starts.size() == clock.stage && clock.steps == 0),
          "clock/stage_starts: expected one for each stage so far");
  require(std::ranges::all_of(starts, [](double t) { return std::isfinite(t) && t >= 0.0; }) &&
              std::ranges::is_sorted(starts) && (starts.empty() || starts.back() <= clock.time()),
          "clock/stage_starts: expected times in order");
}

void check_gravity(const State& state) {
  const gravity::HeldGravity& held = state.gravity;
  const std::size_t n = state.bodies.size();
  for (const gravity::Wrenches* w : {&held.from, &held.to, &held.evaluated})
    for (const std::size_t rows : {w->force.size(), w->torque.size()})
      require(rows == 0 || rows == n, "gravity: expected as many forces as bodies");
  require(held.from.force.empty() == (held.steps == 0) &&
              held.evaluated.force.size() >= held.to.force.size() &&
              held.evaluated.torque.size() >= held.to.torque.size() &&
              (held.to.force.empty() || held.to.torque.size() == held.from.torque.size()),
          "gravity: forces that do not belong together");
  require(held.places.empty() || held.places.size() == state.bodies.spheres.size(),
          "gravity/evaluated/places: expected as many as spheres");
  require(std::abs(held.attitude.norm() - 1.0) < 1e-9, "gravity/attitude: expected a unit quaternion");
  require(held.interval >= 0.0 && (held.to.force.empty() || held.interval > 0.0),
          "gravity/interval: expected more than 0 s");
  require(held.evaluated_time <= held.time && held.miss >= 0.0 && held.scale >= 0.0 && held.factor >= 0.0 &&
              held.error >= 0.0,
          "gravity: expected times in order, and no negative sizes");
}

}  // namespace

void check_motion(const Bodies& bodies, std::size_t materials) {
  const std::size_t n = bodies.size();
  for (const std::size_t rows :
       {bodies.position.size(), bodies.remainder.size(), bodies.velocity.size(), bodies.orientation.size(),
        bodies.spin.size(), bodies.force.size(), bodies.torque.size()})
    require(rows == n, "expected as many poses as bodies");
  check_cells(bodies);
  for (std::size_t b = 0; b < n; ++b) {
    if (bodies.material[b] >= materials)
      throw InputError("bodies/material: body {} has a material that is not in the file", b);
    for (const Vec3* v : {&bodies.position[b], &bodies.remainder[b], &bodies.velocity[b], &bodies.spin[b],
                          &bodies.force[b], &bodies.torque[b]})
      if (!v->allFinite()) throw InputError("checkpoint: the motion of body {} is not finite", b);
    if (!(std::abs(bodies.orientation[b].norm() - 1.0) < 1e-6))
      throw InputError("checkpoint/orientation: body {}: expected a unit quaternion", b);
  }
}

void check_contacts(const ContactColumns& contacts, const Bodies& bodies) {
  const auto& [i, j, memory] = contacts;
  for (const std::size_t rows : {j.size(), memory.c_n.size(), memory.c_s.size(), memory.slide.size(),
                                 memory.roll.size(), memory.twist.size()})
    require(rows == i.size(), "contacts: expected as many of each column");
  const std::vector<std::uint32_t>& body = bodies.spheres.body;
  for (std::size_t k = 0; k < i.size(); ++k) {
    const auto fail = [&](const char* what) {
      throw InputError("checkpoint/contacts: spheres {} and {} {}", i[k], j[k], what);
    };
    if (i[k] >= j[k] || j[k] >= body.size() || body[i[k]] == body[j[k]]) fail("cannot touch");
    if (k > 0 && std::pair(i[k - 1], j[k - 1]) >= std::pair(i[k], j[k])) fail("are not in their order");
    if (!(memory.c_n[k] >= 0.0 && memory.c_s[k] >= 0.0)) fail("have a negative damping");
  }
}

void check_pile(const State& state, std::size_t materials, const ContactColumns& contacts,
                const FieldTable& fields) {
  check_motion(state.bodies, materials);
  check_contacts(contacts, state.bodies);
  require(state.box.edge.minCoeff() >= 0.0 && state.box.edge.maxCoeff() <= kWidestBox,
          "box/edge: expected 0 or more");
  require(state.region_volume >= 0.0, "region_volume: expected 0 or more");
  require(state.k_n >= 0.0, "stiffness: expected 0 or more");
  if (const std::string what = not_finite(fields); !what.empty())
    throw InputError("checkpoint/{}: not finite", what);
}

void check_checkpoint(const State& state, std::size_t stages, std::size_t walls) {
  const std::size_t n = state.bodies.size();
  const WallLoads& loads = state.walls.loads;
  for (const auto* column : {&loads.force, &loads.torque, &loads.impulse, &loads.angular_impulse})
    require(column->size() == walls, "walls: expected as many loads as walls");
  require(state.wall_lead.empty() || state.wall_lead.size() == walls,
          "clock/wall_lead: expected as many times of motion as walls");
  for (const auto* column : {&state.walls.driven.place, &state.walls.driven.speed})
    require(column->size() == walls, "driven: expected as many as walls");
  const HeldBodies& held = state.held;
  require(held.position.size() == held.body.size() && held.orientation.size() == held.body.size(),
          "held: expected as many poses as held bodies");
  require(
      std::ranges::all_of(held.orientation, [](const Quat& q) { return std::abs(q.norm() - 1.0) < 1e-6; }),
      "held/orientation: expected unit quaternions");
  require(state.relaxation.look > 0 && (state.relaxation.pile.empty() || state.relaxation.pile.size() == n) &&
              std::ranges::all_of(state.relaxation.pile,
                                  [n](std::uint32_t p) { return p < n || p == Fragments::kNone; }),
          "relaxation: expected a pile for each body");
  check_clock(state.clock, state.stage_starts, stages);
  check_gravity(state);
  require(state.remnant.size() == n && std::ranges::all_of(state.remnant, [](auto m) { return m <= 1; }) &&
              std::ranges::count(state.remnant, 1) > 0,
          "remnant: expected 0 or 1 for each body, 1 at least once");
  require(state.strain.start.minCoeff() >= 0.0 && state.strain.until >= 0.0, "strain: expected 0 or more");
  const Ledger& ledger = state.ledger;
  require(ledger.largest_overlap >= 0.0 && ledger.recent_overlap >= 0.0, "ledger: a negative overlap");
}

void check_stage(const State& state, const Physics& physics) {
  const Clock& clock = state.clock;
  require(
      clock.steps == physics.steps && clock.dt == physics.contacts.dt,
      "clock/steps, clock/dt: expected those of the stage that the run is in; only later stages of a scene "
      "can be edited");
  const gravity::HeldGravity& held = state.gravity;
  require(physics.gravity == GravityMethod::none ||
              (held.steps > 0 && held.due >= clock.step && held.due - clock.step <= held.steps),
          "gravity/due: expected a step of the present interval");
  const std::uint64_t check = state.control.next_check;
  require(!physics.spin || !state.control.active ||
              (check > clock.step && check - clock.step <= longest_check(physics)),
          "control/next_check: expected a step before the pile has been left alone for too long");
  require(state.relaxation.pile.empty() != physics.relax.has_value(),
          "relaxation/pile: expected in stages that relax, and only there");
}

void require_documented(const std::vector<SeriesColumn>& columns, std::span<const double> row, double time) {
  for (std::size_t c = 0; c < row.size(); ++c) {
    const char* may_be = std::isnan(row[c]) ? "NaN" : std::isinf(row[c]) ? "infinite" : nullptr;
    if (may_be != nullptr && columns[c].help.find(may_be) == std::string::npos)
      throw UnstableError("{} is {} at t = {:.6g} s", columns[c].name, may_be, time);
  }
}

void require_finite(const FieldTable& table, double time) {
  if (const std::string what = not_finite(table); !what.empty())
    throw UnstableError("{} is not finite at t = {:.6g} s", what, time);
}

}  // namespace cairn
