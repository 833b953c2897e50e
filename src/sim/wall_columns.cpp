#include "sim/wall_columns.h"

#include <fmt/format.h>

#include <limits>

namespace cairn {

std::vector<SeriesColumn> run_columns(const Scene& scene) {
  constexpr const char* kNow = "by the bodies, as it acted in the step; NaN while the wall is not there";
  constexpr const char* kMean =
      "mean since the row before, the impulse over the time; at the start of a stage the value of the "
      "moment; "
      "NaN while the wall is not there";
  std::vector<SeriesColumn> out = series_columns();
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const auto add = [&](const char* what, const char* unit, const std::string& help) {
      for (const char axis : {'x', 'y', 'z'})
        out.push_back({fmt::format("wall_{}_{}_{}", wall_name(scene, w), what, axis), unit, help});
    };
    add("force", "N", fmt::format("on the wall {}", kNow));
    add("torque", "N m", fmt::format("on the wall about its rotation point {}", kNow));
    add("mean_force", "N", fmt::format("on the wall, {}", kMean));
    add("mean_torque", "N m", fmt::format("on the wall about its rotation point, {}", kMean));
    if (!scene.walls[w].load) continue;
    out.push_back({fmt::format("wall_{}_displacement", wall_name(scene, w)), "m",
                   "of a wall under a load, along load_axis, since the start"});
    out.push_back({fmt::format("wall_{}_speed", wall_name(scene, w)), "m/s", "along load_axis"});
  }
  return out;
}

std::vector<double> run_row(const Scene& scene, const Observation& observation, const State& state) {
  std::vector<double> out = row(observation);
  const WallLoads& loads = state.walls.loads;
  const double elapsed = state.clock.time() - loads.since;
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const bool there = has_wall(scene, state.clock.stage, w);
    const auto add = [&](const Vec3& value) {
      for (const double v : value) out.push_back(there ? v : std::numeric_limits<double>::quiet_NaN());
    };
    const auto mean = [&](const Vec3& now, const Vec3& sum) -> Vec3 {
      return elapsed > 0.0 ? Vec3(sum / elapsed) : now;
    };
    add(loads.force[w]);
    add(loads.torque[w]);
    add(mean(loads.force[w], loads.impulse[w]));
    add(mean(loads.torque[w], loads.angular_impulse[w]));
    if (!scene.walls[w].load) continue;
    out.push_back(state.walls.driven.place[w]);
    out.push_back(state.walls.driven.speed[w]);
  }
  return out;
}

}  // namespace cairn
