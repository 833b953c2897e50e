#include "contact/search.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace cairn {
namespace {

constexpr std::size_t kLevels = 32;
constexpr std::size_t kBlock = 1024;  // entries searched as one piece of parallel work
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
void sort_by_key(std::span<Keyed> order, std::span<Keyed> spare, int bits) {
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

}  // namespace

struct NeighbourSearch::Grids {
  // A row last looked into, and where: the next sphere looks nearby.
  struct Cursor {
    std::int64_t x = -1, y = -1;
    Level::Row row;
    std::size_t at = 0;  // entry
  };
  struct Block {
    std::array<std::array<Cursor, 16>, kLevels> cursors;
    std::vector<std::uint64_t> found;  // i << 32 | j
    std::size_t count = 0;
  };

  std::array<Level, kLevels> levels;  // coarsest first
  std::vector<std::uint8_t> level_of;
  std::vector<Keyed> order, spare;
  std::vector<Entry> entries;    // sorted by level and cell
  std::vector<std::uint32_t> z;  // wrapped, of the entries' cells
  std::vector<Block> blocks;
  std::vector<std::size_t> next;

  void sort_into_levels(std::span<const Vec3> positions, std::span<const double> radii, double gap);
  void sort_into_cells(Level& level, std::span<const Vec3> positions);
  void find_rows(Level& level);
  Cursor& cursor(const Level& level, std::array<Cursor, 16>& cursors, std::int64_t x, std::int64_t y) const;
  void seek(Cursor& cursor, std::uint32_t z_low) const;
  void search(std::size_t begin, std::size_t end, double gap, Block& block) const;
  void search_row(const Level& level, const Entry& sphere, Cursor& row, std::int64_t z_low,
                  std::int64_t z_high, double gap, Block& block) const;
  void test(const Entry& sphere, std::size_t begin, std::size_t end, std::uint64_t z_high, double gap,
            Block& block) const;
  void collect(std::size_t count, std::vector<Pair>& pairs);
};

void NeighbourSearch::Grids::sort_into_levels(std::span<const Vec3> positions, std::span<const double> radii,
                                              double gap) {
  const std::size_t count = positions.size();
  const double largest = *std::max_element(radii.begin(), radii.end()) + 0.5 * gap;
  level_of.resize(count);
  parallel_for(count, [&](std::size_t i) {
    if (!positions[i].allFinite())
      throw UnstableError("the position of sphere {} is not finite: ({}, {}, {})", i, positions[i].x(),
                          positions[i].y(), positions[i].z());
    if (!std::isnormal(radii[i]) || radii[i] < 0.0)
      throw InputError("the radius of sphere {} must be positive and finite, not {}", i, radii[i]);
    const int octave = std::ilogb(largest / (radii[i] + 0.5 * gap));
    level_of[i] = static_cast<std::uint8_t>(std::clamp(octave, 0, static_cast<int>(kLevels) - 1));
  });

  for (Level& level : levels) {
    level.extent = 0.0;
    level.end = 0;
    level.low.setConstant(std::numeric_limits<double>::infinity());
    level.high = -level.low;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Level& level = levels[level_of[i]];
    level.extent = std::max(level.extent, radii[i] + 0.5 * gap);
    level.low = level.low.cwiseMin(positions[i]);
    level.high = level.high.cwiseMax(positions[i]);
    ++level.end;
  }
  std::size_t begin = 0;
  for (Level& level : levels) {
    level.begin = begin;
    begin += level.end;
    level.end = level.begin;
  }
  order.resize(count);
  spare.resize(count);
  entries.resize(count);
  z.resize(count);
  for (std::size_t i = 0; i < count; ++i) order[levels[level_of[i]].end++].id = static_cast<std::uint32_t>(i);
}

void NeighbourSearch::Grids::sort_into_cells(Level& level, std::span<const Vec3> positions) {
  level.cells_per_metre = 0.5 / level.extent;
  level.origin = {};
  level.origin = level.cell(level.low);
  level.span = level.cell(level.high);
  int bits = 0;
  for (int axis = 0; axis < 3; ++axis) {
    level.bits[axis] = std::min<int>(std::bit_width(static_cast<std::uint64_t>(level.span[axis])), kMaxBits);
    bits += level.bits[axis];
  }
  const std::size_t count = level.end - level.begin;
  const auto part = std::span(order).subspan(level.begin, count);
  parallel_for(count, [&](std::size_t p) {
    const Cell c = level.cell(positions[part[p].id]);
    part[p].key = (level.row_key(c[0], c[1]) << level.bits[2]) | level.wrapped(c[2], 2);
  });
  sort_by_key(part, std::span(spare).subspan(level.begin, count), bits);
  find_rows(level);
}

void NeighbourSearch::Grids::find_rows(Level& level) {
  const auto row_key = [&](std::size_t p) { return order[p].key >> level.bits[2]; };
  std::size_t rows = 0;
  for (std::size_t p = level.begin; p < level.end; ++p) {
    rows += p == level.begin || row_key(p) != row_key(p - 1);
    z[p] = static_cast<std::uint32_t>(level.wrapped(static_cast<std::int64_t>(order[p].key), 2));
  }
  const std::size_t size = std::bit_ceil(2 * rows);
  level.shift = 64 - std::countr_zero(size);
  level.table.assign(size, {});
  for (std::size_t p = level.begin; p < level.end;) {
    const std::uint64_t key = row_key(p);
    const std::size_t begin = p;
    while (p < level.end && row_key(p) == key) ++p;
    level.table[level.find(key)] = {key, begin, p};
  }
}

NeighbourSearch::Grids::Cursor& NeighbourSearch::Grids::cursor(const Level& level,
                                                               std::array<Cursor, 16>& cursors,
                                                               std::int64_t x, std::int64_t y) const {
  Cursor& c = cursors[static_cast<std::size_t>((x & 3) << 2 | (y & 3))];
  if (c.x != x || c.y != y) {
    c = {x, y, level.table[level.find(level.row_key(x, y))], 0};
    c.at = c.row.begin;
  }
  return c;
}

// Moves to the first entry of the row at z_low or beyond.
void NeighbourSearch::Grids::seek(Cursor& c, std::uint32_t z_low) const {
  const auto settled = [&] {
    return (c.at == c.row.end || z[c.at] >= z_low) && (c.at == c.row.begin || z[c.at - 1] < z_low);
  };
  for (int step = 0; step < 8; ++step) {
    if (c.at < c.row.end && z[c.at] < z_low)
      ++c.at;
    else if (c.at > c.row.begin && z[c.at - 1] >= z_low)
      --c.at;
    else
      return;
  }
  if (!settled())
    c.at =
        static_cast<std::size_t>(std::lower_bound(z.begin() + static_cast<std::ptrdiff_t>(c.row.begin),
                                                  z.begin() + static_cast<std::ptrdiff_t>(c.row.end), z_low) -
                                 z.begin());
}

// Tests the entries from begin on while they lie in cells up to z_high.
void NeighbourSearch::Grids::test(const Entry& sphere, std::size_t begin, std::size_t end,
                                  std::uint64_t z_high, double gap, Block& block) const {
  std::size_t count = block.count;
  for (std::size_t p = begin; p < end && z[p] <= z_high; ++p) {
    if (count == block.found.size()) block.found.resize(2 * count + kBlock);
    const Entry& other = entries[p];
    const auto [low, high] = std::minmax(sphere.id, other.id);
    block.found[count] = (std::uint64_t{low} << 32) | high;
    // No branch: the outcome is a coin toss.
    count += static_cast<unsigned>(other.body != sphere.body) &
             static_cast<unsigned>(
                 closer_than(sphere.position, other.position, (sphere.radius + other.radius) + gap));
  }
  block.count = count;
}

void NeighbourSearch::Grids::search_row(const Level& level, const Entry& sphere, Cursor& row,
                                        std::int64_t z_low, std::int64_t z_high, double gap,
                                        Block& block) const {
  const std::uint64_t first = level.wrapped(z_low, 2), last = level.wrapped(z_high, 2);
  seek(row, static_cast<std::uint32_t>(first));
  if (first <= last) {
    test(sphere, row.at, row.row.end, last, gap, block);
  } else {
    test(sphere, row.at, row.row.end, kNoKey, gap, block);
    test(sphere, row.row.begin, row.row.end, last, gap, block);
  }
}

void NeighbourSearch::Grids::search(std::size_t begin, std::size_t end, double gap, Block& block) const {
  block.count = 0;
  for (auto& cursors : block.cursors) cursors.fill({});
  std::size_t own = 0;
  for (std::size_t self = begin; self < end; ++self) {
    while (levels[own].end <= self) ++own;
    const Entry& sphere = entries[self];
    for (std::size_t l = 0; l <= own; ++l) {
      const Level& level = levels[l];
      if (level.empty()) continue;
      // Room for the rounding of the distance test.
      const double reach = (sphere.radius + 0.5 * gap + level.extent) * (1.0 + 1e-12);
      Cell low = level.cell(sphere.position.array() - reach),
           high = level.cell(sphere.position.array() + reach);
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::max<std::int64_t>(low[axis], 0);
        high[axis] = std::min(high[axis], level.span[axis]);
      }
      auto& cursors = block.cursors[l];
      if (l < own) {
        if (low[2] > high[2]) continue;
        for (std::int64_t x = low[0]; x <= high[0]; ++x)
          for (std::int64_t y = low[1]; y <= high[1]; ++y)
            search_row(level, sphere, cursor(level, cursors, x, y), low[2], high[2], gap, block);
        continue;
      }
      // In its own level each pair is found once: from the lower row, or from the lower entry of one row.
      const Cell c = level.cell(sphere.position);
      for (std::int64_t x = c[0]; x <= high[0]; ++x)
        for (std::int64_t y = x == c[0] ? c[1] + 1 : low[1]; y <= high[1]; ++y)
          search_row(level, sphere, cursor(level, cursors, x, y), low[2], high[2], gap, block);
      const Cursor& row = cursor(level, cursors, c[0], c[1]);
      const std::uint64_t last = level.wrapped(high[2], 2);
      test(sphere, self + 1, row.row.end, last, gap, block);
    }
  }
}

