// The tree over the points: a complete binary tree of cells, halved at the median along the longest side of
// the tight box. Its depth is log2(points / leaf size) whatever the distribution (coincident points, lines,
// a binary far apart), and cells of one level hold equally many points.
#pragma once

#include <array>
#include <bit>

#include "gravity/point_arrays.h"
#include "gravity/points.h"

namespace cairn::gravity {

/// What the walk reads of a cell.
struct Cell {
  Vec3 centre;    ///< centre of mass, m (mean position when massless)
  double radius;  ///< largest distance of its points from the centre, m
  double spread;  ///< sixth-power mean of the distances of its points from the centre by mass, m
  double mass;    ///< kg
  double reach;   ///< no point of it has a fellow of its own group farther away than this, m
};

/// The cell of points [from, to); its reach is not found.
Cell describe(const PointArrays& points, std::size_t from, std::size_t to);

/// The groups of more than one point that a cell touches, when they are few.
struct CellGroups {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::size_t kMost = 12;
  std::array<std::uint32_t, kMost> list;  ///< ascending; the first `count` of them
  std::uint32_t count;                    ///< kMost + 1: too many to list
  std::uint32_t only;                     ///< the one group that all its points belong to, or kNone
};

/// How the points of two cells are related.
enum class Kinship {
  kStrangers,  ///< no group has points in both
  kMixed,      ///< some group may have
  kSame        ///< all points of both cells belong to one group
};

class Tree {
 public:
  /// Builds the tree afresh; leaves hold at most `leaf_size` points. Same bits for any number of threads.
  void build(const Points& points, std::size_t leaf_size);

  std::size_t cells() const { return (std::size_t{2} << depth_) - 1; }
  unsigned depth() const { return depth_; }
  bool leaf(std::size_t cell) const { return cell + 1 >= std::size_t{1} << depth_; }
  static std::size_t parent(std::size_t cell) { return (cell - 1) / 2; }
  static std::size_t child(std::size_t cell, int k) { return 2 * cell + 1 + static_cast<std::size_t>(k); }

  const Cell& operator[](std::size_t cell) const { return cells_[cell]; }
  std::size_t begin(std::size_t cell) const { return bound(cell, 0); }  ///< first point, in tree order
  std::size_t end(std::size_t cell) const { return bound(cell, 1); }

  /// Kinship of two cells whose centres are `distance` (m) apart; kMixed when it cannot tell.
  Kinship kinship(std::size_t a, std::size_t b, double distance) const;

  const PointArrays& points() const { return arrays_; }                  ///< in tree order
  std::size_t original(std::size_t i) const { return items_[i].index; }  ///< number of the i-th in tree order

 private:
  struct Item {
    double x[3];
    std::uint32_t index, group;
  };

  std::size_t bound(std::size_t cell, std::size_t side) const {
    const auto level = static_cast<unsigned>(std::bit_width(cell + 1)) - 1;
    const std::size_t place = cell + 1 - (std::size_t{1} << level);
    return (items_.size() * (place + side)) >> level;
  }
  void halve(std::size_t cell);
  void measure_groups(const Points& points);
  void relate(std::size_t cell);

  unsigned depth_ = 0;
  std::vector<Item> items_;
  PointArrays arrays_;
  std::vector<double> extent_;  // per group: bound on the distance of two of its points, m
  std::vector<Cell> cells_;
  std::vector<CellGroups> groups_;
};

}  // namespace cairn::gravity
