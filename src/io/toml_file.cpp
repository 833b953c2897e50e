#include "io/toml_file.h"

#include <algorithm>

#include "core/read_file.h"
#include "core/toml_guard.h"

namespace cairn {
namespace {

constexpr std::size_t kMaxBytes = 16'000'000;
constexpr int kMaxTables = 50'000;

// The parser notices a second `key` only behind it, at `position`: this is where the key starts.
SourcePosition start_of_key(std::string_view text, const std::string& key, SourcePosition position) {
  const auto in_character = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; };
  for (std::uint32_t line = 1; line < position.line; ++line) text.remove_prefix(text.find('\n') + 1);
  std::vector<std::size_t> starts;  // bytes at which the characters before the position start
  for (std::size_t i = 0; i < text.size() && starts.size() < position.column; ++i)
    if (!in_character(text[i])) starts.push_back(i);
  const std::size_t found = starts.empty() ? text.npos : text.substr(0, starts.back()).rfind(key);
  if (found == text.npos) return position;
  const auto column = std::lower_bound(starts.begin(), starts.end(), found) - starts.begin() + 1;
  return {position.line, static_cast<std::uint32_t>(column)};
}

InputError syntax_error(const toml::parse_error& error, const std::string& text, const std::string& file) {
  SourceMap sources;
  sources.file = file;
  const SourcePosition position{error.source().begin.line, error.source().begin.column};
  const std::string what(error.description());
  if (const auto twice = what.find("cannot redefine existing"); twice != std::string::npos) {
    const auto open = what.find('\'', twice), close = what.rfind('\'');
    if (open < close) {
      const std::string key = what.substr(open + 1, close - open - 1);
      return sources.error(start_of_key(text, key, position), key, "given twice");
    }
  }
  constexpr std::string_view prefix = "Error while ";
  return sources.error(position, "",
                       "syntax error: " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what));
}

}  // namespace

std::string read_text_file(const std::filesystem::path& path) {
  return read_file(path, printable(path.string(), 4096), {.most = kMaxBytes});
}

toml::table parse_toml(const std::string& text, const std::string& file) {
  if (text.size() > kMaxBytes)
    throw InputError("{}: larger than {} MB", printable(file, 4096), kMaxBytes / 1'000'000);
  if (const auto complaint = check_toml(text, kMaxTables)) {
    SourceMap sources;
    sources.file = file;
    throw sources.error(SourcePosition{complaint->line, complaint->column}, "", complaint->what);
  }
  try {
    return toml::parse(std::string_view(text));
  } catch (const toml::parse_error& error) {
    throw syntax_error(error, text, file);
  }
}

}  // namespace cairn