void NeighbourSearch::Grids::collect(std::size_t count, std::vector<Pair>& pairs) {
  next.assign(count + 1, 0);
  std::size_t total = 0;
  for (const Block& block : blocks) {
    total += block.count;
    for (std::size_t p = 0; p < block.count; ++p) ++next[(block.found[p] >> 32) + 1];
  }
  for (std::size_t i = 0; i < count; ++i) next[i + 1] += next[i];
  pairs.resize(total);
  for (const Block& block : blocks)
    for (std::size_t p = 0; p < block.count; ++p) {
      const auto i = static_cast<std::uint32_t>(block.found[p] >> 32);
      pairs[next[i]++] = {i, static_cast<std::uint32_t>(block.found[p])};
    }
  // Every `next` has moved on to the end of its sphere's pairs.
  parallel_for(count, [&](std::size_t i) {
    const auto begin = pairs.begin() + static_cast<std::ptrdiff_t>(i == 0 ? 0 : next[i - 1]);
    std::sort(begin, pairs.begin() + static_cast<std::ptrdiff_t>(next[i]),
              [](const Pair& a, const Pair& b) { return a.j < b.j; });
  });
}

NeighbourSearch::NeighbourSearch() : grids_(std::make_unique<Grids>()) {}
NeighbourSearch::~NeighbourSearch() = default;
NeighbourSearch::NeighbourSearch(NeighbourSearch&&) noexcept = default;
NeighbourSearch& NeighbourSearch::operator=(NeighbourSearch&&) noexcept = default;

void NeighbourSearch::find(std::span<const Vec3> positions, std::span<const double> radii,
                           std::span<const std::uint32_t> body, double gap, std::vector<Pair>& pairs) {
  if (!(gap >= 0.0) || !std::isfinite(gap))
    throw InputError("the gap of a neighbour search must be finite and >= 0, not {}", gap);
  pairs.clear();
  const std::size_t count = positions.size();
  if (count == 0) return;
  Grids& grids = *grids_;
  grids.sort_into_levels(positions, radii, gap);
  for (Level& level : grids.levels)
    if (!level.empty()) grids.sort_into_cells(level, positions);
  parallel_for(count, [&](std::size_t p) {
    const std::uint32_t i = grids.order[p].id;
    grids.entries[p] = {positions[i], radii[i], i, body[i]};
  });
  grids.blocks.resize((count + kBlock - 1) / kBlock);
  parallel_blocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    grids.search(begin, end, gap, grids.blocks[begin / kBlock]);
  });
  grids.collect(count, pairs);
}

}  // namespace cairn
