#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "analysis/budget.h"
#include "app/commands.h"
#include "contact/stiffness.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/timer.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "pile/outlook.h"
#include "sim/make_perturbers.h"
#include "sim/make_walls.h"
#include "sim/run.h"
#include "sim/spin_control.h"
#include "sim/warnings.h"

namespace cairn {

namespace {

struct Options {
  std::filesystem::path scene;
  bool keys = false;
};

/// What a short trial of a stage tells.
struct Trial {
  double step = 0.0, row = 0.0;  ///< wall-clock seconds of a step and of a row of the series
  double coordination = 0.0;     ///< contacts per sphere
  std::vector<std::string> warnings;
  StartEnergy start;  ///< of the contacts
};

/// On a copy of the state, no longer than the stage. At first gravity is evaluated more often than later.
Trial try_stage(const Scene& scene, std::size_t stage, const Physics& physics,
                const std::vector<ContactRecord>& contacts, const FormerStage* former, State state) {
  constexpr double kWarmUp = 0.5, kTrial = 1.5;  // s
  Scratch scratch;
  place_spheres(state.bodies);
  const HeldBefore held =
      held_before(scene, stage, physics, state, contacts, former ? &former->physics : nullptr);
  scene.sources.at(fmt::format("stage[{}]", stage),
                   [&] { begin_stage(physics, contacts, state, scratch, former); });
  state.clock.dt = physics.contacts.dt;
  begin_control(physics, state);
  Trial trial;
  trial.warnings = control_warnings(physics, state);
  const double gap = link_gap(scene, state.bodies);
  const Observation first = observe(physics, state, scratch, gap);
  trial.coordination = first.coordination;
  trial.start = start_energy(physics, state, first, held);
  double start = wall_seconds();
  observe(physics, state, scratch, gap);
  trial.row = wall_seconds() - start;
  std::uint64_t left = std::min<std::uint64_t>(physics.steps, 1000);
  const auto run = [&](std::uint64_t most, double seconds) {
    start = wall_seconds();
    std::uint64_t steps = 0;
    for (; steps < most && (steps == 0 || wall_seconds() - start < seconds); ++steps)
      step(physics, state, scratch);
    left -= steps;
    return (wall_seconds() - start) / static_cast<double>(steps);
  };
  trial.step = run((left + 1) / 2, kWarmUp);
  if (left > 0) trial.step = run(left, kTrial);
  return trial;
}

/// Bytes that a stage adds to the result file.
double output_size(const Physics& physics, const Bodies& bodies) {
  const auto bodies_count = static_cast<double>(bodies.size()),
             spheres = static_cast<double>(bodies.spheres.size());
  const double time = static_cast<double>(physics.steps) * physics.contacts.dt;
  const auto times = [&](double interval) {
    return interval > 0.0 ? time / std::max(interval, physics.contacts.dt) + 2.0 : 2.0;
  };
  return times(physics.snapshot_interval) * (105.0 * bodies_count + 26.0 * spheres) +
         times(physics.series_interval) * 8.0 * static_cast<double>(series_columns().size());
}

void check(const Options& options) {
  Scene scene = load_scene(options.scene);
  load_tracks(scene);
  Setup setup = assemble(scene);
  std::vector<ContactRecord> contacts = std::move(setup.contacts);
  const std::optional<FormerStage> of_pile = std::move(setup.former);
  std::optional<Physics> former;
  if (of_pile) former = of_pile->physics;
  const std::vector<std::string> notes = std::move(setup.notes), lost = std::move(setup.warnings);
  const std::vector<std::string> wall_sets = setup.wall_sets;
  State state = first_state(std::move(setup));
  state.walls.sets = touching_walls(scene, wall_sets);
  const Bodies& bodies = state.bodies;
  std::vector<Wall> all_walls = make_walls(scene);
  lead_walls(state.wall_lead, all_walls);
  use_threads_for(bodies.spheres.size());
  const double held_kg = held_mass(bodies);
  fmt::print(
      "{}: {}\n{} bodies, {} spheres, {:.4g} kg{}; escape speed of the pile {:.3g} m/s\n",
      options.scene.string(), scene.title, bodies.size(), bodies.spheres.size(),
      budget(bodies).mass + held_kg,
      state.held.empty() ? "" : fmt::format(", {} of them held, {:.4g} kg", state.held.body.size(), held_kg),
      escape_speed(bodies));
  for (const std::string& note : scene.files.notes()) fmt::print("mesh         {}\n", note);
  for (const std::string& note : notes) fmt::print("pile         {}\n", note);
  for (const std::string& what : lost) fmt::print("warning      {}\n", what);
  std::optional<Trial> trial;  // of the first stage that takes time; the bodies after it are not known
  double seconds = 0.0, held = state.k_n, output = 0.0;  // bytes of snapshots and of the series
  const std::vector<std::vector<std::string>> looks_wrong = operation_warnings(scene, state);
  std::vector<std::string> said;
  const auto warn = [&](const std::vector<std::string>& all) {
    for (const std::string& w : all) {
      if (std::find(said.begin(), said.end(), w) != said.end()) continue;
      fmt::print("  warning    {}\n", w);
      said.push_back(w);
    }
  };
  for (std::size_t k = 0; k < scene.stages.size(); ++k) {
    if (scene.stages[k].operates()) {
      fmt::print("stage {} '{}'\n  operation  {}\n", k, scene.stages[k].name, describe_operation(scene, k));
      warn(looks_wrong[k]);
      if (trial) continue;
      operate(scene, k, state, contacts);
      former.reset();
      place_spheres(state.bodies);
      continue;
    }
    const Walls walls = walls_of_stage(scene, k, all_walls, state.walls.driven);
    const Stiffness stiffness = resolve_stiffness(scene, k, bodies, walls, held);
    const double k_n = stiffness.k_n;
    const Physics physics = resolve_physics(scene, k, bodies, k_n);
    const bool first = !trial;
    if (first) {
      set_walls(scene, k, all_walls, std::vector<double>(k + 1, 0.0), state.walls);
      try {
        trial = try_stage(scene, k, physics, contacts, former ? &*of_pile : nullptr, state);
      } catch (const UnstableError& error) {
        trial.emplace().warnings = {
            fmt::format("a short trial of the stage ends by itself: {}", error.what())};
      }
    }
    seconds += static_cast<double>(physics.steps) *
               (trial->step + trial->row * std::min(1.0, physics.contacts.dt / physics.series_interval));
    output += output_size(physics, bodies);
    fmt::print("stage {} '{}'\n  models     {}\n", k, scene.stages[k].name,
               describe_models(physics, bodies, !walls.empty(), state.box.periodic()));
    if (physics.can_touch)
      fmt::print(
          "  stiffness  {:.4g} N/m, {}\n"
          "  contact    {:.4g} s at shortest, the {}; softer contacts, a heavier smallest body or fewer "
          "steps_per_contact lengthen the step\n",
          physics.k_n, stiffness.why, physics.contact_time, physics.shortest_contact);
    if (physics.stiffest > physics.softest)
      fmt::print("  pairs      {:.4g} to {:.4g} N/m, by their materials\n", physics.softest,
                 physics.stiffest);
    fmt::print("  time step  {:.4g} s{}, {} steps for {:.6g} s\n", physics.contacts.dt,
               physics.can_touch
                   ? fmt::format(" (longest safe {:.4g} s)", kLongestSafeStep * physics.contact_time)
                   : "",
               physics.steps, scene.stages[k].duration + scene.stages[k].extension);
    warn(first ? warnings(physics, bodies, walls) : lasting_warnings(physics));
    if (first) warn(trial->warnings);
    if (first && trial->start.counts())
      fmt::print("  {}    {}\n", physics.relax ? "energy " : "warning",
                 describe(trial->start, scene, bodies));
    const double stiffer = former && !first ? stiffening(former->contacts, physics.contacts) : 1.0;
    if (stiffer > 2.0 && physics.gravity != GravityMethod::none && !physics.relax)
      fmt::print(
          "  warning    contacts become {:.3g} times stiffer than they are and push the pile apart at "
          "first; a stage with relax = {{}} takes that out\n",
          stiffer);
    held = k_n;
    if (physics.can_touch) former = physics;
  }
  if (!trial) return;  // operations only
  // At the peak, with six contacts a sphere: while a checkpoint is written (see tests/BENCHMARKS.md).
  constexpr double program = 3e7, bytes_per_sphere = 1500.0;
  const auto spheres = static_cast<double>(bodies.spheres.size());
  fmt::print(
      "memory up to {:.0f} MB; about {:.3g} min at the speed of the first steps ({:.2f} M sphere-steps/s on "
      "{} threads{})\n",
      1e-6 * (program + bytes_per_sphere * spheres + std::min(output, 1.0 * kMostWaiting)), seconds / 60.0,
      1e-6 * spheres / trial->step, omp_get_max_threads(),
      trial->coordination < 2.0 ? "; dense piles have more contacts than clouds" : "");
}

}  // namespace

void add_check_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("check", "validate a scene and tell what it requires; changes nothing");
  CLI::Option* scene = command->add_option("scene", options->scene, "scene file (TOML)");
  CLI::Option* keys =
      command->add_flag("--keys", options->keys, "print the reference of all scene keys instead");
  command->callback([=] {
    if (scene->empty() && keys->empty()) throw CLI::RequiredError("scene");
    if (options->keys)
      fmt::print("{}", scene_reference());
    else
      naming(options->scene.string(), [&] { check(*options); });
  });
}

}  // namespace cairn
