#include "shape/mesh_file/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace cairn {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

const char* find(const char* begin, const char* end, char c) {
  const void* found = std::memchr(begin, c, static_cast<std::size_t>(end - begin));
  return found ? static_cast<const char*>(found) : end;
}

/// Signs and Fortran's exponents as std::from_chars knows them.
std::string plain_number(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  std::string plain(word);
  if (const auto d = plain.find_first_of("dD"); d != plain.npos && d > 0) {
    const char before = plain[d - 1];
    if ((before >= '0' && before <= '9') || before == '.') plain[d] = 'e';
  }
  return plain;
}

}  // namespace

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kMost = 40;
  std::string text(word.substr(0, kMost));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return fmt::format("'{}{}'", text, word.size() > kMost ? "..." : "");
}

Text::Text(std::string_view bytes, std::string name, Style style)
    : name_(std::move(name)), style_(style), begin_(bytes.data()), end_(begin_ + bytes.size()) {
  at_ = stop_ = next_ = begin_ + (bytes.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0);
  const char* const cr = find(begin_, end_, '\r');
  if (cr + 1 < end_ && cr[1] != '\n' && cr < find(begin_, end_, '\n')) line_end_ = '\r';
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
    throw InputError("{}:1: text in UTF-16: expected plain text or UTF-8", name_);
}

bool Text::load_line() {
  if (next_ == end_) {
    at_ = stop_ = end_;
    return false;
  }
  at_ = next_;
  stop_ = find(at_, end_, line_end_);
  next_ = stop_ == end_ ? end_ : stop_ + 1;
  ++line_;
  if (style_.comments) stop_ = find(at_, stop_, '#');
  goes_on_ = false;
  if (style_.continued) {
    const char* last = stop_;
    while (last > at_ && is_blank(last[-1])) --last;
    if (last > at_ && last[-1] == '\\') {
      goes_on_ = true;
      stop_ = last - 1;
    }
  }
  return true;
}

/// On to a word of the line; false at its end.
bool Text::skip_blanks() {
  for (;;) {
    while (at_ < stop_ && (is_blank(*at_) || (*at_ == ',' && style_.commas))) commas_ += *at_++ == ',';
    if (at_ < stop_) return true;
    if (!goes_on_) return false;
    if (!load_line()) fail("the file ends in a line that is to go on");
  }
}

bool Text::next_line() {
  while (load_line()) {
    commas_ = 0;
    if (skip_blanks()) return true;
  }
  return false;
}

bool Text::is_end(const char* at) const {
  return at == stop_ || is_blank(*at) || (*at == ',' && style_.commas);
}

bool Text::more() {
  return skip_blanks();
}

std::string_view Text::word() {
  if (!skip_blanks()) return {};
  const char* const first = at_;
  while (!is_end(at_)) ++at_;
  return {first, static_cast<std::size_t>(at_ - first)};
}

std::string_view Text::word_across_lines() {
  while (!skip_blanks())
    if (!load_line()) return {};
  return word();
}

std::string_view Text::rest() {
  if (!skip_blanks()) return {};
  const char* const first = std::exchange(at_, stop_);
  return {first, static_cast<std::size_t>(stop_ - first)};
}

double Text::number(std::string_view what) {
  double value = 0.0;
  if (!skip_blanks()) fail("expected {}, found the end of the line", what);
  const auto [end, error] = std::from_chars(at_, stop_, value);
  if (error == std::errc() && is_end(end) && std::isfinite(value)) {
    at_ = end;
    return value;
  }
  return unusual_number(what, true);
}

void Text::unused_number(std::string_view what) {
  double value = 0.0;
  if (!skip_blanks()) fail("expected {}, found the end of the line", what);
  const auto [end, error] = std::from_chars(at_, stop_, value);
  if (error == std::errc() && is_end(end))
    at_ = end;
  else
    unusual_number(what, false);
}

double Text::unusual_number(std::string_view what, bool finite) {
  const std::string_view found = word();
  const std::string plain = plain_number(found);
  double value = 0.0;
  const char* const end = plain.data() + plain.size();
  const auto [last, error] = std::from_chars(plain.data(), end, value);
  if (error == std::errc::invalid_argument || last != end)
    fail("expected {}, found {}, which is no number", what, in_quotes(found));
  if (error == std::errc::result_out_of_range)
    fail("expected {}, found {}, which no number of double precision is near to", what, in_quotes(found));
  if (finite && !std::isfinite(value))
    fail("expected {}, found {}, which is not finite", what, in_quotes(found));
  return value;
}

std::int64_t Text::integer(std::string_view what) {
  const std::string_view found = word();
  if (found.empty()) fail("expected {}, found the end of the line", what);
  const bool plus = found.size() > 1 && found[0] == '+' && found[1] != '-';
  std::int64_t value = 0;
  const char* const end = found.data() + found.size();
  const auto [last, error] = std::from_chars(found.data() + plus, end, value);
  if (error != std::errc() || last != end)
    fail("expected {}, found {}, which is no whole number{}", what, in_quotes(found),
         error == std::errc::result_out_of_range ? " of 64 bits" : "");
  return value;
}

std::uint32_t Text::count(std::string_view what) {
  const std::int64_t value = integer(what);
  if (value < 0 || value > std::numeric_limits<std::uint32_t>::max())
    fail("expected {}, found {}", what, value);
  return static_cast<std::uint32_t>(value);
}

void Text::end_line() {
  if (skip_blanks()) fail("expected the end of the line, found {}", in_quotes(word()));
}

}  // namespace cairn
