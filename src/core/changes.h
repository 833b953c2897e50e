// Which bytes of a file were written: what an earlier version of it lacks.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>

namespace cairn {

class Changes {
 public:
  /// Bytes [begin, end) were written.
  void write(std::uint64_t begin, std::uint64_t end);
  /// The file was cut to this size; what comes behind it later is new.
  void cut(std::uint64_t size);

  /// Begin and end of each run of written bytes, in order, not touching each other.
  const std::map<std::uint64_t, std::uint64_t>& written() const { return written_; }
  /// The smallest size that the file was cut to.
  std::uint64_t shortest() const { return shortest_; }

 private:
  std::map<std::uint64_t, std::uint64_t> written_;
  std::uint64_t shortest_ = std::numeric_limits<std::uint64_t>::max();
};

inline void Changes::write(std::uint64_t begin, std::uint64_t end) {
  if (begin >= end) return;
  auto it = written_.upper_bound(begin);
  if (it != written_.begin() && std::prev(it)->second >= begin) it = std::prev(it);
  while (it != written_.end() && it->first <= end) {
    begin = std::min(begin, it->first);
    end = std::max(end, it->second);
    it = written_.erase(it);
  }
  written_.emplace(begin, end);
}

inline void Changes::cut(std::uint64_t size) {
  shortest_ = std::min(shortest_, size);
  auto it = written_.lower_bound(size);
  written_.erase(it, written_.end());
  if (!written_.empty()) {
    auto& [begin, end] = *std::prev(written_.end());
    end = std::min(end, size);
  }
}

}  // namespace cairn
