#include <fmt/core.h>

#include <optional>

#include "app/commands.h"
#include "contact/stiffness.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/timer.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "sim/make_perturbers.h"
#include "sim/make_walls.h"
#include "sim/run.h"

namespace cairn {

namespace {

struct Options {
  std::filesystem::path scene;
  bool keys = false;
};

/// Wall-clock seconds that a step and a row of the series take.
struct Cost {
  double step = 0.0, row = 0.0;
};

/// From a short trial of a stage on these bodies, no longer than the stage. At first gravity is evaluated
/// more often than later.
Cost try_steps(const Scene& scene, const Physics& physics, const std::vector<ContactRecord>& contacts,
               State& state) {
  constexpr double kWarmUp = 0.5, kTrial = 1.5;  // s
  Scratch scratch;
  begin_stage(physics, contacts, state, scratch);
  state.clock.dt = physics.contacts.dt;
  state.control.active = physics.spin.has_value();
  const auto& radii = state.bodies.spheres.radius;
  const double link_gap = scene.output.remnant_gap * *std::min_element(radii.begin(), radii.end());
  observe(physics, state, scratch, link_gap);
  double start = wall_seconds();
  observe(physics, state, scratch, link_gap);
  Cost cost{.row = wall_seconds() - start};
  std::uint64_t left = std::min<std::uint64_t>(physics.steps, 1000);
  const auto run = [&](std::uint64_t most, double seconds) {
    start = wall_seconds();
    std::uint64_t steps = 0;
    for (; steps < most && (steps == 0 || wall_seconds() - start < seconds); ++steps)
      step(physics, state, scratch);
    left -= steps;
    return (wall_seconds() - start) / static_cast<double>(steps);
  };
  cost.step = run((left + 1) / 2, kWarmUp);
  if (left > 0) cost.step = run(left, kTrial);
  return cost;
}

State state_of(const Setup& setup) {
  State state;
  state.bodies = setup.bodies;
  state.shift = setup.shift;
  state.box = setup.box;
  state.k_n = setup.k_n;
  state.region_volume = setup.region_volume;
  state.remnant.assign(state.bodies.size(), 1);
  return state;
}

double coordination(const State& state) {
  double contacts = 0.0;
  for (std::size_t slot = 0; slot < state.contacts.slots(); ++slot) contacts += state.contacts.touching(slot);
  return 2.0 * contacts / static_cast<double>(state.bodies.spheres.size());
}

void check(const Options& options) {
  Scene scene = load_scene(options.scene);
  load_tracks(scene);
  const Setup setup = assemble(scene);
  const std::vector<Wall> all_walls = make_walls(scene);
  State state = state_of(setup);  // what is tried out changes no other stage's checks
  std::vector<ContactRecord> contacts = setup.contacts;
  use_threads_for(state.bodies.spheres.size());
  double mass = 0.0;
  for (double m : setup.bodies.mass) mass += m;
  fmt::print("{}: {}\n{} bodies, {} spheres, {:.4g} kg; escape speed of the pile {:.3g} m/s\n",
             options.scene.string(), scene.title, setup.bodies.size(), setup.bodies.spheres.size(), mass,
             escape_speed(setup.bodies));
  std::optional<Bodies> tried;  // the bodies of the first stage that takes time
  Cost cost;
  double seconds = 0.0, touching = 0.0;
  for (std::size_t k = 0; k < scene.stages.size(); ++k) {
    if (scene.stages[k].operates()) {
      fmt::print("stage {} '{}'\n  operation  {}\n", k, scene.stages[k].name, describe_operation(scene, k));
      if (!tried) {
        operate(scene, k, state, contacts);
        place_spheres(state.bodies);
        state.remnant.assign(state.bodies.size(), 1);
      }
      continue;
    }
    const std::vector<Wall> walls = walls_of_stage(scene, k, all_walls);
    const Bodies& bodies = tried ? *tried : state.bodies;
    const Physics physics = resolve_physics(scene, k, bodies, resolve_stiffness(scene, k, bodies, walls));
    const bool first = !tried;
    if (first) {
      tried = state.bodies;
      state.walls.walls = walls;
      cost = try_steps(scene, physics, contacts, state);
      touching = coordination(state);
    }
    seconds += static_cast<double>(physics.steps) *
               (cost.step + cost.row * std::min(1.0, physics.contacts.dt / physics.series_interval));
    fmt::print(
        "stage {} '{}'\n  models     {}\n  stiffness  {:.4g} N/m; shortest contact {:.4g} s\n"
        "  time step  {:.4g} s (longest safe {:.4g} s), {} steps for {:.6g} s\n",
        k, scene.stages[k].name, describe_models(physics, *tried, !walls.empty(), setup.box.periodic()),
        physics.k_n, physics.contact_time, physics.contacts.dt, kLongestSafeStep * physics.contact_time,
        physics.steps, scene.stages[k].duration);
    if (first)
      for (const std::string& w : warnings(physics, *tried, walls)) fmt::print("  warning    {}\n", w);
  }
  if (!tried) return;                         // operations only
  constexpr double bytes_per_sphere = 900.0;  // spheres, bodies, and six contacts with their histories
  const auto spheres = static_cast<double>(tried->spheres.size());
  fmt::print(
      "memory about {:.0f} MB; about {:.3g} min at the speed of the first steps ({:.2f} M sphere-steps/s on "
      "{} threads{})\n",
      1e-6 * bytes_per_sphere * spheres, seconds / 60.0, 1e-6 * spheres / cost.step, omp_get_max_threads(),
      touching < 2.0 ? "; dense piles have more contacts than clouds" : "");
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
