// What the walk does to a cell in the fast multipole method.

#include <algorithm>

#include "core/parallel.h"
#include "gravity/expansion-inl.h"
#include "gravity/pair_kernel-inl.h"
#include "gravity/tree.h"

#if defined(CAIRN_GRAVITY_FMM_KERNEL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_GRAVITY_FMM_KERNEL_INL_H
#undef CAIRN_GRAVITY_FMM_KERNEL_INL_H
#else
#define CAIRN_GRAVITY_FMM_KERNEL_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {

/// Multipoles of every cell, upwards from the leaves: Indices::kReduced numbers a cell, and one row of zeros
/// more.
template <int order>
void gather_multipoles(const Tree& tree, std::vector<double>& reduced) {
  using I = Indices<order>;
  reduced.resize((tree.cells() + 1) * I::kReduced);
  std::fill_n(reduced.end() - I::kReduced, I::kReduced, 0.0);
  const PointArrays& p = tree.points();
  const auto gather = [&](std::size_t cell) HWY_ATTR {
    const Cell& c = tree[cell];
    std::array<double, I::kAll> moments{};
    if (tree.leaf(cell)) {
      std::array<Pack, I::kAll> sums;
      for (Pack& each : sums) each = Pack(0.0);
      for (std::size_t i = tree.begin(cell); i < tree.end(cell); i += kPack) {
        const Pack mass = head(tree.end(cell) - i) * load(&p.mass[i]);
        const auto w = powers<order>(Pack(c.centre.x()) - load(&p.x[i]), Pack(c.centre.y()) - load(&p.y[i]),
                                     Pack(c.centre.z()) - load(&p.z[i]));
        for (std::size_t n = 0; n < w.size(); ++n) sums[n] = fma(mass, w[n], sums[n]);
      }
      for (std::size_t n = 0; n < sums.size(); ++n) moments[n] = sum(sums[n]);
    } else {
      for (int k = 0; k < 2; ++k) {
        const std::size_t child = Tree::child(cell, k);
        const Vec3 d = tree[child].centre - c.centre;
        shift_multipole<order>(&reduced[child * I::kReduced], d.x(), d.y(), d.z(), moments.data());
      }
    }
    reduce_multipole<order>(moments, &reduced[cell * I::kReduced]);
  };
  for (unsigned level = tree.depth() + 1; level-- > 0;) {
    const std::size_t first = (std::size_t{1} << level) - 1;
    parallel_blocks(first + 1, std::max<std::size_t>(1, (first + 1) / 64),
                    [&](std::size_t begin, std::size_t end) HWY_ATTR {
                      for (std::size_t c = begin; c < end; ++c) gather(first + c);
                    });
  }
}

/// The kernel of the walk; adds nothing to the state but the results of finished leaves.
template <int order>
class FmmKernel {
 public:
  using I = Indices<order>;
  using Local = std::array<double, I::kAll>;
  using List = std::vector<std::uint32_t>;
  struct Scratch {
    PointArrays near, mixed;
  };

  FmmKernel(const Tree& tree, const std::vector<double>& reduced, std::span<Vec3> acceleration,
            std::span<double> potential)
      : tree_(tree), reduced_(reduced), acceleration_(acceleration), potential_(potential) {}

  Local descend(std::size_t cell, const Local& parent, const List& far, Scratch&) const {
    Local local{};
    const Vec3 centre = tree_[cell].centre;
    if (cell > 0) {
      const Vec3 d = centre - tree_[Tree::parent(cell)].centre;
      shift_local<order>(parent.data(), d.x(), d.y(), d.z(), local.data());
    }
    if (far.empty()) return local;
    std::array<Pack, I::kReduced> sums;
    for (Pack& each : sums) each = Pack(0.0);
    for (std::size_t i = 0; i < far.size(); i += kPack) meet_far(centre, far, i, sums);
    std::array<double, I::kReduced> total;
    for (std::size_t n = 0; n < total.size(); ++n) total[n] = sum(sums[n]);
    add_expanded<order>(total.data(), local.data());
    return local;
  }

  void finish(std::size_t leaf, const Local& local, const List& near, const List& mixed, Scratch& s) const {
    if (potential_.empty()) {
      finish_leaf<false>(leaf, local, near, mixed, s);
    } else {
      finish_leaf<true>(leaf, local, near, mixed, s);
    }
  }

