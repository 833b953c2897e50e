#include "sim/run.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "analysis/budget.h"
#include "core/build.h"
#include "core/error.h"
#include "core/timer.h"
#include "sim/check_state.h"
#include "sim/display.h"
#include "sim/fields.h"
#include "sim/make_perturbers.h"
#include "sim/make_walls.h"
#include "sim/relax.h"
#include "sim/restraints.h"
#include "sim/spin_control.h"
#include "sim/springs.h"
#include "sim/wall_columns.h"
#include "sim/warnings.h"

namespace cairn {

namespace {

/// Whether the step just done is the one nearest to a multiple of the interval (s; 0: never).
bool due(const Clock& clock, double interval) {
  if (interval == 0.0) return false;
  const double step = static_cast<double>(clock.step), steps = clock.dt / interval;
  return std::floor((step + 0.5) * steps) > std::floor((step - 0.5) * steps);
}

/// Commits by time take no more than this part of it.
constexpr double kCommitPart = 0.05;

/// How a file differs from what this program would have written.
std::vector<std::string> foreign(const ResultFile& file, const RunAttributes& attributes) {
  std::vector<std::string> out;
  if (!file.scene_is_as_written())
    out.push_back(
        fmt::format("{}: its scene has been edited since the run began; what follows is by the edited one, "
                    "what was before is not",
                    file.path().string()));
  if (attributes.version != CAIRN_VERSION || attributes.build != build_name())
    out.push_back(
        fmt::format("{}: written by cairn {} ({}), this is {} ({}); what follows need not have the same bits",
                    file.path().string(), attributes.version, attributes.build, CAIRN_VERSION, build_name()));
  return out;
}

}  // namespace

FieldTable RunAttributes::table() {
  return {{"title", "", "of the scene", &title},
          {"scene", "", "text of the scene file", &scene},
          {"directory", "", "where the scene's relative paths start", &directory},
          {"version", "", "of the program", &version},
          {"build", "", "of the program: compiler, instruction set, number", &build},
          {"seed", "", "of the random numbers", &seed}};
}

Run::Run(Scene scene, Setup setup, ResultFile results, Operation operation)
    : Run(std::move(scene), std::move(results), std::move(operation)) {
  shapes_ = setup.shapes;
  write_restraints(results_, setup.held, setup.wall_sets);
  const std::vector<std::string> wall_sets = setup.wall_sets;
  inherited_ = std::move(setup.contacts);
  if (!scene_.stages[0].operates()) former_ = std::move(setup.former);
  state_ = first_state(std::move(setup));
  prepare_bodies();
  walls_ = make_walls(scene_);
  lead_walls(state_.wall_lead, walls_);
  load_tracks(scene_);
  state_.walls.resize(walls_.size());
  state_.walls.sets = touching_walls(scene_, wall_sets);
  check_stages(0);
  const Budget total = budget(state_.bodies);
  state_.ledger.start_momentum = total.momentum;
  state_.ledger.start_angular_momentum = total.angular_momentum_about_center;

  std::vector<std::string> materials;
  for (const Material& m : scene_.materials) materials.push_back(m.name);
  write_constants(results_, state_, shapes_, materials);
  scene_.files.write(results_);
  results_.declare_series(run_columns(scene_));
}

/// A stage that cannot run shall say so now, not after hours.
void Run::check_stages(std::size_t first) const {
  double held = state_.k_n;
  for (std::size_t k = first; k < scene_.stages.size(); ++k) {
    if (scene_.stages[k].operates()) continue;
    held = resolve_stiffness(scene_, k, state_.bodies, walls_of_stage(scene_, k, walls_, state_.walls.driven),
                             held)
               .k_n;
    resolve_physics(scene_, k, state_.bodies, held);
  }
}

std::vector<std::string> Run::warnings() const {
  std::vector<std::string> out;
  double held = state_.k_n;
  for (std::size_t k = 0; k < stages(); ++k) {
    if (scene_.stages[k].operates()) continue;
    const Walls walls = walls_of_stage(scene_, k, walls_, state_.walls.driven);
    held = resolve_stiffness(scene_, k, state_.bodies, walls, held).k_n;
    const Physics physics = resolve_physics(scene_, k, state_.bodies, held);
    for (std::string& line :
         k == 0 ? cairn::warnings(physics, state_.bodies, walls) : lasting_warnings(physics))
      if (std::find(out.begin(), out.end(), line) == out.end()) out.push_back(std::move(line));
  }
  return out;
}

void Run::prepare_bodies() {
  link_gap_ = link_gap(scene_, state_.bodies);
  place_spheres(state_.bodies);
}

Run Run::resume(const std::filesystem::path& path, Operation operation) {
  Run run = load(path, std::move(operation));
  if (run.results_.finished())
    throw InputError("{}: the run has finished; --until or --add makes it longer", path.string());
  return run;
}

Run Run::load(const std::filesystem::path& path, Operation operation) {
  ResultFile results = ResultFile::open_to_continue(path);
  if (results.finished() && results.outcome() != kFinished)
    throw InputError("{}: the run cannot go on, change the scene and run it anew: {}", path.string(),
                     results.outcome());
  RunAttributes attributes;
  results.read_attributes(attributes.table());
  std::vector<std::string> differences = foreign(results, attributes);
  Run run(parse_scene(attributes.scene, path.string(), attributes.directory), std::move(results),
          std::move(operation));
  run.differences_ = std::move(differences);
  State& state = run.state_;
  read_constants(run.results_, state.bodies, run.shapes_);
  ContactColumns contacts;
  WallColumns walls;
  std::vector<std::string> wall_sets;
  read_restraints(run.results_, state.bodies, state.held, wall_sets);
  state.walls.sets = touching_walls(run.scene_, wall_sets);
  const FieldTable fields = checkpoint_fields(state, contacts.table(), walls);
  run.results_.read_checkpoint(fields);
  state.held.list(state.bodies);
  naming(path.string(), [&] {
    check_pile(state, run.scene_.materials.size(), contacts, fields);
    check_checkpoint(state, run.scene_.stages.size(), run.scene_.walls.size());
  });
  run.results_.declare_series(run_columns(run.scene_));
  run.prepare_bodies();
  run.inherited_ = contacts.records();
  run.scene_.files.restore(run.results_);
  run.walls_ = make_walls(run.scene_);
  lead_walls(state.wall_lead, run.walls_);
  state.walls.walls = run.walls_;
  state.walls.contacts = walls.contacts();
  load_tracks(run.scene_);
  try {
    state.walls.check_contacts(run.sphere_count());
  } catch (const InputError& error) {
    throw InputError("{}: checkpoint: {}", path.string(), error.what());
  }
  for (std::size_t k = 0; k < state.clock.stage; ++k) run.epoch_ += run.scene_.stages[k].operates();
  if (run.results_.has_group("stages")) run.results_.read_static("stages", run.stages_done_.table());
  if (state.clock.steps > 0) {  // within a stage; otherwise it is about to begin
    set_walls(run.scene_, state.clock.stage, run.walls_, state.stage_starts, state.walls);
    run.physics_ = resolve_physics(run.scene_, state.clock.stage, state.bodies, state.k_n, state.clock.dt);
    naming(path.string(), [&] { check_stage(state, run.physics_); });
    prepare_scratch(run.physics_, state, run.scratch_);
    state.contacts.restore(std::exchange(run.inherited_, {}));
  }
  return run;
}

/// What every stage begins with.
void Run::begin() {
  state_.stage_starts.resize(state_.clock.stage);
  state_.stage_starts.push_back(state_.clock.time());
  if (state_.ledger.rebase) rebase();
}

/// Lets the drifts of momenta count from here.
void Run::rebase() {
  const Budget total = budget(state_.bodies);
  Ledger& ledger = state_.ledger;
  ledger.start_momentum = total.momentum - ledger.perturbers.momentum - ledger.field_momentum;
  ledger.start_angular_momentum =
      total.angular_momentum_about_center - ledger.control_momentum - ledger.perturbers.angular_momentum;
  ledger.rebase = false;
}

std::string Run::operate() {
  if (!operation_) throw std::logic_error("this run has no operations");
  write_bodies(results_, state_.bodies, fmt::format("_{}", epoch_));
  std::string what = operation_(scene_, state_.clock.stage, state_, inherited_);
  ++epoch_;
  const PhaseTimes times = scratch_.times;
  scratch_ = Scratch();
  scratch_.times = times;
  state_.held.find(state_.bodies, state_.clock.time());
  state_.remnant.assign(state_.bodies.size(), 1);
  state_.ledger.rebase = true;
  prepare_bodies();
  write_bodies(results_, state_.bodies);
  observe_remnant(state_, link_gap_, last_);
  add_snapshot();
  return what;
}

StageReport Run::end_stage(std::string what, double seconds) {
  ScopedTimer timer(scratch_.times[static_cast<std::size_t>(Phase::output)]);
  StageReport report = measure(state_, link_gap_, scene_.output.interior);
  report.name = scene_.stages[state_.clock.stage].name;
  report.what = std::move(what);
  report.seconds = seconds;
  stages_done_.push_back(report);
  results_.write_static("stages", stages_done_.table());
  return report;
}

void Run::start_stage() {
  Clock& clock = state_.clock;
  std::optional<FormerStage> former = former_stage(scene_, clock.stage, state_, walls_);
  if (former) state_.ledger.dissipated += forgotten_energy(scene_, clock.stage, *former, state_, inherited_);
  const bool of_this_run = former && former->same_bodies;
  if (!former) former = std::exchange(former_, {});
  set_walls(scene_, clock.stage, walls_, state_.stage_starts, state_.walls);
  const Stiffness chosen = resolve_stiffness(scene_, clock.stage, state_.bodies, state_.walls, state_.k_n);
  physics_ = resolve_physics(scene_, clock.stage, state_.bodies, chosen.k_n);
  const HeldBefore held =
      held_before(scene_, clock.stage, physics_, state_, inherited_, former ? &former->physics : nullptr);
  scene_.sources.at(fmt::format("stage[{}]", clock.stage), [&] {
    begin_stage(physics_, std::exchange(inherited_, {}), state_, scratch_, former ? &*former : nullptr);
  });
  clock.steps = physics_.steps;
  clock.dt = physics_.contacts.dt;
  begin_control(physics_, state_);
  warn(control_warnings(physics_, state_));
  if (of_this_run && physics_.can_touch)
    state_.ledger.stage_work += elastic_energy(physics_, state_) - held.energy;
  look();
  start_energy_ = cairn::start_energy(physics_, state_, last_, held);
  announce_start(chosen.why);
  if (clock.total_steps == 0 && epoch_ == 0) add_snapshot();
}

void Run::look() {
  ScopedTimer timer(scratch_.times[static_cast<std::size_t>(Phase::output)]);
  last_ = observe(physics_, state_, scratch_, link_gap_);
  state_.ledger.recent_overlap = 0.0;  // a row tells that since the row before
  const std::vector<double> values = run_row(scene_, last_, state_);
  require_documented(results_.series_columns(), values, last_.time);
  results_.add_series_row(values);
  state_.walls.loads.restart(state_.clock.time());
}

void Run::add_snapshot() {
  Display display = make_display(state_, last_.remnant);
  std::vector<std::uint16_t> touching(sphere_count(), 0);
  for (std::size_t slot = 0; slot < state_.contacts.slots(); ++slot)
    if (state_.contacts.touching(slot)) {
      ++touching[state_.contacts.pair(slot).i];
      ++touching[state_.contacts.pair(slot).j];
    }
  for (const WallContact& c : state_.walls.contacts) ++touching[c.sphere];
  if (state_.clock.steps == 0)  // after an operation
    for (const ContactRecord& c : inherited_) {
      ++touching[c.i];
      ++touching[c.j];
    }
  FieldTable table = motion_fields(state_.bodies);
  table.front() = {"position", "m", "centre of mass, from origin", &display.bodies, "body"};
  table.push_back({"origin", "m", "of the positions here, from the zero of /frame", &display.origin});
  table.push_back({"box", "m", "edges of the periodic box; 0: open in that direction", &state_.box.edge});
  table.push_back({"remnant", "", "1: part of the largest remnant", &last_.remnant, "body"});
  table.push_back({"sphere_position", "m",
                   "centre, from origin, for display; in the periodic box the image in it", &display.spheres,
                   "sphere"});
  table.push_back({"sphere_velocity", "m/s", "of the centre, for display", &display.velocities, "sphere"});
  table.push_back({"sphere_contacts", "", "number of touching spheres and walls", &touching, "sphere"});
  table.push_back({"period", "s", "spin period of the largest remnant; infinite without spin", &last_.period,
                   "", Domain::any});
  table.push_back({"failed", "", "the pile has failed", &state_.control.failed});
  require_finite(table, state_.clock.time());
  results_.add_snapshot(state_.clock.time(), scene_.stages[state_.clock.stage].name, table, epoch_);
}

void Run::commit(bool last) {
  ScopedTimer timer(scratch_.times[static_cast<std::size_t>(Phase::output)]);
  const bool within = state_.clock.steps > 0;  // a stage; otherwise contacts wait for the next
  ContactColumns inherited;
  if (!within) inherited.assign(inherited_);
  WallColumns walls;
  walls.assign(within ? state_.walls.numbered_contacts() : state_.walls.contacts);
  const FieldTable table =
      checkpoint_fields(state_, within ? contact_fields(state_.contacts) : inherited.table(), walls);
  require_finite(table, state_.clock.time());
  const double start = wall_seconds();
  if (last)
    results_.finish(table, kFinished);
  else
    results_.commit(table);
  last_commit_ = wall_seconds();
  commit_seconds_ = last_commit_ - start;
  sidecar_.update(results_);
}

RunEnd Run::advance(const Listener& listener) {
  listener_ = listener;
  last_watch_ = last_commit_ = wall_seconds();
  try {
    for (;;) {
      const double start = wall_seconds();
      std::string what;
      if (scene_.stages[state_.clock.stage].operates()) {
        begin();
        what = operate();
      } else {
        if (state_.clock.steps == 0) {
          begin();
          start_stage();
          if (state_.clock.total_steps == 0) commit(false);
        }
        what = follow();
        if (what.empty()) {
          sidecar_.write(results_);
          return RunEnd::interrupted;
        }
      }
      const StageReport done = end_stage(std::move(what), wall_seconds() - start);
      if (listener_.report) listener_.report(done);
      const bool last = state_.clock.stage + 1 == stages();
      if (!last) leave_stage();
      commit(last);
      if (last) return RunEnd::finished;
    }
  } catch (const UnstableError& error) {
    write_break(results_, state_.clock);
    results_.abandon(error.what());  // what was measured until now stays; the checkpoint is the last good one
    sidecar_.update(results_);
    throw;
  }
}

/// Steps to the end of the stage and tells why it is over; empty when the run has been interrupted. What is
/// written on the way depends on the state and never the other way about.
std::string Run::follow() {
  for (;;) {
    const bool had_failed = state_.control.failed;
    step(physics_, state_, scratch_);
    std::string over = why_stage_ends(physics_, state_, scratch_);
    const bool fails = state_.control.failed && !had_failed;
    const bool picture = !over.empty() || fails || due(state_.clock, physics_.snapshot_interval);
    if (picture || due(state_.clock, physics_.series_interval)) look();
    if (picture) add_snapshot();
    if (fails) announce_failure();
    // A checkpoint holds a stage that goes on, or none: what ends it has no second chance after a resume.
    if (!over.empty()) return over;
    if (checkpoint_asked()) {
      commit(false);
      return {};
    }
  }
}

/// Leaves the stage with all that belongs to it: what is left waits for the stiffness and the walls of the
/// next.
void Run::leave_stage() {
  Clock& clock = state_.clock;
  if (clock.steps > 0) {
    inherited_ = state_.contacts.records();
    leave_stiffness(physics_, state_.bodies, inherited_, state_.walls.contacts);
    state_.contacts = ContactList{};
    state_.walls.contacts = state_.walls.numbered_contacts();
    state_.walls.number.clear();
    state_.ledger.field_momentum += clock.stage_time() * physics_.body_mass * physics_.field;
    if (!state_.walls.empty()) state_.ledger.rebase = true;
  }
  state_.gravity = gravity::HeldGravity{};
  state_.relaxation = Relaxation{};
  clock.stage_start = clock.time();
  ++clock.stage;
  clock.step = clock.steps = 0;
}

/// Whether the run is to stop here; checkpoints of a run that goes on are written when their time has come.
bool Run::checkpoint_asked() {
  if (results_.waiting() > kMostWaiting) commit(false);
  const double now = wall_seconds();
  if (now - last_watch_ < listener_.watch_interval) return false;
  last_watch_ = now;
  if (listener_.watch && !listener_.watch(*this)) return true;
  if (now - last_commit_ > std::max(scene_.output.checkpoint_interval, commit_seconds_ / kCommitPart))
    commit(false);
  return false;
}

void Run::announce_start(const std::string& why_so_stiff) const {
  const std::string& name = scene_.stages[state_.clock.stage].name;
  if (listener_.announce)
    listener_.announce(
        physics_.can_touch
            ? fmt::format("stage '{}': stiffness {:.4g} N/m, {}; time step {:.4g} s, shortest contact {:.4g} "
                          "s, the {}",
                          name, physics_.k_n, why_so_stiff, physics_.contacts.dt, physics_.contact_time,
                          physics_.shortest_contact)
            : fmt::format("stage '{}': nothing touches; time step {:.4g} s", name, physics_.contacts.dt));
  if (!start_energy_.counts()) return;
  const std::string line =
      fmt::format("stage '{}': {}", name, describe(start_energy_, scene_, state_.bodies));
  if (!start_energy_.relaxes)
    warn({line});
  else if (listener_.announce)
    listener_.announce(line);
}

void Run::announce_failure() const {
  if (listener_.announce) listener_.announce(describe_failure(state_));
  warn(failure_warnings(physics_, state_));
}

void Run::warn(const std::vector<std::string>& lines) const {
  for (const std::string& line : lines)
    if (listener_.warn) listener_.warn(line);
}

}  // namespace cairn
