#include "app/run_loop.h"

#include <fmt/core.h>
#include <omp.h>
#include <spdlog/spdlog.h>

#include <array>
#include <atomic>
#include <csignal>
#include <optional>

#include "app/status_line.h"
#include "app/summary.h"
#include "core/instruction_set.h"
#include "core/parallel.h"
#include "core/timer.h"

namespace cairn {

namespace {

std::atomic<int> g_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

/// Takes the signals that ask a program to end for as long as it lives; a second one ends it at once. A
/// hang-up that is ignored (nohup) stays so.
class SignalGuard {
 public:
  SignalGuard() {
    struct sigaction action {};
    action.sa_handler = [](int number) { g_signal = number; };
    action.sa_flags = SA_RESETHAND;
    for (std::size_t k = 0; k < kSignals.size(); ++k) {
      sigaction(kSignals[k], &action, &former_[k]);
      if (kSignals[k] == SIGHUP && former_[k].sa_handler == SIG_IGN) sigaction(SIGHUP, &former_[k], nullptr);
    }
  }
  ~SignalGuard() {
    for (std::size_t k = 0; k < kSignals.size(); ++k) sigaction(kSignals[k], &former_[k], nullptr);
  }
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

 private:
  static constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> former_{};
};

std::string clock_text(double seconds) {
  if (!(seconds < 360000.0)) return "--:--";
  const auto s = static_cast<long>(seconds + 0.5);
  return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{:02}:{:02}", s / 60, s % 60);
}

class ProgressBar {
 public:
  void show(const Run& run) {
    const Clock& clock = run.state().clock;
    const double now = wall_seconds();
    if (clock.stage != stage_) {
      stage_ = clock.stage;
      if (const double error = run.state().gravity.error; error > 0.0)
        spdlog::info("stage '{}': the tree's field has an error of {:.1e}", run.scene().stages[stage_].name,
                     error);
      mark_ = now;
      line_.wait();
      mark_step_ = clock.step;
    }
    if (now - mark_ > 1.0) {  // rate over the last seconds
      const double recent = static_cast<double>(clock.step - mark_step_) / (now - mark_);
      rate_ = rate_ == 0.0 ? recent : 0.7 * rate_ + 0.3 * recent;
      mark_ = now;
      mark_step_ = clock.step;
    }
    if (!line_.due()) return;
    const double done = static_cast<double>(clock.step) / static_cast<double>(clock.steps);
    const Observation& o = run.last_observation();
    std::string spin =
        o.period > 0.0 && o.period < 3.6e6 ? fmt::format("  T {:.3f} h", o.period / 3600.0) : "";
    std::string shed = o.shed_bodies > 0.0 ? fmt::format("  {} apart", o.shed_bodies) : "";
    line_.show(fmt::format(
        "{:<10} {} {:5.1f} %  {:.2f} M sphere-steps/s  left {}{}{}", run.scene().stages[clock.stage].name,
        bar(done), 100.0 * done, 1e-6 * rate_ * static_cast<double>(run.sphere_count()),
        clock_text(rate_ > 0.0 ? static_cast<double>(clock.steps - clock.step) / rate_ : 1e9), spin, shed));
  }
  void newline() const { line_.end(); }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::uint64_t stage_ = kNone, mark_step_ = 0;
  StatusLine line_;
  double mark_ = 0.0, rate_ = 0.0;
};

}  // namespace

void run_to_end(Run run) {
  for (const std::string& difference : run.differences()) spdlog::warn("{}", difference);
  const SignalGuard guard;
  use_threads_for(run.sphere_count());
  fmt::print("cairn {}, {} ({}), threads: {}\n", CAIRN_VERSION, instruction_set(), promise_of_bits(),
             omp_get_max_threads());
  std::fflush(stdout);
  ProgressBar bar;
  const double start = wall_seconds();
  const std::uint64_t first = run.state().clock.total_steps;
  std::optional<StageReport> made;
  const RunEnd end = run.advance({.watch =
                                      [&](const Run& r) {
                                        bar.show(r);
                                        return g_signal == 0;
                                      },
                                  .report =
                                      [&](const StageReport& report) {
                                        bar.newline();
                                        fmt::print("{}", describe(report));
                                        std::fflush(stdout);
                                        made = report;
                                      },
                                  .announce =
                                      [&](const std::string& line) {
                                        bar.newline();
                                        fmt::print("{}\n", line);
                                        std::fflush(stdout);
                                      },
                                  .warn =
                                      [&](const std::string& line) {
                                        bar.newline();
                                        spdlog::warn("{}", line);
                                      }});
  if (end == RunEnd::interrupted) bar.newline();
  if (end == RunEnd::interrupted) {
    fmt::print(stderr, "stopped at t = {:.6g} s; continue with: cairn resume {}\n", run.state().clock.time(),
               run.path().string());
    throw Interrupted{};
  }
  if (made)
    for (const std::string& defect : defects(*made, run.scene().contact.overlap_limit))
      spdlog::warn("{}", defect);
  print_phase_times(run, wall_seconds() - start, run.state().clock.total_steps - first);
}

}  // namespace cairn
