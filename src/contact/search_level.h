// One level of the neighbour search: a grid of cells of one size, of which only occupied rows are stored.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/math.h"

namespace cairn::search {

constexpr std::uint64_t kNoKey = ~std::uint64_t{0};
// Cell coordinates wrap round beyond 2^21, so that three of them fit one key. Far-apart cells that share a
// key cost a few vain distance tests and nothing else.
constexpr int kMaxBits = 21;

using Cell = std::array<std::int64_t, 3>;

struct Keyed {
  std::uint64_t key;  // of the cell
  std::uint32_t id;
};

struct Entry {
  Vec3 position;
  double radius;
  std::uint32_t id, body;
};

// One level of the hierarchy: spheres sorted by cell with z fastest, and a hash table of the occupied rows
// (the cells of one x and y).
struct Level {
  struct Row {
    std::uint64_t key = kNoKey;
    std::size_t begin = 0, end = 0;  // entries
  };

  double extent = 0.0;  // m, largest r + gap / 2
  double cells_per_metre = 0.0;
  Vec3 low, high;                  // m, box of the centres
  Cell origin{}, span{};           // lowest cell, and the highest relative to it
  std::array<int, 3> bits{};       // of a wrapped coordinate
  std::size_t begin = 0, end = 0;  // entries
  std::vector<Row> table;
  int shift = 0;

  bool empty() const { return begin == end; }

  // Monotone in x, even where it saturates and where x itself is coarser than a cell: whatever lies between
  // two bounds lies in the cells between theirs.
  std::int64_t index(double x) const {
    constexpr double far = 0x1p60;
    return static_cast<std::int64_t>(std::clamp(std::floor(x * cells_per_metre), -far, far));
  }
  Cell cell(const Vec3& x) const {
    return {index(x[0]) - origin[0], index(x[1]) - origin[1], index(x[2]) - origin[2]};
  }
  std::uint64_t wrapped(std::int64_t coordinate, int axis) const {
    return static_cast<std::uint64_t>(coordinate) & ((std::uint64_t{1} << bits[axis]) - 1);
  }
  std::uint64_t row_key(std::int64_t x, std::int64_t y) const {
    return (wrapped(x, 0) << bits[1]) | wrapped(y, 1);
  }

  // The row of this key, or the free place where it belongs.
  std::size_t find(std::uint64_t key) const {
    auto place = static_cast<std::size_t>((key * 0x9E3779B97F4A7C15u) >> shift);  // Fibonacci hashing
    while (table[place].key != key && table[place].key != kNoKey) place = (place + 1) & (table.size() - 1);
    return place;
  }
};

// Stable radix sort, so that a cell lists its spheres by id.
inline void sort_by_key(std::span<Keyed> order, std::span<Keyed> spare, int bits) {
  constexpr int digit_bits = 11;
  std::span<Keyed> from = order, to = spare;
  for (int low = 0; low < bits; low += digit_bits) {
    const auto digit = [&](const Keyed& k) { return (k.key >> low) & ((1u << digit_bits) - 1); };
    std::array<std::size_t, 1u << digit_bits> next{};
    for (const Keyed& k : from) ++next[digit(k)];
    std::size_t sum = 0;
    for (std::size_t& n : next) sum += std::exchange(n, sum);
    for (const Keyed& k : from) to[next[digit(k)]++] = k;
    std::swap(from, to);
  }
  if (from.data() != order.data()) std::copy(from.begin(), from.end(), order.begin());
}

}  // namespace cairn::search
