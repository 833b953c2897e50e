// Doubles, several at once: a thin layer over Highway. Code that uses it is compiled once for each
// instruction set and one of the results is chosen as the program starts; so this file, and every other that
// ends in -inl.h, is read again for each (see "foreach_target.h" in Highway's manual).
//
// Bits do not depend on the instruction set where it has fused multiply-adds: all operations are those that
// IEEE 754 fixes, and whoever adds lanes up does so over eight logical ones (Octet).

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/triple.h"

#if defined(CAIRN_CORE_SIMD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_CORE_SIMD_INL_H
#undef CAIRN_CORE_SIMD_INL_H
#else
#define CAIRN_CORE_SIMD_INL_H
#endif

/// The compiler's cost model thinks these bodies large and calls them; a call spills every register.
#ifndef CAIRN_INLINE
#define CAIRN_INLINE [[gnu::always_inline]] inline
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 8>;
inline constexpr std::size_t kLanes = hn::MaxLanes(Tag());

/// Truth values, one a lane.
struct Mask {
  hn::Mask<Tag> v;
  CAIRN_INLINE friend Mask operator&(Mask a, Mask b) { return {hn::And(a.v, b.v)}; }
  CAIRN_INLINE friend Mask operator|(Mask a, Mask b) { return {hn::Or(a.v, b.v)}; }
  CAIRN_INLINE friend Mask operator!(Mask a) { return {hn::Not(a.v)}; }
};

/// As many doubles as a register has.
struct Batch {
  hn::Vec<Tag> v;

  Batch() = default;
  CAIRN_INLINE Batch(hn::Vec<Tag> x) : v(x) {}
  CAIRN_INLINE Batch(double x) : v(hn::Set(Tag(), x)) {}
  CAIRN_INLINE static Batch load(const double* from) { return hn::LoadU(Tag(), from); }
  CAIRN_INLINE void store(double* to) const { hn::StoreU(v, Tag(), to); }

  CAIRN_INLINE friend Batch operator+(Batch a, Batch b) { return hn::Add(a.v, b.v); }
  CAIRN_INLINE friend Batch operator-(Batch a, Batch b) { return hn::Sub(a.v, b.v); }
  CAIRN_INLINE friend Batch operator*(Batch a, Batch b) { return hn::Mul(a.v, b.v); }
  CAIRN_INLINE friend Batch operator/(Batch a, Batch b) { return hn::Div(a.v, b.v); }
  CAIRN_INLINE friend Batch operator-(Batch a) { return hn::Neg(a.v); }
  CAIRN_INLINE friend Mask operator<(Batch a, Batch b) { return {hn::Lt(a.v, b.v)}; }
  CAIRN_INLINE friend Mask operator>(Batch a, Batch b) { return {hn::Gt(a.v, b.v)}; }
};

/// The lanes of a batch in memory, to be set and read one by one.
struct Lanes {
  alignas(64) double v[kLanes];

  Lanes() = default;
  CAIRN_INLINE explicit Lanes(Batch b) { hn::Store(b.v, Tag(), v); }
  CAIRN_INLINE double& operator[](std::size_t lane) { return v[lane]; }
  CAIRN_INLINE double operator[](std::size_t lane) const { return v[lane]; }
  CAIRN_INLINE Batch batch() const { return hn::Load(Tag(), v); }
};

CAIRN_INLINE Batch& operator+=(Batch& a, Batch b) {
  return a = a + b;
}
CAIRN_INLINE Batch& operator-=(Batch& a, Batch b) {
  return a = a - b;
}

CAIRN_INLINE bool any(Mask m) {
  return !hn::AllFalse(Tag(), m.v);
}
CAIRN_INLINE bool any(bool m) {
  return m;
}

/// Bit l: lane l.
CAIRN_INLINE unsigned bits(Mask m) {
  std::uint8_t byte[8] = {};
  hn::StoreMaskBits(Tag(), m.v, byte);
  return byte[0] & ((1u << kLanes) - 1u);
}

