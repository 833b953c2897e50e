#include "core/toml_guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace cairn {
namespace {

constexpr int kMaxKeyParts = 8;
constexpr int kMaxValues = 1'000'000;
constexpr const char* kOnlyAscii = "expected only ASCII characters outside strings and comments";

// The parser recurses over the parts of a key and looks tables up one by one, so a hostile file could exhaust
// the stack or take hours; where it looks for blanks, it has undefined behaviour for many characters beyond
// ASCII (toml++ 3.3). This scan knows just enough of the syntax (strings, comments, brackets) to find these.
class Guard {
 public:
  Guard(std::string_view text, int most_tables) : text_(text), most_tables_(most_tables) {}

  std::optional<TomlComplaint> check() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = line_start_ = 3;  // byte order mark
    while (at_ < text_.size() && !complaint_) {
      const char c = text_[at_];
      if (c == '#')
        at_ = std::min(text_.find('\n', at_), text_.size());
      else if (c == '"' || c == '\'')
        skip_string(c);
      else
        take(c);
    }
    return complaint_;
  }

 private:
  static bool ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

  void take(char c) {
    ++at_;
    if (!ascii(c)) fail(kOnlyAscii);
    if (c == '.' && ++dots_ >= kMaxKeyParts) fail(fmt::format("a key has more than {} parts", kMaxKeyParts));
    if (c == '=' || c == ',') count(values_, kMaxValues, "values");
    if (c == '=' && dots_ > 0) count(tables_, most_tables_, "tables and dotted keys");
    const bool inner = at_ > 1 && text_[at_ - 2] == '[';  // of [[name]]
    if (c == '[' && open_.empty() && !in_value_ && !inner)
      count(tables_, most_tables_, "tables and dotted keys");
    follow_words(c);
    if (c == '=') in_value_ = true;
    if ((c == '[' || c == '{') && in_value_) open_ += c;
    if ((c == ']' || c == '}') && !open_.empty()) open_.pop_back();
    if (c == '\n' && open_.empty()) in_value_ = false;
    if (std::strchr("=,[]{}\n", c)) dots_ = 0;
    if (c == '\n') {
      ++line_;
      line_start_ = at_;
    }
  }

  // A quote, '=' or bracket within a number or date is a part of it to the parser, until it ends.
  void follow_words(char c) {
    if (std::string_view(" \t\r\n,]}").find(c) != std::string_view::npos) {
      in_word_ = false;
    } else if (c == '=' && in_key_) {
      in_word_ = in_key_ = false;
    } else if (c != '[' && c != '{') {
      in_word_ = true;
    }
    if (c == ',') in_key_ = open_.ends_with('{');
    if (c == '{' && !in_word_) in_key_ = true;
    if (c == '\n' && open_.empty()) in_key_ = true;
  }

  void skip_string(char quote) {
    const std::string fence(3, quote);
    const bool multiline = text_.compare(at_, 3, fence) == 0;
    at_ += multiline ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (in_word_ && !ascii(c)) return fail(kOnlyAscii);
      if (c == '\n') {
        if (!multiline) return;  // a syntax error, which the parser reports
        ++line_;
        line_start_ = at_ + 1;
      }
      if (c == '\\' && quote == '"') {
        // Behind one that ends the line, the parser looks for blanks.
        const std::size_t next = std::min(text_.find_first_not_of(" \t\r\n\v\f", at_ + 1), text_.size());
        if (next < text_.size() && !ascii(text_[next]))
          return fail("expected an ASCII character behind '\\'");
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

  void fail(const std::string& what) {
    if (!complaint_)
      complaint_ = {line_, static_cast<std::uint32_t>(std::max<std::size_t>(1, at_ - line_start_)), what};
  }

  std::string_view text_;
  int most_tables_;
  std::optional<TomlComplaint> complaint_;
  std::size_t at_ = 0, line_start_ = 0;
  std::uint32_t line_ = 1;
  std::string open_;  // brackets of arrays and inline tables
  int dots_ = 0, values_ = 0, tables_ = 0;
  bool in_value_ = false, in_key_ = true, in_word_ = false;
};

}  // namespace

std::optional<TomlComplaint> check_toml(std::string_view text, int most_tables) {
  return Guard(text, most_tables).check();
}

}  // namespace cairn
