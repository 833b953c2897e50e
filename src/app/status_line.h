// One line about long work on stderr, rewritten on a terminal and printed every 30 s elsewhere.
#pragma once

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "core/timer.h"

namespace cairn {

class StatusLine {
 public:
  /// Whether it is time for a line.
  bool due() const { return terminal_ || wall_seconds() - last_ >= 30.0; }
  /// The time to the next line counts from now.
  void wait() { last_ = wall_seconds(); }
  void show(const std::string& text) {
    wait();
    fmt::print(stderr, "{}{}{}", terminal_ ? "\r" : "", text, terminal_ ? "\x1b[K" : "\n");
    std::fflush(stderr);
  }
  /// What comes next begins a line.
  void end() const {
    if (terminal_) fmt::print(stderr, "\n");
  }

 private:
  const bool terminal_ = isatty(STDERR_FILENO);
  double last_ = wall_seconds();
};

/// "[#####...............]" for a part of 1 that is done.
inline std::string bar(double done) {
  const auto filled = static_cast<std::size_t>(20.0 * done);
  return fmt::format("[{}{}]", std::string(filled, '#'), std::string(20 - filled, '.'));
}

}  // namespace cairn
