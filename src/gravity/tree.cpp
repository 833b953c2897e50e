#include "gravity/tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace cairn::gravity {

void Tree::build(const Points& points, std::size_t leaf_size) {
  const std::size_t n = points.size();
  depth_ = 0;
  while ((leaf_size << depth_) < n) ++depth_;
  items_.resize(n);
  arrays_.resize(n);
  cells_.resize(cells());
  groups_.resize(cells());
  measure_groups(points);

  for (unsigned level = 0; level < depth_; ++level) {
    const std::size_t first = (std::size_t{1} << level) - 1;
    parallel_blocks(first + 1, std::max<std::size_t>(1, (first + 1) / 64),
                    [&](std::size_t begin, std::size_t end) {
                      for (std::size_t c = begin; c < end; ++c) halve(first + c);
                    });
  }
  parallel_for(n, [&](std::size_t i) {
    const std::size_t k = items_[i].index;
    arrays_.set(i, points.positions[k], points.masses[k], items_[i].group);
  });
  // Upwards, as the groups of a cell are merged from those of its children.
  for (unsigned level = depth_ + 1; level-- > 0;) {
    const std::size_t first = (std::size_t{1} << level) - 1;
    parallel_blocks(first + 1, std::max<std::size_t>(1, (first + 1) / 64),
                    [&](std::size_t begin, std::size_t end) {
                      for (std::size_t c = begin; c < end; ++c) {
                        cells_[first + c] = describe(arrays_, this->begin(first + c), this->end(first + c));
                        relate(first + c);
                      }
                    });
  }
}

void Tree::measure_groups(const Points& points) {
  extent_.resize(points.groups());
  parallel_for(points.groups(), [&](std::size_t g) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (std::size_t i = points.first[g]; i < points.first[g + 1]; ++i) {
      const Vec3& x = points.positions[i];
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
      items_[i] = {{x.x(), x.y(), x.z()}, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(g)};
    }
    extent_[g] = points.first[g + 1] - points.first[g] > 1 ? (high - low).norm() : 0.0;
  });
}

void Tree::halve(std::size_t cell) {
  const auto from = items_.begin() + static_cast<std::ptrdiff_t>(begin(cell));
  const auto middle = items_.begin() + static_cast<std::ptrdiff_t>(end(child(cell, 0)));
  const auto to = items_.begin() + static_cast<std::ptrdiff_t>(end(cell));
  double low[3], high[3];
  std::fill_n(low, 3, std::numeric_limits<double>::max());
  std::fill_n(high, 3, std::numeric_limits<double>::lowest());
  for (auto item = from; item != to; ++item) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], item->x[k]);
      high[k] = std::max(high[k], item->x[k]);
    }
  }
  // A pile that only creeps shall be cut alike every time, even if it is a lattice, whose points stand in
  // line: sides count as longer, and points as told apart, only if they are so by more than a small part of
  // the cell.
  constexpr double kLonger = 1.0 + 0x1p-10, kPart = 0x1p-16;
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (high[k] - low[k] > kLonger * (high[axis] - low[axis])) axis = k;
  }
  const double side = high[axis] - low[axis];
  int exponent = 0;  // side is at most two to it, and more than half of that
  if (std::frexp(side, &exponent) == 0.5) --exponent;
  const double scale = side > 0.0 ? std::ldexp(1.0 / kPart, -exponent) : 0.0;
  const int second = (axis + 1) % 3, third = (axis + 2) % 3;
  std::nth_element(from, middle, to, [=](const Item& a, const Item& b) {
    for (const int k : {axis, second, third}) {
      // The borders of parts stay off the planes of symmetry of a pile about its centre.
      const double at = std::floor(scale * a.x[k] + 0.4), bt = std::floor(scale * b.x[k] + 0.4);
      if (at != bt) return at < bt;
    }
    return a.index < b.index;
  });
}

void Tree::relate(std::size_t cell) {
  CellGroups& own = groups_[cell];
  std::array<std::uint32_t, 2 * CellGroups::kMost> merged;
  if (leaf(cell)) {
    own = {{}, 0, begin(cell) < end(cell) ? items_[begin(cell)].group : CellGroups::kNone};
    for (std::size_t i = begin(cell); i < end(cell); ++i) {
      const std::uint32_t g = items_[i].group;
      if (g != own.only) own.only = CellGroups::kNone;
      if (extent_[g] == 0.0) continue;
      cells_[cell].reach = std::max(cells_[cell].reach, extent_[g]);
      const auto last = merged.begin() + own.count;
      if (own.count > CellGroups::kMost || std::find(merged.begin(), last, g) != last) continue;
      merged[own.count++] = g;
    }
    if (own.count <= CellGroups::kMost) {
      std::sort(merged.begin(), merged.begin() + own.count);
      std::copy_n(merged.begin(), own.count, own.list.begin());
    }
    return;
  }
  const std::size_t a = child(cell, 0), b = child(cell, 1);
  const CellGroups &ga = groups_[a], &gb = groups_[b];
  cells_[cell].reach = std::max(cells_[a].reach, cells_[b].reach);
  own.only = ga.only == gb.only ? ga.only : CellGroups::kNone;
  own.count = CellGroups::kMost + 1;
  if (ga.count > CellGroups::kMost || gb.count > CellGroups::kMost) return;
  const auto last = std::set_union(ga.list.begin(), ga.list.begin() + ga.count, gb.list.begin(),
                                   gb.list.begin() + gb.count, merged.begin());
  const auto count = static_cast<std::size_t>(last - merged.begin());
  if (count > CellGroups::kMost) return;
  own.count = static_cast<std::uint32_t>(count);
  std::copy_n(merged.begin(), count, own.list.begin());
}

Kinship Tree::kinship(std::size_t a, std::size_t b, double distance) const {
  const double reach = std::min(cells_[a].reach, cells_[b].reach);
  // The margin outweighs the rounding of radii and distance.
  if (reach == 0.0 || (1.0 - 1e-12) * distance - cells_[a].radius - cells_[b].radius > reach) {
    return Kinship::kStrangers;
  }
  const CellGroups &ga = groups_[a], &gb = groups_[b];
  if (ga.only != CellGroups::kNone && ga.only == gb.only) return Kinship::kSame;
  if (ga.count > CellGroups::kMost || gb.count > CellGroups::kMost) return Kinship::kMixed;
  for (std::uint32_t i = 0, j = 0; i < ga.count && j < gb.count;) {
    if (ga.list[i] == gb.list[j]) return Kinship::kMixed;
    ga.list[i] < gb.list[j] ? ++i : ++j;
  }
  return Kinship::kStrangers;
}

}  // namespace cairn::gravity
