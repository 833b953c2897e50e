// Makes the dense frictional packings that bench_step times: bodies with random orientations on a loose
// lattice in a periodic box, thrown about, squeezed without friction and left to settle with it.
#include <cstdio>
#include <map>

#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"
#include "core/runtime.h"
#include "pile/cloud.h"
#include "shape/library.h"
#include "sim/run.h"

namespace cairn {
namespace {

struct Recipe {
  std::string shape;
  std::uint32_t side;       ///< of the lattice, bodies
  double size_max = 1.0;    ///< m; sizes follow a power law of exponent -3 from 1 m up to this
  double gathered, packed;  ///< volume fractions reached quickly, and slowly
};

const std::map<std::string, Recipe> kRecipes{
    {"few_spheres", {"sphere", 16, 1.0, 0.56, 0.642}},
    {"spheres", {"sphere", 34, 1.0, 0.56, 0.642}},
    {"few_tetrahedra", {"tetrahedron", 10, 1.0, 0.56, 0.64}},
    {"tetrahedra", {"tetrahedron", 21, 1.0, 0.56, 0.64}},
    {"cubes", {"cube", 17, 1.0, 0.46, 0.57}},
    {"needles", {"needle", 15, 1.0, 0.20, 0.32}},
    {"sizes", {"sphere", 37, 8.0, 0.58, 0.72}},
};

std::string scene_text(const Recipe& recipe, double edge, double filling) {
  const double gather = std::log(recipe.gathered / filling) / 3.0 / 0.05;
  const double press = std::log(recipe.packed / recipe.gathered) / 3.0 / 0.006;
  return fmt::format(R"(title = "packing for benchmarks"
[box]
size = [{0}, {0}, {0}]
[[body]]
shape = "{1}"
density = 2500
material = "nominal"
[[material]]
name = "nominal"
cohesion = 100
[[material]]
name = "smooth"
restitution_normal = 0.3
friction = 0
friction_rolling = 0
friction_twisting = 0
[contact]
stiffness = 1e7
overlap_limit = 0.9   # large spheres meet small ones
[gravity]
method = "none"
[[stage]]
name = "gather"
duration = {2}
material = "smooth"
strain_rate = [-0.05, -0.05, -0.05]
packing = {4}
[[stage]]
name = "press"
duration = {3}
material = "smooth"
strain_rate = [-0.006, -0.006, -0.006]
packing = {5}
[[stage]]
name = "rest"
duration = 3
)",
                     edge, recipe.shape, gather + 0.2, press + 0.2, recipe.gathered, recipe.packed);
}

/// Interleaves the bits of three small numbers: near cells get near numbers.
std::uint32_t interleaved(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
  std::uint32_t code = 0;
  for (int bit = 0; bit < 10; ++bit)
    code |= (i >> bit & 1) << (3 * bit) | (j >> bit & 1) << (3 * bit + 1) | (k >> bit & 1) << (3 * bit + 2);
  return code;
}

void pack(const Recipe& recipe, const std::filesystem::path& path) {
  Setup setup;
  const RigidShape shape = make_rigid(load_shape(recipe.shape, "."), MassModel::union_volume);
  const double step = 2.4 * shape.bounding_radius * recipe.size_max;
  CloudSpec sizes;
  sizes.distribution = SizeDistribution::power_law;
  sizes.size = 1.0;
  sizes.size_max = recipe.size_max;
  std::map<std::uint32_t, Vec3> places;
  for (std::uint32_t k = 0; k < recipe.side; ++k)
    for (std::uint32_t j = 0; j < recipe.side; ++j)
      for (std::uint32_t i = 0; i < recipe.side; ++i) places[interleaved(i, j, k)] = step * Vec3(i, j, k);
  Random random(1, 0);
  double volume = 0.0;
  for (const auto& [code, place] : places) {
    const double size = recipe.size_max > 1.0 ? draw_size(sizes, random.uniform()) : 1.0;
    add_body(setup.bodies, shape, 0, size, 2500.0, 0,
             {.position = place,
              .orientation = random.rotation(),
              .velocity = 1.0 * random.direction(),
              .angular_velocity = 0.1 * random.direction()});
    volume += shape.volume * size * size * size;
  }
  const double edge = step * recipe.side;
  setup.box.edge = Vec3::Constant(edge);
  setup.shapes = {recipe.shape};
  Scene scene = parse_scene(scene_text(recipe, edge, volume / (edge * edge * edge)), path.string(), ".");
  RunAttributes attributes{
      .title = scene.title, .scene = scene.text, .directory = ".", .version = CAIRN_VERSION, .seed = 1};
  Run run(scene, std::move(setup), ResultFile::create(path, attributes.table(), true));
  run.advance({.watch = [](const Run& r) {
    const Clock& clock = r.state().clock;
    std::printf("\rstage %d, step %d of %d ", static_cast<int>(clock.stage), static_cast<int>(clock.step),
                static_cast<int>(clock.steps));
    return std::fflush(stdout) == 0;
  }});
  std::printf(
      "\r%zu spheres, %.2f contacts per sphere, largest overlap %.3g\n", run.sphere_count(),
      2.0 * static_cast<double>(run.state().contacts.contacts()) / static_cast<double>(run.sphere_count()),
      run.state().ledger.recent_overlap);
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  cairn::tune_runtime(argv);
  if (argc != 3 || !cairn::kRecipes.contains(argv[1])) {
    std::fputs("usage: bench_packing [few_]spheres|[few_]tetrahedra|cubes|needles|sizes FILE.h5\n", stderr);
    return 2;
  }
  try {
    cairn::pack(cairn::kRecipes.at(argv[1]), argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "\nerror: %s\n", error.what());
    return 1;
  }
  return 0;
}
