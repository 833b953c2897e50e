// What the studies share: clouds of spheres that collapse, piles that are spun up until they fail, and runs
// that are kept in a folder so that a study that was stopped goes on.
#pragma once

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

inline constexpr const char* kMaterials = R"(
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

struct StudyCloud {
  int count = 1500;
  double size = 8.0, size_max = 12.0;  ///< m
  std::string shape = "sphere";
};

/// A cloud falls together and settles. `tables`: [gravity] and the like.
inline std::string collapse_scene(int seed, const std::string& tables, const StudyCloud& cloud = {}) {
  return fmt::format(R"(
seed = {}
[[cloud]]
count = {}
filling = 0.2
distribution = "uniform"
size = {}
size_max = {}
density = 3000
material = "nominal"
spin_period = 72000
[[cloud.shape]]
shape = "{}"
{}
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
                     seed, cloud.count, cloud.size, cloud.size_max, cloud.shape, kMaterials, tables);
}

/// Such a pile is spun up until c/a has fallen by 1 %.
inline std::string spin_scene(const std::string& pile, const std::string& tables) {
  return fmt::format(R"(
pile = "{}"
{}
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
                     pile, kMaterials, tables);
}

/// A way to run: its name in the tables, and the scene's tables that ask for it.
struct Setting {
  std::string name, tables;
};

/// Differences of several piles.
class Differences {
 public:
  void add(double difference) {
    ++count_;
    sum_ += difference;
    squares_ += difference * difference;
  }
  double mean() const { return sum_ / count_; }
  double scatter() const { return std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean())); }

 private:
  double count_ = 0.0, sum_ = 0.0, squares_ = 0.0;
};

/// What is kept of a run.
struct Outcome {
  double period = 0.0;                   ///< s, at failure
  double energy = 0.0;                   ///< |change of the total + dissipated| over |W| at the end
  double angular = 0.0, momentum = 0.0;  ///< drifts
  double cost = 0.0;                     ///< s of one core
  double interval = 0.0;                 ///< mean number of steps between evaluations of gravity
  double overlap = 0.0;                  ///< the largest
  double steps = 0.0;
  double contacts = 0.0, neighbours = 0.0;  ///< at the end, each counted for both partners
};

inline double total_energy(const Observation& o) {
  return o.kinetic + o.rotational + o.gravitational + o.elastic + o.dissipated - o.control_work;
}

class Study {
 public:
  explicit Study(const std::filesystem::path& folder) : folder_(folder) {
    std::filesystem::create_directories(folder_);
    std::ifstream in(folder_ / "outcomes.txt");
    std::string name;
    for (Outcome o; in >> name >> o.period >> o.energy >> o.angular >> o.momentum >> o.cost >> o.interval >>
                    o.overlap >> o.steps >> o.contacts >> o.neighbours;)
      done_[name] = o;
  }

  /// The run of scene `text`, or what is known of it.
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
    run.advance({.watch = [&](const Run& r) {
      if (!begun) first = total_energy(r.last_observation());
      begun = true;
      out.interval += static_cast<double>(r.state().gravity.steps);
      ++samples;
      return true;
    }});
    const Observation& o = run.last_observation();
    out.period = run.state().control.failure_period;
    out.energy = std::abs((total_energy(o) - first) / o.gravitational);
    out.angular = o.angular_drift;
    out.momentum = o.momentum_drift;
    out.cost = wall_seconds() - start;
    out.interval /= samples;
    out.overlap = run.state().ledger.largest_overlap;
    out.steps = static_cast<double>(run.state().clock.total_steps);
    out.contacts = 2.0 * o.contacts;
    out.neighbours = 2.0 * o.touching_bodies;
    std::ofstream(folder_ / "outcomes.txt", std::ios::app) << fmt::format(
        "{} {} {} {} {} {} {} {} {} {} {}\n", name, out.period, out.energy, out.angular, out.momentum,
        out.cost, out.interval, out.overlap, out.steps, out.contacts, out.neighbours);
    fmt::print(stderr, "{}: T {:.4f} h, energy {:.1e}, L {:.1e}, {:.0f} s\n", name, out.period / 3600.0,
               out.energy, out.angular, out.cost);
    return done_[name] = out;
  }

 private:
  std::filesystem::path folder_;
  std::map<std::string, Outcome> done_;
};

}  // namespace cairn
