// What the error of gravity and the interval between its evaluations do to physics: energy and angular
// momentum over a collapse, and the critical spin period of a pile of 1500 spheres, for several piles made
// from different seeds. Writes a section of BENCHMARKS.md to the standard output; progress goes to the
// standard error.
//   gravity_study FOLDER [PILES]     result files stay in FOLDER, so that a study that was stopped goes on
#include "bench/study.h"

namespace cairn {
namespace {

const std::vector<Setting> kSettings{
    {"direct sum, every step", "[gravity]\nmethod = 'direct'\ninterval = 1"},
    {"direct sum, every 10 steps", "[gravity]\nmethod = 'direct'\ninterval = 10"},
    {"direct sum, every 100 steps", "[gravity]\nmethod = 'direct'\ninterval = 100"},
    {"direct sum, every 1000 steps", "[gravity]\nmethod = 'direct'\ninterval = 1000"},
    {"error 1e-1, auto", "[gravity]\nerror = 1e-1"},
    {"error 1e-2, auto", "[gravity]\nerror = 1e-2"},
    {"error 1e-3, auto (default)", "[gravity]\nerror = 1e-3"},
    {"error 1e-4, auto", "[gravity]\nerror = 1e-4"},
    {"error 1e-6, auto", "[gravity]\nerror = 1e-6"},
};

void study(const std::filesystem::path& folder, int piles) {
  Study s(std::filesystem::absolute(folder));
  const auto name = [](const char* what, int seed, std::size_t k) {
    return fmt::format("{}-{}-{}", what, seed, k);
  };
  fmt::print(
      "A cloud of 1500 spheres of 8 to 12 m falls together and settles. Energy: what of kinetic, "
      "gravitational and "
      "elastic energy and dissipated work is not found again, over |W|.\n\n"
      "| gravity | steps between evaluations | energy astray | drift of L | drift of momentum | cost, s |\n"
      "|---|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < kSettings.size(); ++k) {
    const Outcome o = s.run(name("collapse", 1, k), collapse_scene(1, kSettings[k].tables));
    fmt::print("| {} | {:.0f} | {:.1e} | {:.1e} | {:.1e} | {:.0f} |\n", kSettings[k].name, o.interval,
               o.energy, o.angular, o.momentum, o.cost);
  }
  constexpr std::size_t kDefault = 6;
  for (int seed = 1; seed <= piles; ++seed)
    s.run(name("collapse", seed, kDefault), collapse_scene(seed, kSettings[kDefault].tables));
  fmt::print(
      "\nThe piles that settled under the default, spun up from 5 h to 3.5 h in 1500 s and by 0.6 s/s from "
      "there until "
      "c/a has fallen by 1 %. Critical period in hours for each pile; the last columns are the mean "
      "difference to the "
      "direct sum at every step on the same pile, and its scatter.\n\n| gravity |");
  for (int seed = 1; seed <= piles; ++seed) fmt::print(" pile {} |", seed);
  fmt::print(" difference | scatter | steps between evaluations | cost, s |\n|---|");
  for (int seed = 1; seed <= piles; ++seed) fmt::print("---|");
  fmt::print("---|---|---|---|\n");
  std::vector<double> reference;
  for (std::size_t k = 0; k < kSettings.size(); ++k) {
    fmt::print("| {} |", kSettings[k].name);
    Differences differences;
    double cost = 0.0, interval = 0.0;
    for (int seed = 1; seed <= piles; ++seed) {
      const Outcome o = s.run(name("spin", seed, k),
                              spin_scene(name("collapse", seed, kDefault) + ".h5", kSettings[k].tables));
      const double period = o.period / 3600.0;
      if (k == 0) reference.push_back(period);
      differences.add(period - reference[static_cast<std::size_t>(seed - 1)]);
      cost += o.cost / piles;
      interval += o.interval / piles;
      fmt::print(" {:.3f} |", period);
    }
    fmt::print(" {:+.3f} | {:.3f} | {:.0f} | {:.0f} |\n", differences.mean(), differences.scatter(), interval,
               cost);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace cairn

int main(int count, char** arguments) {
  if (count < 2) {
    fmt::print(stderr, "usage: gravity_study FOLDER [PILES]\n");
    return 2;
  }
  cairn::study(arguments[1], count > 2 ? std::atoi(arguments[2]) : 4);
}
