#include "io/source.h"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

struct Character {
  char32_t code;
  std::size_t bytes;  // 0: not UTF-8
};

Character decode(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t bytes = byte(0) < 0x80             ? 1
                            : (byte(0) & 0xE0) == 0xC0 ? 2
                            : (byte(0) & 0xF0) == 0xE0 ? 3
                            : (byte(0) & 0xF8) == 0xF0 ? 4
                                                       : 0;
  if (bytes == 0 || bytes > text.size()) return {0, 0};
  char32_t code = bytes == 1 ? byte(0) : byte(0) & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {0, 0};
    code = (code << 6) | (byte(i) & 0x3Fu);
  }
  constexpr char32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < smallest[bytes] || code > 0x10FFFF || surrogate) return {0, 0};
  return {code, bytes};
}

// Control characters, line separators and marks that reorder the text around them.
bool disturbs_line(char32_t c) {
  return c < 0x20 || (c >= 0x7F && c <= 0x9F) || c == 0x61C || (c >= 0x200E && c <= 0x200F) ||
         (c >= 0x2028 && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069) || c == 0xFEFF;
}

}  // namespace

SourcePosition SourceMap::find(std::string_view key) const {
  for (;;) {
    if (const auto found = positions_.find(key); found != positions_.end()) return found->second;
    const std::size_t end = key.find_last_of(".[");
    if (end == std::string_view::npos) return {};
    key = key.substr(0, end);
  }
}

InputError SourceMap::error(std::string_view key, std::string_view what) const {
  return error(find(key), key, what);
}

InputError SourceMap::error(SourcePosition position, std::string_view key, std::string_view what) const {
  const std::string named = key.empty() ? "" : fmt::format("key '{}': ", printable(key));
  const auto [name, there] = in_file(position);
  return InputError("{}:{}:{}: {}{}", name, there.line, there.column, named, printable(what, 1000));
}

std::string SourceMap::place(std::string_view key) const {
  const auto [name, there] = in_file(find(key));
  return fmt::format("{}:{}", name, there.line);
}

std::pair<std::string, SourcePosition> SourceMap::in_file(SourcePosition position) const {
  if (added_file.empty() || position.line < first_added) return {printable(file, 4096), position};
  return {printable(added_file, 4096), {position.line - first_added + 1, position.column}};
}

std::vector<std::string> SourceMap::keys() const {
  std::vector<std::string> result;
  for (const auto& [key, position] : positions_) result.push_back(key);
  return result;
}

std::string printable(std::string_view text, std::size_t limit) {
  std::string result;
  while (!text.empty()) {
    const auto [code, bytes] = decode(text);
    if (bytes == 0)
      result += fmt::format("\\x{:02X}", static_cast<unsigned char>(text[0]));
    else if (code == '\n')
      result += "\\n";
    else if (code == '\t')
      result += "\\t";
    else if (disturbs_line(code))
      result += fmt::format("\\u{:04X}", static_cast<std::uint32_t>(code));
    else
      result += text.substr(0, bytes);
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
    if (result.size() > limit && !text.empty()) return result + "...";
  }
  return result;
}

std::string alternatives(const std::vector<std::string>& words) {
  std::string result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) result += i + 1 < words.size() ? ", " : " or ";
    result += fmt::format("'{}'", words[i]);
  }
  return result;
}

}  // namespace cairn
