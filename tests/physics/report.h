// The table of what has been shown: each check asserts and, when a report is asked for, writes itself down.
// `tests/validate.sh` runs all of them with CAIRN_REPORT set to a folder and makes tests/VALIDATION.md of it.
#pragma once

#include <string>
#include <vector>

namespace cairn::report {

/// Asserts |measured - expected| <= tolerance. `claim` says what is measured, `against` the closed form or
/// the independent method; units in the claim.
void near(const std::string& claim, const std::string& against, double measured, double expected,
          double tolerance);

/// The same with a tolerance relative to |expected|.
void close(const std::string& claim, const std::string& against, double measured, double expected,
           double relative);

/// Asserts 0 <= error <= tolerance for an error already formed.
void error(const std::string& claim, const std::string& against, double measured, double tolerance);

/// Asserts low <= measured <= high.
void within(const std::string& claim, const std::string& against, double measured, double low, double high);

/// A paragraph under the table of the present suite: what was tried, what happened, what the user should do.
void note(const std::string& text);

struct Curve {
  std::string label;
  std::vector<double> x, y;
  bool line = true;  ///< joined; otherwise marks only
};

struct Axes {
  std::string x, y;  ///< labels with units
  bool log_x = false, log_y = false;
};

/// A figure under the table of the present suite, kept as FOLDER/name.svg.
void plot(const std::string& name, const std::string& caption, const Axes& axes,
          const std::vector<Curve>& curves);

}  // namespace cairn::report
