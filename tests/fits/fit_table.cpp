// What a budget of spheres buys: tables and curves for meshes, greedy against best. Run by ../fits.sh.
//   fit_table FOLDER MESH ...       writes FOLDER/fits.md and FOLDER/fit-NAME.svg
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "physics/svg.h"
#include "shape/fit.h"

namespace cairn {
namespace {

constexpr std::size_t kMost = 256;

struct Point {
  double rms = 0.0, seconds = 0.0;
  FitError error;
};

Point measure(const SolidMesh& solid, std::size_t spheres, FitStrategy strategy, MassModel mass) {
  const auto start = std::chrono::steady_clock::now();
  const Shape shape = fit_spheres(solid, {.spheres = spheres, .strategy = strategy, .mass = mass});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {shape.source->error.rms, seconds, shape.source->error};
}

std::string table_of(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const SolidMesh solid = load_solid(path, 1.0);
  const std::string name = path.stem().string();
  report::Curve greedy{"greedy", {}, {}}, best{"best", {}, {}};
  std::string text = fmt::format(
      "\n## {}\n\n{} facets.\n\n| N | greedy RMS | best RMS | greedy(N) / best(N) | greatest, from mesh / "
      "from "
      "spheres | volume | inertia (union) | time (s) |\n|---|---|---|---|---|---|---|---|\n",
      path.filename().string(), solid.surface.triangles.size());
  for (std::size_t n = 1; n <= 2 * kMost; n *= 2) {
    const Point g = measure(solid, n, FitStrategy::greedy, MassModel::mesh);
    greedy.x.push_back(static_cast<double>(n));
    greedy.y.push_back(g.rms);
    if (n > kMost) {
      text += fmt::format("| {} | {:.4f} | | | | | | |\n", n, g.rms);
      break;
    }
    const Point b = measure(solid, n, FitStrategy::best, MassModel::mesh);
    best.x.push_back(static_cast<double>(n));
    best.y.push_back(b.rms);
    text += fmt::format("| {} | {:.4f} | {:.4f} | {:.2f} | {:.3f} / {:.3f} | {:+.4f} | {:.4f} | {:.1f} |\n",
                        n, g.rms, b.rms, g.rms / b.rms, b.error.greatest_from_mesh,
                        b.error.greatest_from_spheres, b.error.volume, b.error.inertia, b.seconds);
  }
  double worst = 0.0;  // best(N) / greedy(2 N) from 16 spheres on
  for (std::size_t k = 4; k < best.y.size(); ++k) worst = std::max(worst, best.y[k] / greedy.y[k + 1]);
  const Point sum = measure(solid, 64, FitStrategy::best, MassModel::spheres);
  text += fmt::format(
      "\nFrom 16 spheres on, RMS of best(N) is at most {:.2f} of greedy(2N). With `--mass spheres`, 64 "
      "spheres: RMS "
      "{:.4f}, greatest inertia error of the sum of spheres {:.4f}.\n\n![RMS against "
      "spheres](validation/fit-{}.svg)\n",
      worst, sum.rms, sum.error.inertia_of_spheres, name);
  std::ofstream(folder / fmt::format("fit-{}.svg", name)) << report::svg(
      {.x = "spheres", .y = "RMS distance of the surfaces / radius", .log_x = true, .log_y = true},
      {greedy, best});
  fmt::print("{}", text);
  return text;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  try {
    std::ofstream out(std::filesystem::path(argv[1]) / "fits.md");
    for (int k = 2; k < argc; ++k) out << cairn::table_of(argv[k], argv[1]) << std::flush;
    return 0;
  } catch (const cairn::InputError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 2;
  }
}
