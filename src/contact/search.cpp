#include "contact/search.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "contact/search_batch.h"
#include "contact/search_level.h"
#include "core/error.h"
#include "core/parallel.h"

namespace cairn {
namespace {

using search::Candidates, search::Cell, search::Entry, search::Found, search::Keyed, search::Level;
using search::kMaxBits;

constexpr std::size_t kLevels = 32;
constexpr int kLevelOctaves = 2;  // powers of two of size in a level; with one the many look-ups cost more
constexpr std::size_t kBlock = 1024;      // entries searched as one piece of parallel work
constexpr std::size_t kGroup = 8;         // entries searched for together, at most,
constexpr std::uint32_t kGroupCells = 3;  // and how far apart they may be

}  // namespace

struct NeighbourSearch::Grids {
  // A row last looked into, and where: the next group looks nearby.
  struct Cursor {
    std::int64_t x = -1, y = -1;
    Level::Row row;
    std::size_t at = 0;  // entry
  };
  using Cursors = std::array<Cursor, 16>;
  struct Block {
    std::array<Cursors, kLevels> cursors;
    Candidates candidates;
    Found found;
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
  Cursor& cursor(const Level& level, Cursors& cursors, std::int64_t x, std::int64_t y) const;
  void seek(Cursor& cursor, std::uint64_t z_low) const;
  std::size_t group_end(const Level& level, std::size_t begin, std::size_t end) const;
  void gather(const Level& level, const Cursor& row, std::size_t begin, std::int64_t z_low,
              std::int64_t z_high, Candidates& candidates) const;
  void gather(std::size_t own, std::size_t begin, std::size_t end, double gap, Block& block) const;
  void search(std::size_t begin, std::size_t end, double gap, Block& block) const;
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
    const int level = std::ilogb(largest / (radii[i] + 0.5 * gap)) / kLevelOctaves;
    level_of[i] = static_cast<std::uint8_t>(std::clamp(level, 0, static_cast<int>(kLevels) - 1));
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
  search::sort_by_key(part, std::span(spare).subspan(level.begin, count), bits);
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

NeighbourSearch::Grids::Cursor& NeighbourSearch::Grids::cursor(const Level& level, Cursors& cursors,
                                                               std::int64_t x, std::int64_t y) const {
  Cursor& c = cursors[static_cast<std::size_t>((x & 3) << 2 | (y & 3))];
  if (c.x != x || c.y != y) {
    c = {x, y, level.table[level.find(level.row_key(x, y))], 0};
    c.at = c.row.begin;
  }
  return c;
}

// Moves to the first entry of the row at z_low or beyond.
void NeighbourSearch::Grids::seek(Cursor& c, std::uint64_t z_low) const {
  for (int step = 0; step < 8; ++step) {
    if (c.at < c.row.end && z[c.at] < z_low)
      ++c.at;
    else if (c.at > c.row.begin && z[c.at - 1] >= z_low)
      --c.at;
    else
      return;
  }
  const auto row = std::span(z).subspan(c.row.begin, c.row.end - c.row.begin);
  c.at =
      c.row.begin + static_cast<std::size_t>(std::lower_bound(row.begin(), row.end(), z_low) - row.begin());
}

// A group is a few neighbours in one row, in the order of their cells, which share one list of candidates.
std::size_t NeighbourSearch::Grids::group_end(const Level& level, std::size_t begin, std::size_t end) const {
  const auto row_key = [&](std::size_t p) { return order[p].key >> level.bits[2]; };
  // Far-apart spheres may share a wrapped cell: ask for the true distance, too.
  const auto near = [&](std::size_t p) {
    return z[p] - z[begin] < kGroupCells &&
           (entries[p].position - entries[begin].position).cwiseAbs().maxCoeff() * level.cells_per_metre <
               kGroupCells;
  };
  std::size_t p = begin + 1;
  while (p < end && p < begin + kGroup && row_key(p) == row_key(begin) && near(p)) ++p;
  return p;
}

// The entries of a row from `begin` on, in the cells from z_low (where `begin` is) to z_high.
void NeighbourSearch::Grids::gather(const Level& level, const Cursor& row, std::size_t begin,
                                    std::int64_t z_low, std::int64_t z_high, Candidates& candidates) const {
  const std::uint64_t last = level.wrapped(z_high, 2);
  const bool wraps = last < level.wrapped(z_low, 2);
  std::size_t end = begin;
  while (end < row.row.end && (wraps || z[end] <= last)) ++end;
  candidates.add({entries.data() + begin, end - begin});
  if (!wraps) return;
  end = row.row.begin;
  while (end < row.row.end && z[end] <= last) ++end;
  candidates.add({entries.data() + row.row.begin, end - row.row.begin});
}

// Candidates of a group. Those of its own level come first, beginning with the group's second sphere, and
// hold each pair once: from the lower row, or from the lower entry of one row.
void NeighbourSearch::Grids::gather(std::size_t own, std::size_t begin, std::size_t end, double gap,
                                    Block& block) const {
  Vec3 box_low = entries[begin].position, box_high = box_low;
  double radius = entries[begin].radius;
  for (std::size_t p = begin + 1; p < end; ++p) {
    box_low = box_low.cwiseMin(entries[p].position);
    box_high = box_high.cwiseMax(entries[p].position);
    radius = std::max(radius, entries[p].radius);
  }
  block.candidates.count = 0;
  for (std::size_t l = own + 1; l-- > 0;) {
    const Level& level = levels[l];
    if (level.empty()) continue;
    // Room for the rounding of the distance test.
    const double reach = (radius + 0.5 * gap + level.extent) * (1.0 + 1e-12);
    Cell low = level.cell(box_low.array() - reach), high = level.cell(box_high.array() + reach);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::max<std::int64_t>(low[axis], 0);
      high[axis] = std::min(high[axis], level.span[axis]);
    }
    if (low[2] > high[2]) continue;
    const auto gather_row = [&](std::int64_t x, std::int64_t y) {
      Cursor& row = cursor(level, block.cursors[l], x, y);
      if (row.row.begin == row.row.end) return;
      seek(row, level.wrapped(low[2], 2));
      gather(level, row, row.at, low[2], high[2], block.candidates);
    };
    if (l < own) {
      for (std::int64_t x = low[0]; x <= high[0]; ++x)
        for (std::int64_t y = low[1]; y <= high[1]; ++y) gather_row(x, y);
    } else {
      const Cell c = level.cell(entries[begin].position);
      gather(level, cursor(level, block.cursors[l], c[0], c[1]), begin + 1, c[2], high[2], block.candidates);
      for (std::int64_t y = c[1] + 1; y <= high[1]; ++y) gather_row(c[0], y);
      for (std::int64_t x = c[0] + 1; x <= high[0]; ++x)
        for (std::int64_t y = low[1]; y <= high[1]; ++y) gather_row(x, y);
    }
  }
}

void NeighbourSearch::Grids::search(std::size_t begin, std::size_t end, double gap, Block& block) const {
  block.found.count = 0;
  for (Cursors& cursors : block.cursors) cursors.fill({});
  std::size_t own = 0;
  for (std::size_t group = begin; group < end;) {
    while (levels[own].end <= group) ++own;
    const std::size_t stop = group_end(levels[own], group, std::min(end, levels[own].end));
    gather(own, group, stop, gap, block);
    for (std::size_t self = group; self < stop; ++self)
      block.candidates.test(entries[self], self - group, gap, block.found);
    group = stop;
  }
}

void NeighbourSearch::Grids::collect(std::size_t count, std::vector<Pair>& pairs) {
  next.assign(count + 1, 0);
  std::size_t total = 0;
  for (const Block& block : blocks) {
    total += block.found.count;
    for (const std::uint64_t pair : block.found.valid()) ++next[(pair >> 32) + 1];
  }
  for (std::size_t i = 0; i < count; ++i) next[i + 1] += next[i];
  pairs.resize(total);
  for (const Block& block : blocks)
    for (const std::uint64_t pair : block.found.valid()) {
      const auto i = static_cast<std::uint32_t>(pair >> 32);
      pairs[next[i]++] = {i, static_cast<std::uint32_t>(pair)};
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
