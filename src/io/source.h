// Where things stand in an input file, and error lines that say so.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"

namespace cairn {

/// A place in a text file; lines and columns count from 1, columns in code points.
struct SourcePosition {
  std::uint32_t line = 1, column = 1;
};

/// Where each key of an input file stands, by its path ("cloud[1].material", elements counted from 0).
class SourceMap {
 public:
  std::string file;               ///< as the user named it
  std::string added_file = {};    ///< of the lines that have been added to those of `file`; empty: none have
  std::uint32_t first_added = 0;  ///< the first of these lines

  void add(const std::string& key, SourcePosition position) { positions_[key] = position; }
  bool has(const std::string& key) const { return positions_.contains(key); }

  /// Position of a key, or of the nearest table around it when the file does not give the key.
  SourcePosition find(std::string_view key) const;

  /// The one-line error "file:line:column: key 'KEY': WHAT"; an empty key leaves its part out.
  [[nodiscard]] InputError error(std::string_view key, std::string_view what) const;
  [[nodiscard]] InputError error(SourcePosition position, std::string_view key, std::string_view what) const;

  /// Does work, of which an error is told with the place of this key.
  template <class Work>
  auto at(std::string_view key, Work&& work) const {
    try {
      return work();
    } catch (const InputError& failure) {
      throw error(key, failure.what());
    }
  }

  /// "file:line", where the key or the nearest table around it stands.
  std::string place(std::string_view key) const;

  /// Every key that the file gives, sorted.
  std::vector<std::string> keys() const;

 private:
  /// The file and the place in it of a place in the whole text.
  std::pair<std::string, SourcePosition> in_file(SourcePosition position) const;

  std::map<std::string, SourcePosition, std::less<>> positions_;
};

/// Text made fit for one line of a terminal: control, bidirectional and invalid characters are escaped, and
/// what is longer than `limit` bytes is cut.
std::string printable(std::string_view text, std::size_t limit = 200);

/// "'a', 'b' or 'c'"
std::string alternatives(const std::vector<std::string>& words);

}  // namespace cairn
