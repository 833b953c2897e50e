// Cartesian multipole and local expansions of 1/r up to a fixed order, in the notation of Dehnen 2002
// (J. Comput. Phys. 179, 27), with multi-indices n = (a, b, c), |n| = a + b + c <= order:
//   multipole  M_n = sum over sources m (-t)^n / n!,   t from the cell's centre,
//   local      L_n = sum over |m| <= order - |n| of D_{n+m}(R) M_m,   D_n = d^n (1/R),   R from source to
//   target, sum over sources m / |x - t| = sum over n of s^n / n! L_n,   s from the target cell's centre.
// The same pairs (n, m) serve both directions, so forces of two cells on each other are equal and opposite.
// D is traceless, so of M and of L only the (order+1)^2 components with c <= 1 are independent.

#include <algorithm>
#include <array>
#include <utility>

#include "gravity/pack-inl.h"

#if defined(CAIRN_GRAVITY_EXPANSION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_GRAVITY_EXPANSION_INL_H
#undef CAIRN_GRAVITY_EXPANSION_INL_H
#else
#define CAIRN_GRAVITY_EXPANSION_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {

/// Calls f(std::integral_constant<int, i>) for i in [0, count), unrolled.
template <int count, class F>
CAIRN_INLINE void unroll(F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) HWY_ATTR __attribute__((always_inline)) {
    (f(std::integral_constant<int, i>{}), ...);
  }
  (std::make_integer_sequence<int, count>{});
}

/// The numbering of the multi-indices up to an order: by c, then by degree, so that those with c <= 1 lead.
template <int order>
struct Indices {
  static constexpr int kAll = (order + 1) * (order + 2) * (order + 3) / 6;
  static constexpr int kReduced = (order + 1) * (order + 1);

  struct Index {
    int a, b, c;
    constexpr int degree() const { return a + b + c; }
    constexpr int operator[](int axis) const { return axis == 0 ? a : axis == 1 ? b : c; }
  };
  struct Table {
    std::array<Index, kAll> index{};
    int number[order + 1][order + 1][order + 1]{};
  };
  static constexpr Table kTable = [] {
    Table t;
    int next = 0;
    for (int c = 0; c <= order; ++c) {
      for (int degree = c; degree <= order; ++degree) {
        for (int b = 0; b <= degree - c; ++b) {
          t.index[static_cast<std::size_t>(next)] = {degree - c - b, b, c};
          t.number[degree - c - b][b][c] = next++;
        }
      }
    }
    return t;
  }();
  static constexpr Index at(int i) { return kTable.index[static_cast<std::size_t>(i)]; }
  static constexpr int number(int a, int b, int c) { return kTable.number[a][b][c]; }
  static constexpr int sum(int i, int j) {
    return number(at(i).a + at(j).a, at(i).b + at(j).b, at(i).c + at(j).c);
  }
  /// The index one lower along `axis`, or -1.
  static constexpr int lower(int i, int axis) {
    const Index n = at(i);
    if (n[axis] == 0) return -1;
    return number(n.a - (axis == 0), n.b - (axis == 1), n.c - (axis == 2));
  }
  static constexpr int raise(int i, int axis) {
    const Index n = at(i);
    return number(n.a + (axis == 0), n.b + (axis == 1), n.c + (axis == 2));
  }
};

/// s^n / n! of every multi-index; Real is double or Pack.
template <int order, class Real>
inline std::array<Real, Indices<order>::kAll> powers(Real x, Real y, Real z) {
  using I = Indices<order>;
  const Real s[3] = {x, y, z};
  std::array<Real, I::kAll> result;
  result[0] = Real(1.0);
  unroll<I::kAll - 1>([&](auto k) HWY_ATTR __attribute__((always_inline)) {
    constexpr int n = k + 1;
    constexpr int axis = I::at(n).c > 0 ? 2 : I::at(n).b > 0 ? 1 : 0;
    result[n] = result[I::lower(n, axis)] * s[axis] * Real(1.0 / I::at(n)[axis]);
  });
  return result;
}

