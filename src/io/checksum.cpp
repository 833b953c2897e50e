#include "io/checksum.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <new>

namespace cairn {
namespace {

std::string digits(XXH128_hash_t hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

void RunningChecksum::Free::operator()(XXH3_state_s* state) const {
  XXH3_freeState(state);
}

RunningChecksum::RunningChecksum() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

RunningChecksum::RunningChecksum(const RunningChecksum& other) : RunningChecksum() {
  *this = other;
}

RunningChecksum& RunningChecksum::operator=(const RunningChecksum& other) {
  XXH3_copyState(state_.get(), other.state_.get());
  return *this;
}

void RunningChecksum::add(std::span<const std::byte> bytes) {
  XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
}

std::string RunningChecksum::digest() const {
  return digits(XXH3_128bits_digest(state_.get()));
}

std::string checksum(std::span<const std::byte> bytes) {
  return digits(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string checksum(const std::string& text) {
  return checksum(std::as_bytes(std::span(text)));
}

}  // namespace cairn
