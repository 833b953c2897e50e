#include "app/summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "app/commands.h"
#include "app/result_view.h"

namespace cairn {

namespace {

std::string text(const char* format, double value) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

/// A period; "none" when there is none.
std::string period_text(double seconds) {
  return seconds > 0.0 && std::isfinite(seconds) ? duration_text(seconds) : "none";
}

double last(const ResultView& view, const char* column) {
  const std::vector<double> values = view.series(column);
  return values.empty() ? std::nan("") : values.back();
}

double largest(const ResultView& view, const char* column) {
  double most = 0.0;
  for (double v : view.series(column))
    if (v > most) most = v;
  return most;
}

/// Value of a column in the last row at or before time t (s).
double value_at(const ResultView& view, const char* column, double t) {
  const std::vector<double> times = view.series("time"), values = view.series(column);
  const auto it = std::upper_bound(times.begin(), times.end(), t);
  if (values.empty() || std::isnan(t)) return std::nan("");
  return values[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, it - times.begin() - 1))];
}

/// What spin control says about the pile.
std::string verdict(const Control& control) {
  if (control.start_ratio == 0.0) return "-";
  if (control.failed) return "failed";
  if (!control.settled) return "never at rest";
  return control.fall_time < 0.0 ? "stands" : "c/a has fallen just now";
}

struct Row {
  const char* name;
  std::function<std::string(const ResultView&)> value;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> table{
      {"bodies", [](auto& v) { return fmt::format("{}", v.bodies().size()); }},
      {"spheres", [](auto& v) { return fmt::format("{}", v.bodies().spheres.size()); }},
      {"simulated time", [](auto& v) { return duration_text(v.reached().time); }},
      {"steps", [](auto& v) { return fmt::format("{}", v.reached().steps); }},
      {"shortest period held", [](auto& v) { return period_text(v.control().shortest_period); }},
      {"verdict on the spin-up", [](auto& v) { return verdict(v.control()); }},
      {"failure at period", [](auto& v) { return period_text(v.control().failure_period); }},
      {"failure at time",
       [](auto& v) { return v.control().failed ? duration_text(v.control().failure_time) : "-"; }},
      {"c/a at rest, limit",
       [](auto& v) {
         return v.control().settled
                    ? fmt::format("{:.3f}, {:.3f}", v.control().start_ratio, v.control().limit_ratio)
                    : std::string("-");
       }},
      {"a fall must last",
       [](auto& v) { return v.control().settled ? duration_text(v.control().hold) : "-"; }},
      {"b/a, c/a at the end",
       [](auto& v) {
         return text("{:.3f}", last(v, "b_over_a")) + ", " + text("{:.3f}", last(v, "c_over_a"));
       }},
      {"period at the end", [](auto& v) { return period_text(last(v, "period")); }},
      {"coordination before spin-up",
       [](auto& v) {
         return v.control().settled ? text("{:.2f}", value_at(v, "coordination", v.control().start_time))
                                    : std::string("-");
       }},
      {"coordination at the end", [](auto& v) { return text("{:.2f}", last(v, "coordination")); }},
      {"bodies shed", [](auto& v) { return text("{:.0f}", last(v, "shed_bodies")); }},
      {"mass shed",
       [](auto& v) { return text("{:.2f} %", 100.0 * (1.0 - last(v, "remnant_mass_fraction"))); }},
      {"largest overlap", [](auto& v) { return text("{:.2f} %", 100.0 * largest(v, "largest_overlap")); }},
      {"drift of momentum", [](auto& v) { return text("{:.1e}", last(v, "momentum_drift")); }},
      {"drift of angular momentum",
       [](auto& v) { return text("{:.1e}", last(v, "angular_momentum_drift")); }},
      {"outcome", [](auto& v) { return v.outcome(); }},
  };
  return table;
}

}  // namespace

std::string duration_text(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  const double size = std::abs(seconds);
  if (size < 300.0) return fmt::format("{:.4g} s", seconds);
  if (size < 3600.0) return fmt::format("{:.1f} min", seconds / 60.0);
  if (size < 1e6) return fmt::format("{:.3f} h", seconds / 3600.0);
  return fmt::format("{:.4g} d", seconds / 86400.0);
}

void print_summary(const std::vector<std::filesystem::path>& files) {
  std::vector<ResultView> views;
  for (const auto& file : files) views.emplace_back(file);
  std::size_t width = 12;
  for (const auto& file : files) width = std::max(width, file.stem().string().size() + 2);
  fmt::print("{:<28}", "");
  for (const auto& file : files) fmt::print("{:>{}}", file.stem().string(), width + 8);
  fmt::print("\n");
  for (const Row& row : rows()) {
    fmt::print("{:<28}", row.name);
    for (const ResultView& view : views) fmt::print("{:>{}}", row.value(view), width + 8);
    fmt::print("\n");
  }
}

void print_phase_times(const Run& run, double seconds, std::uint64_t steps) {
  const PhaseTimes& times = run.times();
  const double counted = std::accumulate(times.begin(), times.end(), 0.0);
  fmt::print("{} steps in {:.1f} s: {:.2f} million sphere-steps per second\n", steps, seconds,
             1e-6 * static_cast<double>(steps) * static_cast<double>(run.sphere_count()) / seconds);
  for (std::size_t k = 0; k < times.size(); ++k)
    fmt::print("  {:<10}{:>9.2f} s {:>6.1f} %\n", kPhaseNames[k], times[k],
               100.0 * times[k] / std::max(counted, 1e-9));
}

void add_summary_command(CLI::App& app) {
  auto files = std::make_shared<std::vector<std::filesystem::path>>();
  CLI::App* command = app.add_subcommand("summary", "the numbers of runs, side by side");
  command->add_option("results", *files, "result files")->required();
  command->callback([files] { print_summary(*files); });
}

}  // namespace cairn