/// D_n(x, y, z) for every multi-index with c <= 2 and degree <= order (the others stay unset), where
/// `inverse` = 1/r and `cube` = 1/r^3. By the recursion of McMurchie & Davidson 1978 (J. Comput. Phys. 26,
/// 218), D^k_{n+e} = n_e D^{k+1}_{n-e} + x_e D^{k+1}_n from D^k_0 = (-1)^k (2k-1)!! / r^(2k+1), and the
/// trace.
template <int order>
CAIRN_INLINE void derivatives(Pack x, Pack y, Pack z, Pack inverse, Pack cube,
                              std::array<Pack, Indices<order>::kAll>& d) {
  using I = Indices<order>;
  const Pack s[3] = {x, y, z};
  const Pack square = inverse * inverse;
  Pack seed[order + 1];
  seed[0] = inverse;
  seed[1] = -cube;
  for (int k = 2; k <= order; ++k) seed[k] = seed[k - 1] * square * Pack(1.0 - 2.0 * k);
  unroll<order + 1>([&](auto step) HWY_ATTR __attribute__((always_inline)) {
    constexpr int k = order - step;  // in place: level k replaces level k + 1 from the highest degree down
    unroll<order - k>([&](auto down) HWY_ATTR __attribute__((always_inline)) {
      constexpr int degree = order - k - down;
      unroll<I::kReduced>([&](auto at) HWY_ATTR __attribute__((always_inline)) {
        constexpr int n = at;
        if constexpr (I::at(n).degree() == degree) {
          constexpr int axis = I::at(n).c == 1           ? 2
                               : I::at(n).a == 0         ? 1
                               : I::at(n).b == 0         ? 0
                               : I::at(n).a < I::at(n).b ? 0
                                                         : 1;
          constexpr int one = I::lower(n, axis);
          if constexpr (I::lower(one, axis) >= 0) {
            constexpr int two = I::lower(one, axis);
            d[n] = fma(s[axis], d[one], d[two] * Pack(1.0 * I::at(one)[axis]));
          } else {
            d[n] = s[axis] * d[one];
          }
        }
      });
    });
    d[0] = seed[k];
  });
  unroll<I::kAll>([&](auto at) HWY_ATTR __attribute__((always_inline)) {
    constexpr int n = at;
    if constexpr (I::at(n).c == 2) {
      constexpr int base = I::lower(I::lower(n, 2), 2);
      d[n] = -(d[I::raise(I::raise(base, 0), 0)] + d[I::raise(I::raise(base, 1), 1)]);
    }
  });
}

/// Folds the components of M with c >= 2 into the others: D_{n+2z} = -D_{n+2x} - D_{n+2y}.
template <int order>
inline void reduce_multipole(std::array<double, Indices<order>::kAll>& m, double* reduced) {
  using I = Indices<order>;
  for (int n = I::kAll; n-- > I::kReduced;) {
    const auto i = I::at(n);
    m[static_cast<std::size_t>(I::number(i.a + 2, i.b, i.c - 2))] -= m[static_cast<std::size_t>(n)];
    m[static_cast<std::size_t>(I::number(i.a, i.b + 2, i.c - 2))] -= m[static_cast<std::size_t>(n)];
  }
  std::copy_n(m.begin(), I::kReduced, reduced);
}

/// Adds to the components of L with c >= 2 what the trace of the others `reduced` makes them.
template <int order>
inline void add_expanded(const double* reduced, double* local) {
  using I = Indices<order>;
  std::array<double, I::kAll> l;
  std::copy_n(reduced, I::kReduced, l.begin());
  for (int n = I::kReduced; n < I::kAll; ++n) {
    const auto i = I::at(n);
    l[static_cast<std::size_t>(n)] = -l[static_cast<std::size_t>(I::number(i.a + 2, i.b, i.c - 2))] -
                                     l[static_cast<std::size_t>(I::number(i.a, i.b + 2, i.c - 2))];
  }
  for (int n = 0; n < I::kAll; ++n) local[n] += l[static_cast<std::size_t>(n)];
}

/// The pairs (n, m) with |n| + |m| <= order, numbers of n + m beside them.
template <int order>
struct ShiftTable {
  static constexpr int kPairs = [] {
    int count = 0;
    for (int n = 0; n < Indices<order>::kAll; ++n) {
      for (int m = 0; m < Indices<order>::kAll; ++m) {
        count += Indices<order>::at(n).degree() + Indices<order>::at(m).degree() <= order;
      }
    }
    return count;
  }();
  struct Entry {
    unsigned char n, m, sum;
  };
  static constexpr std::array<Entry, kPairs> kEntries = [] {
    using I = Indices<order>;
    std::array<Entry, kPairs> entries{};
    std::size_t next = 0;
    for (int n = 0; n < I::kAll; ++n) {
      for (int m = 0; m < I::kAll; ++m) {
        if (I::at(n).degree() + I::at(m).degree() > order) continue;
        entries[next++] = {static_cast<unsigned char>(n), static_cast<unsigned char>(m),
                           static_cast<unsigned char>(I::sum(n, m))};
      }
    }
    return entries;
  }();
};

/// Adds a child's folded multipole to its parent's, which is then to be folded itself: what folding leaves
/// out has no field, from any centre. (x, y, z) from the parent's centre to the child's.
template <int order>
inline void shift_multipole(const double* child, double x, double y, double z, double* parent) {
  const auto p = powers<order>(-x, -y, -z);
  for (const auto& e : ShiftTable<order>::kEntries)
    if (e.m < Indices<order>::kReduced) parent[e.sum] = fma(p[e.n], child[e.m], parent[e.sum]);
}

/// Adds a parent's local expansion to its child's; (x, y, z) from the parent's centre to the child's.
template <int order>
inline void shift_local(const double* parent, double x, double y, double z, double* child) {
  const auto p = powers<order>(x, y, z);
  for (const auto& e : ShiftTable<order>::kEntries) child[e.n] = fma(p[e.m], parent[e.sum], child[e.n]);
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#endif
