#include "core/random.h"

#include <cmath>

#include "core/elementary.h"

namespace cairn {

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += 0x9E3779B9;
    key[1] += 0xBB67AE85;
  }
  return counter;
}

std::uint64_t Random::bits() {
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
  const auto block =
      philox({low(counter_), high(counter_), low(stream_), high(stream_)}, {low(seed_), high(seed_)});
  ++counter_;
  return (std::uint64_t{block[1]} << 32) | block[0];
}

double Random::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1p-53;
}

double Random::uniform(double low, double high) {
  return low + (high - low) * uniform();
}

Vec3 Random::direction() {
  const double z = uniform(-1.0, 1.0);
  const double angle = uniform(0.0, 2.0 * kPi);
  const double s = std::sqrt(1.0 - z * z);
  return {s * sine_and_cosine(angle).cosine, s * sine_and_cosine(angle).sine, z};
}

Vec3 Random::in_ball() {
  const double radius = cube_root(uniform());
  return radius * direction();
}

Quat Random::rotation() {
  const double u = uniform();
  const double a = uniform(0.0, 2.0 * kPi);
  const double b = uniform(0.0, 2.0 * kPi);
  const double s = std::sqrt(1.0 - u), c = std::sqrt(u);
  return {c * sine_and_cosine(b).cosine, s * sine_and_cosine(a).sine, s * sine_and_cosine(a).cosine,
          c * sine_and_cosine(b).sine};
}

}  // namespace cairn
