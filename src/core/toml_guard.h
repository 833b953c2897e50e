// What a TOML text must not hold if the parser is to end well.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cairn {

/// Where and why a text is not fit for the parser.
struct TomlComplaint {
  std::uint32_t line, column;  ///< from 1
  std::string what;
};

/// Looks for what no honest user writes: keys of more than 8 parts, more than 1 000 000 values, more than
/// `most_tables` tables and dotted keys, characters beyond ASCII outside strings and comments.
std::optional<TomlComplaint> check_toml(std::string_view text, int most_tables);

}  // namespace cairn