/// Writes first + l for every lane l that m has, in order; `to` has room for all. Returns how many.
CAIRN_INLINE std::size_t write_lanes(Mask m, std::uint32_t first, std::uint32_t* to) {
#if HWY_TARGET <= HWY_AVX3
  using Whole = hn::RebindToUnsigned<Tag>;
  const auto lanes = hn::Iota(Whole(), first);
  const auto packed = hn::Compress(lanes, hn::RebindMask(Whole(), m.v));
  hn::StoreU(hn::TruncateTo(hn::Rebind<std::uint32_t, Tag>(), packed), hn::Rebind<std::uint32_t, Tag>(), to);
  return hn::CountTrue(Tag(), m.v);
#else
  const unsigned set = bits(m);
  std::size_t count = 0;
  for (std::uint32_t l = 0; l < kLanes; ++l) {
    to[count] = first + l;
    count += set >> l & 1u;
  }
  return count;
#endif
}

CAIRN_INLINE Batch select(Mask m, Batch yes, Batch no) {
  return hn::IfThenElse(m.v, yes.v, no.v);
}
CAIRN_INLINE double select(bool m, double yes, double no) {
  return m ? yes : no;
}

CAIRN_INLINE double min(double a, double b) {
  return a < b ? a : b;
}
CAIRN_INLINE double max(double a, double b) {
  return a > b ? a : b;
}
// Of zeros of two signs and of NaN the instruction sets have different opinions.
#if HWY_ARCH_X86
CAIRN_INLINE Batch min(Batch a, Batch b) {
  return hn::Min(a.v, b.v);
}
CAIRN_INLINE Batch max(Batch a, Batch b) {
  return hn::Max(a.v, b.v);
}
#else
CAIRN_INLINE Batch min(Batch a, Batch b) {
  return select(a < b, a, b);
}
CAIRN_INLINE Batch max(Batch a, Batch b) {
  return select(a > b, a, b);
}
#endif

CAIRN_INLINE Batch sqrt(Batch a) {
  return hn::Sqrt(a.v);
}
CAIRN_INLINE double sqrt(double a) {
  return __builtin_sqrt(a);
}

CAIRN_INLINE Batch abs(Batch a) {
  return hn::Abs(a.v);
}
CAIRN_INLINE double abs(double a) {
  return __builtin_fabs(a);
}

/// a * b + c, fused where the instruction set has it.
CAIRN_INLINE double fma(double a, double b, double c) {
#if HWY_NATIVE_FMA
  return __builtin_fma(a, b, c);
#else
  return a * b + c;
#endif
}
CAIRN_INLINE Batch fma(Batch a, Batch b, Batch c) {
  return hn::MulAdd(a.v, b.v, c.v);
}

/// 1 / sqrt(a) to the last bit or two, for a > 0 that is no subnormal: from half the exponent, right to 3.5
/// %, by two steps of fourth order, which need neither a root nor a division.
CAIRN_INLINE double rsqrt(double a) {
  return 1.0 / __builtin_sqrt(a);
}
CAIRN_INLINE Batch rsqrt(Batch a) {
  const hn::RebindToUnsigned<Tag> whole;
  const auto half = hn::ShiftRight<1>(hn::BitCast(whole, a.v));
  Batch y = hn::BitCast(Tag(), hn::Sub(hn::Set(whole, 0x5FE6EB50C7B537A9ull), half));
  for (int step = 0; step < 2; ++step) {
    const Batch e = fma(a * y, -y, Batch(1.0));
    y = fma(y * e, fma(e, fma(e, Batch(0.3125), Batch(0.375)), Batch(0.5)), y);
  }
  return y;
}

/// Transposes four vectors within blocks of four lanes (of two, where there are no more).
CAIRN_INLINE void transpose(Batch (&r)[4]) {
  const Tag d;
  const auto a = hn::InterleaveLower(d, r[0].v, r[1].v), b = hn::InterleaveUpper(d, r[0].v, r[1].v);
  const auto c = hn::InterleaveLower(d, r[2].v, r[3].v), e = hn::InterleaveUpper(d, r[2].v, r[3].v);
#if HWY_TARGET <= HWY_AVX3
  r[0] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(c), a);
  r[1] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(e), b);
  r[2] = hn::OddEvenBlocks(c, hn::SwapAdjacentBlocks(a));
  r[3] = hn::OddEvenBlocks(e, hn::SwapAdjacentBlocks(b));
