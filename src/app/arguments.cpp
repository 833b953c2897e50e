#include "app/arguments.h"

#include <fmt/format.h>

#include <charconv>

#include "io/options.h"
#include "io/source.h"

namespace cairn {

CLI::Validator number_from(double low, double high) {
  const std::string range = fmt::format("{} to {}", show(low), show(high));
  const auto check = [=](const std::string& text) -> std::string {
    double x = 0.0;
    if (CLI::detail::lexical_cast(text, x) && x >= low && x <= high) return {};
    return fmt::format("expected a number from {}, found '{}'", range, printable(text));
  };
  return {check, range};
}

CLI::Validator whole_from(std::uint64_t low, std::uint64_t high) {
  const std::string range = fmt::format("{} to {}", low, high);
  const auto check = [=](const std::string& text) -> std::string {
    std::uint64_t n = 0;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, n);
    if (error == std::errc() && rest == end && n >= low && n <= high) return {};
    return fmt::format("expected a whole number from {}, found '{}'", range, printable(text));
  };
  return {check, range};
}

CLI::Validator one_of(const std::vector<std::pair<std::string, int>>& words) {
  std::vector<std::string> names;
  for (const auto& [word, number] : words) names.push_back(word);
  const auto replace = [=](std::string& text) -> std::string {
    for (const auto& [word, number] : words)
      if (word == text) {
        text = std::to_string(number);
        return {};
      }
    return fmt::format("expected {}, found '{}'", alternatives(names), printable(text));
  };
  return {replace, fmt::format("{}", fmt::join(names, "|"))};
}

}  // namespace cairn
