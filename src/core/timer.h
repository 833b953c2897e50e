// Wall-clock time of named phases.
#pragma once

#include <chrono>

namespace cairn {

/// Seconds of a steady clock.
inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Adds the time from construction to destruction to `total` (s).
class ScopedTimer {
 public:
  explicit ScopedTimer(double& total) : total_(total), start_(wall_seconds()) {}
  ~ScopedTimer() { total_ += wall_seconds() - start_; }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  double& total_;
  double start_;
};

}  // namespace cairn
