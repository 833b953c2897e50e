// TOML text into a tree, with every way to fail turned into one line.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>

#include "io/source.h"

namespace cairn {

inline SourcePosition position_of(const toml::node& node) {
  return {node.source().begin.line, node.source().begin.column};
}

/// The whole of a regular file of at most 16 MB. @throws InputError naming the file and why not.
std::string read_text_file(const std::filesystem::path& path);

/// Parses TOML. @throws InputError "file:line:column: ..." for a syntax error, a key given twice, or a text
/// that no honest user writes (see check_toml; at most 50 000 tables and dotted keys).
toml::table parse_toml(const std::string& text, const std::string& file);

}  // namespace cairn
