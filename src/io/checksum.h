// The checksum of what a result file holds: XXH3 of 128 bits.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

struct XXH3_state_s;

namespace cairn {

/// 32 hexadecimal digits, those of Python's xxhash.xxh3_128_hexdigest.
std::string checksum(std::span<const std::byte> bytes);
std::string checksum(const std::string& text);

/// The same of bytes that come one after the other.
class RunningChecksum {
 public:
  RunningChecksum();
  RunningChecksum(const RunningChecksum& other);
  RunningChecksum& operator=(const RunningChecksum& other);
  RunningChecksum(RunningChecksum&&) noexcept = default;
  RunningChecksum& operator=(RunningChecksum&&) noexcept = default;

  void add(std::span<const std::byte> bytes);
  std::string digest() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Free> state_;
};

}  // namespace cairn