 private:
  // Adds the expansions of far[i], ..., one to a lane; lanes past the end read the row of zeros.
  void meet_far(const Vec3& centre, const List& far, std::size_t i,
                std::array<Pack, I::kReduced>& sums) const {
    alignas(64) double dx[kPack], dy[kPack], dz[kPack];
    const double* rows[kPack];
    for (std::size_t lane = 0; lane < kPack; ++lane) {
      const std::size_t k = i + lane;
      const std::size_t source = far[std::min(k, far.size() - 1)];
      const Vec3 d = centre - tree_[source].centre;
      dx[lane] = d.x();
      dy[lane] = d.y();
      dz[lane] = d.z();
      rows[lane] = &reduced_[(k < far.size() ? source : tree_.cells()) * I::kReduced];
    }
    std::array<Pack, I::kReduced> m;
    for (std::size_t n = 0; n < m.size(); ++n) {
      alignas(64) double column[kPack];
      for (std::size_t lane = 0; lane < kPack; ++lane) column[lane] = rows[lane][n];
      m[n] = load(column);
    }
    const Pack x = load(dx), y = load(dy), z = load(dz), square = fma(x, x, fma(y, y, z * z));
    const InversePowers w = inverse_powers(square, kCoincident * kCoincident, Pack(1.0));
    std::array<Pack, I::kAll> d;
    derivatives<order>(x, y, z, w.first, w.third, d);
    unroll<I::kReduced>([&](auto at) HWY_ATTR __attribute__((always_inline)) {
      constexpr int n = at;
      Pack total = sums[n];
      unroll<I::kReduced>([&](auto other) HWY_ATTR __attribute__((always_inline)) {
        constexpr int k = other;
        if constexpr (I::at(n).degree() + I::at(k).degree() <= order)
          total = fma(d[I::sum(n, k)], m[k], total);
      });
      sums[n] = total;
    });
  }

  // Copies the points of cells one after the other; returns how many there are.
  std::size_t copy(const List& cells, PointArrays& to) const {
    std::size_t count = 0;
    for (const std::uint32_t c : cells) count += tree_.end(c) - tree_.begin(c);
    to.resize(count);
    const PointArrays& from = tree_.points();
    std::size_t next = 0;
    for (const std::uint32_t c : cells) {
      for (std::size_t i = tree_.begin(c); i < tree_.end(c); ++i, ++next) {
        to.x[next] = from.x[i];
        to.y[next] = from.y[i];
        to.z[next] = from.z[i];
        to.mass[next] = from.mass[i];
        to.group[next] = from.group[i];
      }
    }
    return count;
  }

  template <bool with_potential>
  void finish_leaf(std::size_t leaf, const Local& local, const List& near, const List& mixed,
                   Scratch& s) const {
    const std::size_t begin = tree_.begin(leaf), end = tree_.end(leaf);
    const std::size_t near_count = copy(near, s.near), mixed_count = copy(mixed, s.mixed);
    const PointArrays& p = tree_.points();
    for (std::size_t i = begin; i < end; i += kTile) {
      PairSum sums[kTile];
      for (PairSum& each : sums) each.clear();
      attract<with_potential, false>(p, i, s.near, 0, near_count, sums);
      attract<with_potential, true>(p, i, s.mixed, 0, mixed_count, sums);
      for (std::size_t k = 0; k < kTile && i + k < end; ++k) {
        const std::size_t to = tree_.original(i + k);
        acceleration_[to] = kGravitationalConstant * Vec3(sum(sums[k].x), sum(sums[k].y), sum(sums[k].z));
        if constexpr (with_potential) potential_[to] = -kGravitationalConstant * sum(sums[k].potential);
      }
    }
    add_local<with_potential>(leaf, local);
  }

  // The far field of the leaf's points, a pack of them at a time.
  template <bool with_potential>
  void add_local(std::size_t leaf, const Local& local) const {
    const PointArrays& p = tree_.points();
    const Vec3 c = tree_[leaf].centre;
    for (std::size_t i = tree_.begin(leaf); i < tree_.end(leaf); i += kPack) {
      const auto w = powers<order>(load(&p.x[i]) - Pack(c.x()), load(&p.y[i]) - Pack(c.y()),
                                   load(&p.z[i]) - Pack(c.z()));
      Pack field[3] = {0.0, 0.0, 0.0}, value = 0.0;
      unroll<I::kAll>([&](auto at) HWY_ATTR __attribute__((always_inline)) {
        constexpr int n = at;
        if constexpr (with_potential) value = fma(w[n], Pack(local[n]), value);
        if constexpr (I::at(n).degree() < order) {
          for (int k = 0; k < 3; ++k)
            field[k] = fma(w[n], Pack(local[static_cast<std::size_t>(I::raise(n, k))]), field[k]);
        }
      });
      alignas(64) double lane[4][kPack];
      for (int k = 0; k < 3; ++k) field[k].store(lane[k]);
      if constexpr (with_potential) value.store(lane[3]);
      for (std::size_t k = 0; k < kPack && i + k < tree_.end(leaf); ++k) {
        const std::size_t to = tree_.original(i + k);
        acceleration_[to] += kGravitationalConstant * Vec3(lane[0][k], lane[1][k], lane[2][k]);
        if constexpr (with_potential) potential_[to] -= kGravitationalConstant * lane[3][k];
      }
    }
  }

  const Tree& tree_;
  const std::vector<double>& reduced_;
  std::span<Vec3> acceleration_;
  std::span<double> potential_;
};

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#endif
