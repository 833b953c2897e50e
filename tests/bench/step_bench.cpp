// Whole steps of a dense packing with every contact feature on, no gravity: million sphere-steps per second.
#include <benchmark/benchmark.h>

#include "core/random.h"
#include "shape/library.h"
#include "sim/step.h"

namespace cairn {
namespace {

/// A cubic lattice of bodies, slightly overlapping and slowly jostling: loose spheres touch 6 others; the
/// faces of neighbouring cubes of 8 spheres touch at 4 spheres.
struct Packing {
  Scene scene;
  State state;
  Scratch scratch;
  Physics physics;

  Packing(const char* shape, double spacing, int side) {
    Bodies& bodies = state.bodies;
    const RigidShape rigid = make_rigid(load_shape(shape), MassModel::union_volume);
    Random random(1, 0);
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          add_body(bodies, rigid, 0, 1.0, 2500.0, 0,
                   {.position = spacing * Vec3(i, j, k),
                    .velocity = 1e-5 * random.direction(),
                    .angular_velocity = 1e-5 * random.direction()});
    state.remnant.assign(bodies.size(), 1);
    Material material;
    material.cohesion = 100.0;
    scene.materials = {material};
    scene.contact.stiffness = 1e8;
    scene.gravity.method = GravityMethod::none;
    scene.stages.resize(1);
    scene.stages[0].duration = 1.0;
    physics = resolve_physics(scene, 0, bodies, *scene.contact.stiffness);
    begin_stage(physics, {}, state, scratch);
  }
};

void whole_step(benchmark::State& run, const char* shape, double spacing, int side) {
  Packing packing(shape, spacing, side);
  for (auto _ : run) step(packing.physics, packing.state, packing.scratch);
  const double spheres = static_cast<double>(packing.state.bodies.spheres.size());
  double contacts = 0.0;
  for (std::size_t slot = 0; slot < packing.state.contacts.slots(); ++slot)
    contacts += packing.state.contacts.touching(slot);
  run.counters["M_sphere_steps/s"] =
      benchmark::Counter(1e-6 * spheres, benchmark::Counter::kIsIterationInvariantRate);
  run.counters["contacts_per_sphere"] = 2.0 * contacts / spheres;
}

BENCHMARK_CAPTURE(whole_step, spheres_40000, "sphere", 1.9995, 34)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(whole_step, cubes_5000, "cube", 3.73155, 17)->Unit(benchmark::kMillisecond)->UseRealTime();

/// The pull of one perturber on the packing.
void perturber(benchmark::State& run, const char* shape, double spacing, int side) {
  Packing packing(shape, spacing, side);
  packing.physics.perturbers = {{"Earth", 4e14, 0.0, true, Vec3(2e7, 1e7, 0.0)}};
  for (auto _ : run) add_perturbers(packing.physics, 1.0, packing.state, packing.scratch.perturbers);
  run.counters["M_spheres/s"] =
      benchmark::Counter(1e-6 * static_cast<double>(packing.state.bodies.spheres.size()),
                         benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK_CAPTURE(perturber, spheres_40000, "sphere", 1.9995, 34)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(perturber, cubes_5000, "cube", 3.73155, 17)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace cairn

BENCHMARK_MAIN();
