#include <fmt/core.h>

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

/// Seconds per step of stage 0, from a short trial on a copy of the bodies, no longer than the stage.
double time_step_cost(const std::vector<Wall>& walls, const Setup& setup, const Physics& physics) {
  State state;
  state.bodies = setup.bodies;
  state.shift = setup.shift;
  state.box = setup.box;
  state.remnant.assign(state.bodies.size(), 1);
  state.walls.walls = walls;
  Scratch scratch;
  begin_stage(physics, setup.contacts, state, scratch);
  state.clock.dt = physics.contacts.dt;
  const auto most = std::min<std::uint64_t>(physics.steps, 1000);
  double start = wall_seconds();
  std::uint64_t steps = 0;
  for (std::uint64_t k = 0; k < most && (steps == 0 || wall_seconds() - start < 0.5); ++k) {
    step(physics, state, scratch);
    ++steps;
    if (k == 0 && most > 1) {  // it warms up
      start = wall_seconds();
      steps = 0;
    }
  }
  return (wall_seconds() - start) / static_cast<double>(steps);
}

void check(const Options& options) {
  Scene scene = load_scene(options.scene);
  load_tracks(scene);
  const Setup setup = assemble(scene);
  const std::vector<Wall> all_walls = make_walls(scene);
  const std::size_t bodies = setup.bodies.size(), spheres = setup.bodies.spheres.size();
  use_threads_for(spheres);
  double mass = 0.0;
  for (double m : setup.bodies.mass) mass += m;
  fmt::print("{}: {}\n{} bodies, {} spheres, {:.4g} kg; escape speed of the pile {:.3g} m/s\n",
             options.scene.string(), scene.title, bodies, spheres, mass, escape_speed(setup.bodies));
  double steps = 0.0, cost = 0.0;
  for (std::size_t k = 0; k < scene.stages.size(); ++k) {
    if (scene.stages[k].operates()) {
      fmt::print("stage {} '{}'\n  operation  {}\n", k, scene.stages[k].name, describe_operation(scene, k));
      continue;
    }
    const std::vector<Wall> walls = walls_of_stage(scene, k, all_walls);
    const Physics physics =
        resolve_physics(scene, k, setup.bodies, resolve_stiffness(scene, k, setup.bodies, walls));
    const bool first = cost == 0.0;
    if (first) cost = time_step_cost(walls, setup, physics);
    steps += static_cast<double>(physics.steps);
    fmt::print(
        "stage {} '{}'\n  models     {}\n  stiffness  {:.4g} N/m; shortest contact {:.4g} s\n"
        "  time step  {:.4g} s (longest safe {:.4g} s), {} steps for {:.6g} s\n",
        k, scene.stages[k].name, describe_models(physics, setup.bodies, !walls.empty(), setup.box.periodic()),
        physics.k_n, physics.contact_time, physics.contacts.dt, kLongestSafeStep * physics.contact_time,
        physics.steps, scene.stages[k].duration);
    if (first)
      for (const std::string& w : warnings(physics, setup.bodies, walls)) fmt::print("  warning    {}\n", w);
  }
  if (steps == 0.0) return;                   // operations only
  constexpr double bytes_per_sphere = 900.0;  // spheres, bodies, and six contacts with their histories
  fmt::print(
      "memory about {:.0f} MB; about {:.3g} min at the speed of the first steps ({:.2f} M sphere-steps/s on "
      "{} threads; dense piles have more contacts than clouds)\n",
      1e-6 * bytes_per_sphere * static_cast<double>(spheres), steps * cost / 60.0,
      1e-6 * static_cast<double>(spheres) / cost, omp_get_max_threads());
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
