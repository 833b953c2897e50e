// The dual walk of the tree. For each target cell it sorts the source cells into those far enough for an
// expansion, those to be met point by point, and those to be opened. It is a template over the kernel that
// does the work, so that a test can count pairs with the code that ships.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "gravity/tree.h"

namespace cairn::gravity {

/// The cells that a target cell meets.
struct Meetings {
  std::vector<std::uint32_t> far;         ///< by expansion; no group has points in both
  std::vector<std::uint32_t> near;        ///< point by point; no group of several points has points in both
  std::vector<std::uint32_t> near_mixed;  ///< point by point, leaving out pairs of one group
  std::vector<std::uint32_t> open;        ///< left to the target's children
  std::vector<std::uint32_t> stack;
};

/// When cells may meet by expansions: far enough apart by their radii and, with a tolerance, only where the
/// acceleration that the first neglected terms stand for,
///   G M / r^2 (reach / r)^order / (1 - radii / r)^2   [after Dehnen 2014, Comput. Astrophys. Cosmol. 1, 1],
/// is below it for both cells. Light and distant cells then meet early, heavy and near ones late.
struct Opening {
  double theta = 0.7;      ///< the sum of their radii is below theta x distance, 0..1
  double tolerance = 0.0;  ///< m/s^2; 0: theta alone decides
  int order = 5;           ///< of the expansions

  /// Mass of the cells like `source` that a much wider target sees alike: their errors add up.
  static double crowd(const Cell& source, const Cell& target) {
    const double wider = 0.5 * target.radius, narrow = std::max(source.radius, 1e-3 * wider);
    return wider > narrow ? source.mass * (wider / narrow) * (wider / narrow) : source.mass;
  }

  bool far(const Cell& a, const Cell& b, double square) const {
    constexpr double kTooClose = 1e-40;  // m^2: below it the powers of 1/r overflow
    const double radii = a.radius + b.radius;
    if (!(radii * radii < theta * theta * square && square > kTooClose)) return false;
    if (tolerance == 0.0) return true;
    // Sources count by their moments, targets by their farthest point.
    const double reach = std::max(a.spread + b.radius, a.radius + b.spread), ratio = reach * reach / square;
    const double pull = kGravitationalConstant * std::max(crowd(a, b), crowd(b, a)) / square;
    double power = (order & 1) ? ratio : 1.0;  // (reach / r)^(2 order)
    for (int k = order / 2; k > 0; --k) power *= ratio * ratio;
    const double gap = 1.0 - radii / std::sqrt(square), most = tolerance * gap * gap;
    return pull * pull * power < most * most;
  }
};

/// Sorts `candidates` for target cell `a`. Cells meet as a whole when `opening` allows and they share no
/// group; two cells of one and the same group do not meet at all. Symmetric in target and source.
inline void sort_sources(const Tree& tree, const Opening& opening, std::uint32_t a,
                         const std::vector<std::uint32_t>& candidates, Meetings& m) {
  for (auto* list : {&m.far, &m.near, &m.near_mixed, &m.open}) list->clear();
  m.stack.assign(candidates.rbegin(), candidates.rend());
  const Cell& target = tree[a];
  const bool a_leaf = tree.leaf(a);
  while (!m.stack.empty()) {
    const std::uint32_t b = m.stack.back();
    m.stack.pop_back();
    const Cell& source = tree[b];
    const double square = (target.centre - source.centre).squaredNorm();
    const bool far = opening.far(target, source, square);
    const bool b_leaf = tree.leaf(b);
    if (far || (a_leaf && b_leaf) || target.reach > 0.0) {
      const Kinship kinship = tree.kinship(a, b, std::sqrt(square));
      if (kinship == Kinship::kSame) continue;
      if (far && kinship == Kinship::kStrangers) {
        m.far.push_back(b);
        continue;
      }
      if (a_leaf && b_leaf) {
        (kinship == Kinship::kMixed ? m.near_mixed : m.near).push_back(b);
        continue;
      }
    }
    const bool open_b = !b_leaf && (a_leaf || source.radius >= target.radius);
    const bool open_a = !a_leaf && (b_leaf || target.radius >= source.radius);
    auto& list = open_a ? m.open : m.stack;
    if (open_b) {
      list.push_back(static_cast<std::uint32_t>(Tree::child(b, 1)));
      list.push_back(static_cast<std::uint32_t>(Tree::child(b, 0)));
    } else {
      list.push_back(b);
    }
  }
}

/// Walks the tree from the root down for every leaf, in parallel over subtrees. Kernel provides
///   Local                                     what a cell hands down to its children (default: nothing yet)
///   Scratch                                   work space of one task
///   Local descend(cell, const Local& parent, far, Scratch&)       the parent's, moved, plus the far cells'
///   void finish(leaf, const Local&, near, near_mixed, Scratch&)   all points of a leaf
template <class Kernel>
class Walk {
 public:
  Walk(const Tree& tree, const Opening& opening, const Kernel& kernel)
      : tree_(tree), opening_(opening), kernel_(kernel) {}

  void run() const {
    // Each task walks the path from the root to its subtree again, which costs little and needs no shared
    // state.
    const unsigned level = std::min(tree_.depth(), kTaskLevel);
    const std::size_t first = (std::size_t{1} << level) - 1;
    parallel_blocks(first + 1, 1, [&](std::size_t begin, std::size_t end) {
      static thread_local Task task;  // its lists keep their room
      for (std::size_t c = begin; c < end; ++c) {
        const std::size_t root = first + c;
        typename Kernel::Local local{};
        task.candidates[0] = {0};
        for (unsigned l = 0; l < level; ++l) {
          local = visit(task, static_cast<std::uint32_t>(((root + 1) >> (level - l)) - 1), l, local);
        }
        subtree(task, static_cast<std::uint32_t>(root), level, local);
      }
    });
  }

 private:
  static constexpr unsigned kTaskLevel = 6;
  static constexpr std::size_t kLevels = 34;  // more than any tree over 32-bit numbers has

  struct Task {
    Meetings meetings;
    std::array<std::vector<std::uint32_t>, kLevels> candidates;  // sources of the present cell of each level
    typename Kernel::Scratch scratch;
  };

  typename Kernel::Local visit(Task& task, std::uint32_t cell, unsigned level,
                               const typename Kernel::Local& parent) const {
    sort_sources(tree_, opening_, cell, task.candidates[level], task.meetings);
    task.candidates[level + 1].swap(task.meetings.open);
    return kernel_.descend(cell, parent, task.meetings.far, task.scratch);
  }

  void subtree(Task& task, std::uint32_t cell, unsigned level, const typename Kernel::Local& parent) const {
    const typename Kernel::Local local = visit(task, cell, level, parent);
    if (tree_.leaf(cell)) {
      kernel_.finish(cell, local, task.meetings.near, task.meetings.near_mixed, task.scratch);
      return;
    }
    for (int k = 0; k < 2; ++k)
      subtree(task, static_cast<std::uint32_t>(Tree::child(cell, k)), level + 1, local);
  }

  const Tree& tree_;
  Opening opening_;
  const Kernel& kernel_;
};

}  // namespace cairn::gravity