#else
  r[0] = hn::ConcatLowerLower(d, c, a);
  r[1] = hn::ConcatLowerLower(d, e, b);
  r[2] = hn::ConcatUpperUpper(d, c, a);
  r[3] = hn::ConcatUpperUpper(d, e, b);
#endif
}

/// Reads `columns` (4 or 8) consecutive doubles from each of kLanes rows: column k of the rows comes out as
/// out[k].
template <std::size_t columns>
CAIRN_INLINE void load_transposed(const double* const (&rows)[kLanes], Batch (&out)[columns]) {
  static_assert(columns % 4 == 0);
  for (std::size_t c = 0; c < columns; c += 4) {
    Batch r[4];
#if HWY_TARGET <= HWY_AVX3
    const hn::Half<Tag> half;
    for (std::size_t k = 0; k < 4; ++k)
      r[k] = hn::Combine(Tag(), hn::LoadU(half, rows[k + 4] + c), hn::LoadU(half, rows[k] + c));
    transpose(r);
#elif HWY_TARGET == HWY_AVX2
    for (std::size_t k = 0; k < 4; ++k) r[k] = Batch::load(rows[k] + c);
    transpose(r);
#else
    static_assert(kLanes == 2);
    for (std::size_t k = 0; k < 4; k += 2) {
      const Batch a = Batch::load(rows[0] + c + k), b = Batch::load(rows[1] + c + k);
      r[k] = hn::InterleaveLower(Tag(), a.v, b.v);
      r[k + 1] = hn::InterleaveUpper(Tag(), a.v, b.v);
    }
#endif
    for (std::size_t k = 0; k < 4; ++k) out[c + k] = r[k];
  }
}

/// The inverse of four columns: writes in[k], lane l to rows[l][k].
CAIRN_INLINE void store_transposed(const Batch (&in)[4], double* const (&rows)[kLanes]) {
  Batch r[4] = {in[0], in[1], in[2], in[3]};
#if HWY_TARGET <= HWY_AVX3
  const hn::Half<Tag> half;
  transpose(r);
  for (std::size_t k = 0; k < 4; ++k) {
    hn::StoreU(hn::LowerHalf(half, r[k].v), half, rows[k]);
    hn::StoreU(hn::UpperHalf(half, r[k].v), half, rows[k + 4]);
  }
#elif HWY_TARGET == HWY_AVX2
  transpose(r);
  for (std::size_t k = 0; k < 4; ++k) r[k].store(rows[k]);
#else
  for (std::size_t k = 0; k < 4; k += 2) {
    Batch(hn::InterleaveLower(Tag(), r[k].v, r[k + 1].v)).store(rows[0] + k);
    Batch(hn::InterleaveUpper(Tag(), r[k].v, r[k + 1].v)).store(rows[1] + k);
  }
#endif
}

/// Several registers as one.
template <class Half>
struct Twice {
  Half low, high;

