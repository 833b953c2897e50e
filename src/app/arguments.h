// What options of the command line accept, and the one line for all else.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace cairn {

/// A number from `low` to `high`; NaN never.
CLI::Validator number_from(double low, double high);

/// A whole number from `low` to `high`.
CLI::Validator whole_from(std::uint64_t low, std::uint64_t high);

/// One of some words, passed on as the number at the same place.
CLI::Validator one_of(const std::vector<std::pair<std::string, int>>& words);

/// The same for values of an enumeration.
template <class Enum>
CLI::Validator one_of(const std::vector<std::pair<std::string, Enum>>& words) {
  std::vector<std::pair<std::string, int>> numbers;
  for (const auto& [word, value] : words) numbers.emplace_back(word, static_cast<int>(value));
  return one_of(numbers);
}

}  // namespace cairn
