// Whole steps of settled packings, every phase and every set of contact features: million sphere-steps per
// second. The packings are made by bench_packing; the folder that holds them is the first argument.
#include <benchmark/benchmark.h>

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "body/columns.h"
#include "core/instruction_set.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/runtime.h"
#include "core/timer.h"
#include "pile/assemble.h"
#include "sim/step.h"

namespace cairn {
namespace {

const std::map<std::string, std::string> kMaterials{
    {"normal", "friction = 0\nfriction_rolling = 0\nfriction_twisting = 0\n"},
    {"friction", "friction_rolling = 0\nfriction_twisting = 0\n"},
    {"whole", ""},
    {"cohesion", "cohesion = 100\n"}};

constexpr std::array<int, 3> kOne{1, 1, 1};

/// Copies of the bodies side by side, without contacts; the box grows with them.
Setup tiled(const Setup& setup, const std::array<int, 3>& tiles) {
  Setup out;
  Bodies& all = out.bodies;
  const Bodies& one = setup.bodies;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (int i = 0; i < tiles[0]; ++i)
    for (int j = 0; j < tiles[1]; ++j)
      for (int k = 0; k < tiles[2]; ++k) {
        Bodies copy = one;
        const auto bodies = static_cast<std::uint32_t>(all.size()),
                   spheres = static_cast<std::uint32_t>(all.spheres.size());
        for (Vec3& x : copy.position) x += setup.box.edge.cwiseProduct(Vec3(i, j, k));
        for (std::uint32_t& b : copy.spheres.body) b += bodies;
        for (std::uint32_t& s : copy.first_sphere) s += spheres;
        if (!all.first_sphere.empty()) all.first_sphere.pop_back();
        append(all.first_sphere, copy.first_sphere);
        for_each_body_column(append, all, copy);
        for_each_sphere_column(append, all.spheres, copy.spheres);
      }
  out.box.edge = setup.box.edge.cwiseProduct(Vec3(tiles[0], tiles[1], tiles[2]));
  out.k_n = setup.k_n;
  return out;
}

/// What a pile can be but a quiet packing.
enum class Unrest { none, cloud, debris };
const std::map<Unrest, std::string> kUnrest{{Unrest::cloud, "cloud"}, {Unrest::debris, "debris"}};

/// A cloud: thrice as far from each other, and on their way by 0.002 radii a step. Debris: one body of a
/// hundred flies away from the rest by 0.1 radii a step.
void disturb(Unrest unrest, double dt, Bodies& bodies) {
  Random random(1, 0);
  const double radius = bodies.spheres.radius.front();
  if (unrest == Unrest::cloud)
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      bodies.position[b] *= 3.0;
      bodies.velocity[b] = 0.002 * radius / dt * random.direction();
    }
  if (unrest == Unrest::debris) {
    Vec3 centre = Vec3::Zero();
    for (const Vec3& x : bodies.position) centre += x / static_cast<double>(bodies.size());
    double size = 0.0;
    for (const Vec3& x : bodies.position) size = std::max(size, (x - centre).norm());
    for (std::size_t b = 0; b < bodies.size(); b += 100) {
      const double z = 1.0 - 2.0 * (static_cast<double>(b) + 0.5) / static_cast<double>(bodies.size());
      const double angle = 0.024 * static_cast<double>(b);  // spreads them evenly
      const Vec3 out(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
      bodies.position[b] = centre + 1.5 * size * out;
      bodies.velocity[b] = 0.1 * radius / dt * out;
    }
  }
  place_spheres(bodies);
}

/// A packing as it was left by its build, with the material's springs as they come.
struct Packing {
  Scene scene;
  State state;
  Scratch scratch;
  Physics physics;

