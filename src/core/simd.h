// Eight doubles at once, on every instruction set (the compiler splits them where registers are shorter).
// The same functions exist for double, so that one template serves a scalar test and a vector sweep.
#pragma once

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace cairn {

inline constexpr std::size_t kLanes = 8;

/// The compiler's cost model thinks these bodies large and calls them; a call spills every register.
#define CAIRN_INLINE [[gnu::always_inline]] inline

/// Result of comparing batches: all bits of a lane set, or none.
struct Mask {
  using Vector = std::int64_t __attribute__((vector_size(64)));
  Vector v;
  CAIRN_INLINE friend Mask operator&(Mask a, Mask b) { return {a.v & b.v}; }
  CAIRN_INLINE friend Mask operator|(Mask a, Mask b) { return {a.v | b.v}; }
  CAIRN_INLINE friend Mask operator!(Mask a) { return {~a.v}; }
};

struct Batch {
  using Vector = double __attribute__((vector_size(64)));
  Vector v;

  Batch() = default;
  Batch(Vector x) : v(x) {}
  Batch(double x) : v(Vector{} + x) {}

  double operator[](std::size_t lane) const { return v[lane]; }
  CAIRN_INLINE friend Batch operator+(Batch a, Batch b) { return a.v + b.v; }
  CAIRN_INLINE friend Batch operator-(Batch a, Batch b) { return a.v - b.v; }
  CAIRN_INLINE friend Batch operator*(Batch a, Batch b) { return a.v * b.v; }
  CAIRN_INLINE friend Batch operator/(Batch a, Batch b) { return a.v / b.v; }
  CAIRN_INLINE friend Batch operator-(Batch a) { return -a.v; }
  Batch& operator+=(Batch a) {
    v += a.v;
    return *this;
  }
  Batch& operator-=(Batch a) {
    v -= a.v;
    return *this;
  }
  CAIRN_INLINE friend Mask operator<(Batch a, Batch b) { return {a.v < b.v}; }
  CAIRN_INLINE friend Mask operator>(Batch a, Batch b) { return {a.v > b.v}; }
};

CAIRN_INLINE bool any(Mask m) {
#ifdef __AVX512F__
  return _mm512_test_epi64_mask((__m512i)m.v, (__m512i)m.v) != 0;
#else
  std::int64_t bits = 0;
  for (std::size_t l = 0; l < kLanes; ++l) bits |= m.v[l];
  return bits != 0;
#endif
}
CAIRN_INLINE bool any(bool m) {
  return m;
}

/// Writes first + l for every lane l that m has, in order; `to` has room for all. Returns how many.
CAIRN_INLINE std::size_t write_lanes(Mask m, std::uint32_t first, std::uint32_t* to) {
#ifdef __AVX512F__
  const __mmask8 bits = _mm512_test_epi64_mask((__m512i)m.v, (__m512i)m.v);
  const __m512i lanes = (__m512i)(Mask::Vector{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<std::int64_t>(first));
  const __m256i packed = _mm512_maskz_cvtepi64_epi32(0xff, _mm512_maskz_compress_epi64(bits, lanes));
  __builtin_memcpy(to, &packed, sizeof packed);
  return static_cast<std::size_t>(__builtin_popcount(bits));
#else
  std::size_t count = 0;
  for (std::size_t l = 0; l < kLanes; ++l) {
    to[count] = first + static_cast<std::uint32_t>(l);
    count += m.v[l] != 0;
  }
  return count;
#endif
}

CAIRN_INLINE Batch select(Mask m, Batch yes, Batch no) {
  return m.v ? yes.v : no.v;
}
CAIRN_INLINE double select(bool m, double yes, double no) {
  return m ? yes : no;
}

CAIRN_INLINE Batch min(Batch a, Batch b) {
  return a.v < b.v ? a.v : b.v;
}
CAIRN_INLINE Batch max(Batch a, Batch b) {
  return a.v > b.v ? a.v : b.v;
}
CAIRN_INLINE double min(double a, double b) {
  return a < b ? a : b;
}
CAIRN_INLINE double max(double a, double b) {
  return a > b ? a : b;
}

CAIRN_INLINE Batch sqrt(Batch a) {
  Batch r;
  for (std::size_t l = 0; l < kLanes; ++l) r.v[l] = __builtin_sqrt(a.v[l]);
  return r;
}
CAIRN_INLINE double sqrt(double a) {
  return __builtin_sqrt(a);
}

CAIRN_INLINE Batch abs(Batch a) {
  return max(a, -a);
}
CAIRN_INLINE double abs(double a) {
  return __builtin_fabs(a);
}

/// a * b + c, fused where the instruction set has it.
CAIRN_INLINE double fma(double a, double b, double c) {
#ifdef __FMA__
  return __builtin_fma(a, b, c);
#else
  return a * b + c;
#endif
}
CAIRN_INLINE Batch fma(Batch a, Batch b, Batch c) {
#ifdef __FMA__
  Batch r;
  for (std::size_t l = 0; l < kLanes; ++l) r.v[l] = __builtin_fma(a.v[l], b.v[l], c.v[l]);
  return r;
#else
  return a * b + c;
#endif
}

/// 1 / sqrt(a) to the last bit or two, for a > 0: where the instruction set has an estimate of 14 bits, from
/// that by one step of fourth order, which needs neither a root nor a division.
CAIRN_INLINE double rsqrt(double a) {
  return 1.0 / __builtin_sqrt(a);
}
CAIRN_INLINE Batch rsqrt(Batch a) {
#ifdef __AVX512F__
  const Batch y = (Batch::Vector)_mm512_maskz_rsqrt14_pd(0xff, (__m512d)a.v);
  const Batch e = fma(a * y, -y, Batch(1.0));
  return fma(y * e, fma(e, fma(e, Batch(0.3125), Batch(0.375)), Batch(0.5)), y);
#else
  return Batch(1.0) / sqrt(a);
#endif
}

namespace simd_detail {

using V = Batch::Vector;
using Half = double __attribute__((vector_size(32)));
using I = Mask::Vector;

/// Four doubles from each of two places.
CAIRN_INLINE V load(const double* low, const double* high) {
#ifdef __AVX512F__
  return (V)_mm512_maskz_insertf64x4(0xff, _mm512_castpd256_pd512(_mm256_loadu_pd(low)),
                                     _mm256_loadu_pd(high), 1);
#else
  Half a, b;
  __builtin_memcpy(&a, low, sizeof a);
  __builtin_memcpy(&b, high, sizeof b);
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

/// Transposes two 4 x 4 blocks side by side: pairs, then halves.
CAIRN_INLINE void transpose(V (&r)[4]) {
  constexpr I low1{0, 8, 2, 10, 4, 12, 6, 14}, high1{1, 9, 3, 11, 5, 13, 7, 15};
  constexpr I low2{0, 1, 8, 9, 4, 5, 12, 13}, high2{2, 3, 10, 11, 6, 7, 14, 15};
  const V a = __builtin_shuffle(r[0], r[1], low1), b = __builtin_shuffle(r[0], r[1], high1);
  const V c = __builtin_shuffle(r[2], r[3], low1), d = __builtin_shuffle(r[2], r[3], high1);
  r[0] = __builtin_shuffle(a, c, low2);
  r[1] = __builtin_shuffle(b, d, low2);
  r[2] = __builtin_shuffle(a, c, high2);
  r[3] = __builtin_shuffle(b, d, high2);
}

}  // namespace simd_detail

/// Reads `columns` (4 or 8) consecutive doubles from each of 8 rows: column k of the rows comes out as
/// out[k].
template <std::size_t columns>
CAIRN_INLINE void load_transposed(const double* const (&rows)[kLanes], Batch (&out)[columns]) {
  static_assert(columns == 4 || columns == 8);
  for (std::size_t c = 0; c < columns; c += 4) {
    simd_detail::V r[4];
    for (std::size_t k = 0; k < 4; ++k) r[k] = simd_detail::load(rows[k] + c, rows[k + 4] + c);
    simd_detail::transpose(r);
    for (std::size_t k = 0; k < 4; ++k) out[c + k] = r[k];
  }
}

/// The inverse: writes in[k], lane l to rows[l][k].
template <std::size_t columns>
CAIRN_INLINE void store_transposed(const Batch (&in)[columns], double* const (&rows)[kLanes]) {
  static_assert(columns == 4 || columns == 8);
  for (std::size_t c = 0; c < columns; c += 4) {
    simd_detail::V r[4];
    for (std::size_t k = 0; k < 4; ++k) r[k] = in[c + k].v;
    simd_detail::transpose(r);
    for (std::size_t k = 0; k < 4; ++k) {
      __builtin_memcpy(rows[k] + c, &r[k], sizeof(simd_detail::Half));
      const simd_detail::Half high = __builtin_shufflevector(r[k], r[k], 4, 5, 6, 7);
      __builtin_memcpy(rows[k + 4] + c, &high, sizeof high);
    }
  }
}

/// Writes to a cache line past the caches where the instruction set can, as for what will not be read soon.
CAIRN_INLINE void stream(Batch a, double* line) {
#ifdef __AVX512F__
  _mm512_stream_pd(line, (__m512d)a.v);
#else
  __builtin_memcpy(line, &a, sizeof a);
#endif
}
/// Before other threads read what this one has streamed.
CAIRN_INLINE void end_of_streams() {
#ifdef __AVX512F__
  _mm_sfence();
#endif
}

/// A vector whose components are doubles or batches.
template <class T>
struct Triple {
  T x, y, z;
  CAIRN_INLINE friend Triple operator+(const Triple& a, const Triple& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  CAIRN_INLINE friend Triple operator-(const Triple& a, const Triple& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  CAIRN_INLINE friend Triple operator*(T s, const Triple& a) { return {s * a.x, s * a.y, s * a.z}; }
};

/// s a + b
template <class T>
CAIRN_INLINE Triple<T> fma(T s, const Triple<T>& a, const Triple<T>& b) {
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

/// Eight pairs of vectors, each as (a, 0, b, 0).
CAIRN_INLINE void to_rows(const Triple<Batch>& a, const Triple<Batch>& b, Batch (&row)[kLanes]) {
  constexpr simd_detail::I low{0, 1, 2, 3, 8, 9, 10, 11}, high{4, 5, 6, 7, 12, 13, 14, 15};
  simd_detail::V p[4] = {a.x.v, a.y.v, a.z.v, {}}, q[4] = {b.x.v, b.y.v, b.z.v, {}};
  simd_detail::transpose(p);
  simd_detail::transpose(q);
  for (std::size_t k = 0; k < 4; ++k) {
    row[k] = __builtin_shuffle(p[k], q[k], low);
    row[k + 4] = __builtin_shuffle(p[k], q[k], high);
  }
}

}  // namespace cairn