  Twice() = default;
  CAIRN_INLINE Twice(Half l, Half h) : low(l), high(h) {}
  CAIRN_INLINE Twice(double x) : low(x), high(x) {}
  CAIRN_INLINE static Twice load(const double* from) {
    return {Half::load(from), Half::load(from + sizeof(Half) / sizeof(double))};
  }
  CAIRN_INLINE void store(double* to) const {
    low.store(to);
    high.store(to + sizeof(Half) / sizeof(double));
  }
  CAIRN_INLINE friend Twice operator+(Twice a, Twice b) { return {a.low + b.low, a.high + b.high}; }
  CAIRN_INLINE friend Twice operator-(Twice a, Twice b) { return {a.low - b.low, a.high - b.high}; }
  CAIRN_INLINE friend Twice operator*(Twice a, Twice b) { return {a.low * b.low, a.high * b.high}; }
  CAIRN_INLINE friend Twice operator/(Twice a, Twice b) { return {a.low / b.low, a.high / b.high}; }
  CAIRN_INLINE friend Twice operator-(Twice a) { return {-a.low, -a.high}; }
  CAIRN_INLINE friend Twice operator&(Twice a, Twice b) { return {a.low & b.low, a.high & b.high}; }
  CAIRN_INLINE friend Twice fma(Twice a, Twice b, Twice c) {
    return {fma(a.low, b.low, c.low), fma(a.high, b.high, c.high)};
  }
  CAIRN_INLINE friend Twice rsqrt(Twice a) { return {rsqrt(a.low), rsqrt(a.high)}; }
  CAIRN_INLINE friend Twice min(Twice a, Twice b) { return {min(a.low, b.low), min(a.high, b.high)}; }
  CAIRN_INLINE friend Twice max(Twice a, Twice b) { return {max(a.low, b.low), max(a.high, b.high)}; }
};
template <class H>
CAIRN_INLINE auto operator>(const Twice<H>& a, const Twice<H>& b) {
  return Twice<decltype(a.low > b.low)>(a.low > b.low, a.high > b.high);
}
template <class M, class H>
CAIRN_INLINE Twice<H> select(const Twice<M>& m, const Twice<H>& yes, const Twice<H>& no) {
  return {select(m.low, yes.low, no.low), select(m.high, yes.high, no.high)};
}
template <class H>
CAIRN_INLINE Twice<H>& operator+=(Twice<H>& a, const Twice<H>& b) {
  return a = a + b;
}

/// Eight logical lanes, whatever a register has.
#if HWY_TARGET <= HWY_AVX3
using Octet = Batch;
#elif HWY_TARGET == HWY_AVX2
using Octet = Twice<Batch>;
#else
using Octet = Twice<Twice<Batch> >;
#endif

/// The pairs (a, 0, b, 0) of each lane.
CAIRN_INLINE void to_rows(const Triple<Batch>& a, const Triple<Batch>& b, Octet (&row)[kLanes]) {
#if HWY_TARGET <= HWY_AVX2
  Batch p[4] = {a.x, a.y, a.z, Batch(0.0)}, q[4] = {b.x, b.y, b.z, Batch(0.0)};
  transpose(p);
  transpose(q);
  for (std::size_t k = 0; k < 4; ++k) {
#if HWY_TARGET <= HWY_AVX3
    row[k] = hn::ConcatLowerLower(Tag(), q[k].v, p[k].v);
    row[k + 4] = hn::ConcatUpperUpper(Tag(), q[k].v, p[k].v);
#else
    row[k] = {p[k], q[k]};
#endif
  }
#else
  const Tag d;
  const auto zero = hn::Zero(d);
  row[0] = {{hn::InterleaveLower(d, a.x.v, a.y.v), hn::InterleaveLower(d, a.z.v, zero)},
            {hn::InterleaveLower(d, b.x.v, b.y.v), hn::InterleaveLower(d, b.z.v, zero)}};
  row[1] = {{hn::InterleaveUpper(d, a.x.v, a.y.v), hn::InterleaveUpper(d, a.z.v, zero)},
            {hn::InterleaveUpper(d, b.x.v, b.y.v), hn::InterleaveUpper(d, b.z.v, zero)}};
#endif
}

// A vector whose components are doubles or batches.
template <class T>
CAIRN_INLINE Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
CAIRN_INLINE Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
CAIRN_INLINE Triple<T> operator*(std::type_identity_t<T> s, const Triple<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
/// s a + b
template <class T>
CAIRN_INLINE Triple<T> fma(std::type_identity_t<T> s, const Triple<T>& a, const Triple<T>& b) {
  return {fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)};
}
template <class T>
CAIRN_INLINE T dot(const Triple<T>& a, const Triple<T>& b) {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}
template <class T>
CAIRN_INLINE Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn
HWY_AFTER_NAMESPACE();

#endif
