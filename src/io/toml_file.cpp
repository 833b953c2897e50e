#include "io/toml_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace cairn {
namespace {

constexpr std::size_t kMaxBytes = 16'000'000;
constexpr int kMaxKeyParts = 8;
constexpr int kMaxValues = 1'000'000;
constexpr int kMaxTables = 50'000;

// The parser recurses over the parts of a key and looks tables up one by one, so a hostile file could exhaust
// the stack or take hours. This scan knows just enough of the syntax (strings, comments, brackets) to count.
class SizeGuard {
 public:
  SizeGuard(const std::string& text, const std::string& file) : text_(text) { sources_.file = file; }

  void check() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#')
        at_ = std::min(text_.find('\n', at_), text_.size());
      else if (c == '"' || c == '\'')
        skip_string(c);
      else
        take(c);
    }
  }

 private:
  void take(char c) {
    ++at_;
    if (c == '.' && ++dots_ >= kMaxKeyParts) fail(fmt::format("a key has more than {} parts", kMaxKeyParts));
    if (c == '=' || c == ',') count(values_, kMaxValues, "values");
    if (c == '=' && dots_ > 0) count(tables_, kMaxTables, "tables and dotted keys");
    const bool inner = at_ > 1 && text_[at_ - 2] == '[';  // of [[name]]
    if (c == '[' && depth_ == 0 && !in_value_ && !inner) count(tables_, kMaxTables, "tables and dotted keys");
    if (c == '=') in_value_ = true;
    if ((c == '[' || c == '{') && in_value_) ++depth_;
    if ((c == ']' || c == '}') && depth_ > 0) --depth_;
    if (c == '\n' && depth_ == 0) in_value_ = false;
    if (std::strchr("=,[]{}\n", c)) dots_ = 0;
    if (c == '\n') {
      ++line_;
      line_start_ = at_;
    }
  }

  void skip_string(char quote) {
    const std::string fence(3, quote);
    const bool multiline = text_.compare(at_, 3, fence) == 0;
    at_ += multiline ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        if (!multiline) return;  // a syntax error, which the parser reports
        ++line_;
        line_start_ = at_ + 1;
      }
      if (c == '\\' && quote == '"') {
        if (at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
      } else if (c == quote && (!multiline || text_.compare(at_, 3, fence) == 0)) {
        at_ += multiline ? 3 : 1;
        while (multiline && at_ < text_.size() && text_[at_] == quote) ++at_;  // quotes before the fence
        return;
      }
    }
  }

  void count(int& number, int limit, const char* what) {
    if (++number > limit) fail(fmt::format("more than {} {}", limit, what));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw sources_.error(
        SourcePosition{line_, static_cast<std::uint32_t>(std::max<std::size_t>(1, at_ - line_start_))}, "",
        what);
  }

  const std::string& text_;
  SourceMap sources_;
  std::size_t at_ = 0, line_start_ = 0;
  std::uint32_t line_ = 1;
  int dots_ = 0, depth_ = 0, values_ = 0, tables_ = 0;
  bool in_value_ = false;
};

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
  const std::string name = printable(path.string(), 4096);
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) throw InputError("{}: no such file", name);
  if (error) throw InputError("{}: {}", name, error.message());
  // Only a regular file has an end for certain; opening a pipe would wait for ever.
  if (!std::filesystem::is_regular_file(status)) throw InputError("{}: not a regular file", name);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError("{}: cannot be read: {}", name, std::strerror(errno));
  std::string text(kMaxBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) throw InputError("{}: cannot be read: {}", name, std::strerror(errno));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxBytes) throw InputError("{}: larger than {} MB", name, kMaxBytes / 1'000'000);
  return text;
}

toml::table parse_toml(const std::string& text, const std::string& file) {
  if (text.size() > kMaxBytes)
    throw InputError("{}: larger than {} MB", printable(file, 4096), kMaxBytes / 1'000'000);
  SizeGuard(text, file).check();
  try {
    return toml::parse(std::string_view(text));
  } catch (const toml::parse_error& error) {
    throw syntax_error(error, text, file);
  }
}

}  // namespace cairn
