// What the error of gravity and the interval between its evaluations do to physics: energy and angular
// momentum over a collapse, and the critical spin period of a pile of 1500 spheres, for several piles made
// from different seeds. Writes a section of BENCHMARKS.md to the standard output; progress goes to the
// standard error.
//   gravity_study FOLDER [PILES]     result files stay in FOLDER, so that a study that was stopped goes on
#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "core/parallel.h"
#include "core/timer.h"
#include "pile/assemble.h"
#include "sim/run.h"

namespace cairn {
namespace {

struct Setting {
  std::string name, gravity;
};

const std::vector<Setting> kSettings{
    {"direct sum, every step", "method = 'direct'\ninterval = 1"},
    {"direct sum, every 10 steps", "method = 'direct'\ninterval = 10"},
    {"direct sum, every 100 steps", "method = 'direct'\ninterval = 100"},
    {"direct sum, every 1000 steps", "method = 'direct'\ninterval = 1000"},
    {"error 1e-1, auto", "error = 1e-1"},
    {"error 1e-2, auto", "error = 1e-2"},
    {"error 1e-3, auto (default)", "error = 1e-3"},
    {"error 1e-4, auto", "error = 1e-4"},
    {"error 1e-6, auto", "error = 1e-6"},
};

constexpr const char* kMaterials = R"(
[[material]]
name = "nominal"
restitution_normal = 0.55
restitution_tangential = 0.55
friction = 1.0
friction_rolling = 1.05
friction_twisting = 1.3
[[material]]
name = "sticky"
restitution_normal = 0.1
restitution_tangential = 0.1
friction = 0.3
friction_rolling = 0.3
friction_twisting = 0.3
)";

std::string collapse_scene(int seed, const std::string& gravity) {
  return fmt::format(R"(
seed = {}
[[cloud]]
count = 1500
filling = 0.2
distribution = "uniform"
size = 8
size_max = 12
density = 3000
material = "nominal"
spin_period = 72000
[[cloud.shape]]
shape = "sphere"
{}
[gravity]
{}
[[stage]]
name = "collapse"
duration = 6500
material = "sticky"
impact_speed = 0.1
[[stage]]
name = "settle"
duration = 1500
impact_speed = 0.02
[output]
series_interval = 100
)",
                     seed, kMaterials, gravity);
}

std::string spin_scene(const std::string& pile, const std::string& gravity) {
  return fmt::format(R"(
pile = "{}"
{}
[gravity]
{}
[[stage]]
name = "spin-up"
duration = 9000
impact_speed = 0.02
[stage.spin]
path = [[0, 18000], [1500, 12600], [9000, 8000]]
after_failure = 0
[output]
series_interval = 10
)",
                     pile, kMaterials, gravity);
}

/// What is kept of a run.
struct Outcome {
  double period = 0.0;                   ///< s, at failure
  double energy = 0.0;                   ///< |change of the total + dissipated| over |W| at the end
  double angular = 0.0, momentum = 0.0;  ///< drifts
  double cost = 0.0;                     ///< s of one core
  double interval = 0.0;                 ///< mean number of steps between evaluations
};

double total_energy(const Observation& o) {
  return o.kinetic + o.rotational + o.gravitational + o.elastic + o.dissipated;
}

class Study {
 public:
  explicit Study(const std::filesystem::path& folder) : folder_(folder) {
    std::filesystem::create_directories(folder_);
    std::ifstream in(folder_ / "outcomes.txt");
    std::string name;
    for (Outcome o; in >> name >> o.period >> o.energy >> o.angular >> o.momentum >> o.cost >> o.interval;)
      done_[name] = o;
  }

  Outcome run(const std::string& name, const std::string& text) {
    if (const auto it = done_.find(name); it != done_.end()) return it->second;
    const std::filesystem::path path = folder_ / (name + ".h5");
    Scene scene = parse_scene(text, name, folder_);
    RunAttributes attributes{
        .title = name, .scene = text, .directory = folder_, .version = "", .seed = scene.seed};
    ResultFile results = ResultFile::create(path, attributes.table(), true);
    Setup setup = assemble(scene);
    use_threads_for(setup.bodies.spheres.size());
    Run run(std::move(scene), std::move(setup), std::move(results));
    const double start = wall_seconds();
    Outcome out;
    double first = 0.0, samples = 0.0;
    bool begun = false;
    run.advance([&](const Run& r) {
      if (!begun) first = total_energy(r.last_observation());
      begun = true;
      out.interval += static_cast<double>(r.state().gravity.steps);
      ++samples;
      return true;
    });
    const Observation& o = run.last_observation();
    out.period = run.state().control.failure_period;
    out.energy = std::abs((total_energy(o) - o.control_work - first) / o.gravitational);
    out.angular = o.angular_drift;
    out.momentum = o.momentum_drift;
    out.cost = wall_seconds() - start;
    out.interval /= samples;
    std::ofstream(folder_ / "outcomes.txt", std::ios::app)
        << fmt::format("{} {} {} {} {} {} {}\n", name, out.period, out.energy, out.angular, out.momentum,
                       out.cost, out.interval);
    fmt::print(stderr, "{}: T {:.4f} h, energy {:.1e}, L {:.1e}, {:.0f} s\n", name, out.period / 3600.0,
               out.energy, out.angular, out.cost);
    return done_[name] = out;
  }

 private:
  std::filesystem::path folder_;
  std::map<std::string, Outcome> done_;
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
    const Outcome o = s.run(name("collapse", 1, k), collapse_scene(1, kSettings[k].gravity));
    fmt::print("| {} | {:.0f} | {:.1e} | {:.1e} | {:.1e} | {:.0f} |\n", kSettings[k].name, o.interval,
               o.energy, o.angular, o.momentum, o.cost);
  }
  constexpr std::size_t kDefault = 6;
  for (int seed = 1; seed <= piles; ++seed)
    s.run(name("collapse", seed, kDefault), collapse_scene(seed, kSettings[kDefault].gravity));
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
    double mean = 0.0, square = 0.0, cost = 0.0, interval = 0.0;
    for (int seed = 1; seed <= piles; ++seed) {
      const Outcome o = s.run(name("spin", seed, k),
                              spin_scene(name("collapse", seed, kDefault) + ".h5", kSettings[k].gravity));
      const double period = o.period / 3600.0;
      if (k == 0) reference.push_back(period);
      const double difference = period - reference[static_cast<std::size_t>(seed - 1)];
      mean += difference / piles;
      square += difference * difference / piles;
      cost += o.cost / piles;
      interval += o.interval / piles;
      fmt::print(" {:.3f} |", period);
    }
    fmt::print(" {:+.3f} | {:.3f} | {:.0f} | {:.0f} |\n", mean,
               std::sqrt(std::max(0.0, square - mean * mean)), interval, cost);
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
