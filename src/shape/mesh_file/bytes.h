// Numbers of binary files.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

namespace cairn {

/// Numbers one after the other; asking for more bytes than there are is the caller's error.
class Bytes {
 public:
  /// `swapped`: those of highest weight come first.
  Bytes(std::string_view bytes, bool swapped) : left_(bytes), swapped_(swapped) {}

  template <class T>
  T take() {
    std::array<char, sizeof(T)> raw;
    std::copy_n(left_.data(), sizeof(T), raw.begin());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    skip(sizeof(T));
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  void skip(std::size_t bytes) { left_.remove_prefix(bytes); }
  std::size_t left() const { return left_.size(); }

 private:
  std::string_view left_;
  bool swapped_;
};

}  // namespace cairn
