// The two ways a run can end badly. Both carry one line meant for the user.
#pragma once

#include <fmt/format.h>

#include <stdexcept>

namespace cairn {

/// Bad input or an unusable file: the program prints the line and exits with code 2.
class InputError : public std::runtime_error {
 public:
  template <class... Args>
  explicit InputError(fmt::format_string<Args...> text, Args&&... args)
      : std::runtime_error(fmt::format(text, std::forward<Args>(args)...)) {}
};

/// The physics left its bounds (overlap, NaN): the run is closed with a readable file, exit code 3.
class UnstableError : public std::runtime_error {
 public:
  template <class... Args>
  explicit UnstableError(fmt::format_string<Args...> text, Args&&... args)
      : std::runtime_error(fmt::format(text, std::forward<Args>(args)...)) {}
};

/// Runs work; an InputError from it that does not begin with the name of the file gets it.
template <class Work>
auto naming(const std::string& file, Work&& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const std::string what = error.what();
    throw InputError("{}", what.starts_with(file) ? what : file + ": " + what);
  }
}

}  // namespace cairn