  /// `tiles` copies of the pile in each direction.
  Packing(const std::string& pile, const std::string& material, const std::array<int, 3>& tiles,
          Unrest unrest = Unrest::none) {
    const std::string text =
        "pile = \"" + pile +
        "\"\n[box]\nsize = [0, 0, 0]\n[gravity]\nmethod = \"none\"\n[[material]]\nname = "
        "\"nominal\"\n" +
        kMaterials.at(material) +
        "[[material]]\nname = \"smooth\"\n[[stage]]\nname = \"bench\"\nduration = "
        "1e6\nmaterial = \"nominal\"\n[contact]\nstiffness = 1e7\noverlap_limit = 0.3\n";
    scene = parse_scene(text, "bench.toml", ".");
    Setup setup = assemble(scene);
    if (tiles != kOne) setup = tiled(setup, tiles);
    state = first_state(setup);
    use_threads_for(state.bodies.spheres.size());
    physics = resolve_physics(scene, 0, state.bodies, *scene.contact.stiffness);
    state.clock.dt = physics.contacts.dt;
    if (unrest != Unrest::none) {
      state.box = {};
      setup.contacts.clear();
      disturb(unrest, state.clock.dt, state.bodies);
    }
    begin_stage(physics, setup.contacts, state, scratch);
    for (int k = 0; k < 8; ++k) scratch.candidates.adapt_skin(2000, {});  // as in a pile long at rest
    prepare_scratch(physics, state, scratch);
  }
};

/// A pile, how often in each direction, and what the copies are called.
struct Tiling {
  std::string pile;
  std::array<int, 3> tiles;
  std::string name;
};
const std::vector<Tiling> kTilings{{"few_spheres", {3, 1, 1}, "few_spheres_x3"},
                                   {"spheres", {3, 3, 3}, "spheres_x27"}};

/// Of all threads.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Bytes that the program holds at the moment.
double bytes_held() {
  const struct mallinfo2 heap = mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd);
}

void whole_step(benchmark::State& run, const std::string& pile, const std::string& material,
                const std::array<int, 3>& tiles, Unrest unrest) {
  const double held = bytes_held();
  Packing packing(pile, material, tiles, unrest);
  const double spheres = static_cast<double>(packing.state.bodies.spheres.size());
  const double before = static_cast<double>(packing.state.contacts.contacts());
  for (int k = 0; k < 20; ++k) step(packing.physics, packing.state, packing.scratch);
  // Of each phase the tenth part of the steps that took least: other jobs interrupt the rest.
  std::array<std::vector<double>, kPhaseNames.size() + 1> seconds;
  std::vector<double> cpu;
  for (auto _ : run) {
    packing.scratch.times = {};
    const double start = wall_seconds(), start_cpu = cpu_seconds();
    step(packing.physics, packing.state, packing.scratch);
    cpu.push_back(cpu_seconds() - start_cpu);
    seconds.back().push_back(wall_seconds() - start);
    for (std::size_t k = 0; k < kPhaseNames.size(); ++k) seconds[k].push_back(packing.scratch.times[k]);
  }
  const auto quick = [&](std::vector<double>& all) {
    const auto tenth = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 10);
    std::nth_element(all.begin(), tenth, all.end());
    return *tenth / spheres;
  };
  run.counters["M/s"] = 1e-6 / quick(seconds.back());
  // Steps that search are not among the quickest: their share counts where something flies.
  run.counters["M/s_mean"] =
      benchmark::Counter(1e-6 * spheres, benchmark::Counter::kIsIterationInvariantRate);
  run.counters["M/cpu_s"] = 1e-6 / quick(cpu);
  run.counters["contacts"] = 2.0 * static_cast<double>(packing.state.contacts.contacts()) / spheres;
  run.counters["contacts_before"] = 2.0 * before / spheres;
  run.counters["candidates"] = 2.0 * static_cast<double>(packing.state.contacts.slots()) / spheres;
  run.counters["bytes"] = (bytes_held() - held) / spheres;
  for (std::size_t k = 0; k < 3; ++k)
    run.counters[std::string(kPhaseNames[k]) + "_ns"] = 1e9 * quick(seconds[k]);
}

/// The pull of one perturber on the packing.
void perturber(benchmark::State& run, const std::string& pile) {
  Packing packing(pile, "whole", kOne);
  packing.physics.perturbers = {{"Earth", 4e14, 0.0, true, Vec3(2e7, 1e7, 0.0)}};
  for (auto _ : run) add_perturbers(packing.physics, 1.0, packing.state, packing.scratch.perturbers);
  run.counters["M_spheres/s"] =
      benchmark::Counter(1e-6 * static_cast<double>(packing.state.bodies.spheres.size()),
                         benchmark::Counter::kIsIterationInvariantRate);
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  cairn::tune_runtime(argv);
  cairn::obey_environment();
  benchmark::Initialize(&argc, argv);
  if (argc != 2) {
    std::fputs("usage: bench_step FOLDER [benchmark options]: a folder of packings made by bench_packing\n",
               stderr);
    return 2;
  }
  std::vector<std::filesystem::path> piles;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1]))
    if (entry.path().extension() == ".h5") piles.push_back(std::filesystem::absolute(entry.path()));
  std::sort(piles.begin(), piles.end());
  for (const auto& pile : piles) {
    const std::string name = pile.stem().string() + "/";
    for (const auto& [material, text] : cairn::kMaterials)
      benchmark::RegisterBenchmark((name + material).c_str(), cairn::whole_step, pile.string(), material,
                                   cairn::kOne, cairn::Unrest::none)
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    for (const cairn::Tiling& t : cairn::kTilings)
      if (t.pile == pile.stem())
        for (const auto& [material, text] : cairn::kMaterials)
          benchmark::RegisterBenchmark((t.name + "/" + material).c_str(), cairn::whole_step, pile.string(),
                                       material, t.tiles, cairn::Unrest::none)
              ->Unit(benchmark::kMillisecond)
              ->UseRealTime();
    for (const auto& [unrest, text] : cairn::kUnrest)
      benchmark::RegisterBenchmark((name + text).c_str(), cairn::whole_step, pile.string(), "cohesion",
                                   cairn::kOne, unrest)
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    benchmark::RegisterBenchmark((name + "perturber").c_str(), cairn::perturber, pile.string())
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
