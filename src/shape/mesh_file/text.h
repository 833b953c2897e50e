// Text files of words and numbers, read word by word: every complaint names file and line.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "core/error.h"

namespace cairn {

/// The words of a text, line by line. Lines end at LF, CR LF or CR, whichever comes first in the text; a mark
/// of UTF-8 at its start is passed over. Everything throws InputError "NAME:LINE: what is wrong".
class Text {
 public:
  struct Style {
    bool comments = true;    ///< the rest of a line from `#` on is no part of it
    bool continued = false;  ///< a line that ends in a backslash goes on in the next
    bool commas = false;     ///< a comma ends a word, too; see `commas`
  };

  /// `bytes` must outlive the object.
  Text(std::string_view bytes, std::string name, Style style);

  /// On to the next line that has a word; false when there is none.
  bool next_line();
  /// The next word of the line; empty at its end.
  std::string_view word();
  /// The next word of this line or of those after it; empty at the end of the text.
  std::string_view word_across_lines();
  /// Whether the line has another word.
  bool more();
  /// The rest of the line as it stands, comments left out.
  std::string_view rest();

  /// The next word of the line as a finite number, called `what` in the complaint: signs, .25, 5., exponents
  /// with e, E, d or D.
  double number(std::string_view what);
  /// The same, where words for what is not finite will do: of normals and other numbers that are not used.
  void unused_number(std::string_view what);
  /// The next word of the line as a whole number.
  std::int64_t integer(std::string_view what);
  /// The same from 0 to what 32 bits hold.
  std::uint32_t count(std::string_view what);
  /// Complains of words that are left on the line.
  void end_line();

  std::size_t line() const { return line_; }
  const std::string& name() const { return name_; }
  /// Commas between the words of this line so far.
  std::size_t commas() const { return commas_; }
  /// Where the line after this one begins, in bytes.
  std::size_t next_offset() const { return static_cast<std::size_t>(next_ - begin_); }

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw InputError("{}:{}: {}", name_, line_, fmt::format(text, std::forward<Args>(args)...));
  }

 private:
  bool load_line();
  bool skip_blanks();
  bool is_end(const char* at) const;
  double unusual_number(std::string_view what, bool finite);

  std::string name_;
  Style style_;
  char line_end_ = '\n';
  std::size_t line_ = 0, commas_ = 0;
  bool goes_on_ = false;      // the line, in the next
  const char *begin_, *end_;  // of the text
  const char *at_, *stop_;    // what is left of the line
  const char* next_;          // line
};

/// A word of a file in quotes for a message, cut short, with what cannot be printed as question marks.
std::string in_quotes(std::string_view word);

}  // namespace cairn
