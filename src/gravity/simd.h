// Packs of doubles as wide as the instruction set of the build, with fused multiply-adds where it has them.
#pragma once

#if defined(__AVX512F__) || defined(__FMA__)
#include <immintrin.h>
#endif

#include <cmath>
#include <cstddef>
#include <cstring>

#include "core/math.h"

namespace cairn::gravity {

#if defined(__AVX512F__)
inline constexpr int kLanes = 8;
#elif defined(__AVX__)
inline constexpr int kLanes = 4;
#else
inline constexpr int kLanes = 2;
#endif

/// kLanes doubles; the operators work lane by lane.
using Pack [[gnu::vector_size(kLanes * sizeof(double))]] = double;

inline Pack spread(double value) {
  return Pack{} + value;
}

inline Pack load(const double* from) {
  Pack pack;
  std::memcpy(&pack, from, sizeof pack);
  return pack;
}

inline void store(double* to, Pack pack) {
  std::memcpy(to, &pack, sizeof pack);
}

/// Vectors, one to a lane.
struct PackVec {
  Pack x{}, y{}, z{};

  friend PackVec operator+(const PackVec& a, const PackVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend PackVec operator-(const PackVec& a, const PackVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};

/// The first `count` of kLanes vectors, the others are zero.
inline PackVec load(const Vec3* from, std::size_t count) {
  PackVec v;
#if defined(__AVX512F__)
  if (count >= kLanes) {
    using I [[gnu::vector_size(64)]] = long long;
    const double* p = from->data();
    const Pack a = load(p), b = load(p + 8), c = load(p + 16);
    v.x = __builtin_shuffle(__builtin_shuffle(a, b, I{0, 3, 6, 9, 12, 15, 0, 0}), c,
                            I{0, 1, 2, 3, 4, 5, 10, 13});
    v.y = __builtin_shuffle(__builtin_shuffle(a, b, I{1, 4, 7, 10, 13, 0, 0, 0}), c,
                            I{0, 1, 2, 3, 4, 8, 11, 14});
    v.z = __builtin_shuffle(__builtin_shuffle(a, b, I{2, 5, 8, 11, 14, 0, 0, 0}), c,
                            I{0, 1, 2, 3, 4, 9, 12, 15});
    return v;
  }
#endif
  for (std::size_t i = 0; i < kLanes && i < count; ++i) {
    v.x[i] = from[i].x();
    v.y[i] = from[i].y();
    v.z[i] = from[i].z();
  }
  return v;
}

/// Writes the first `count` vectors.
inline void store(Vec3* to, const PackVec& v, std::size_t count) {
#if defined(__AVX512F__)
  if (count >= kLanes) {
    using I [[gnu::vector_size(64)]] = long long;
    double* p = to->data();
    store(p, __builtin_shuffle(__builtin_shuffle(v.x, v.y, I{0, 8, 0, 1, 9, 0, 2, 10}), v.z,
                               I{0, 1, 8, 3, 4, 9, 6, 7}));
    store(p + 8, __builtin_shuffle(__builtin_shuffle(v.x, v.y, I{0, 3, 11, 0, 4, 12, 0, 5}), v.z,
                                   I{10, 1, 2, 11, 4, 5, 12, 7}));
    store(p + 16, __builtin_shuffle(__builtin_shuffle(v.x, v.y, I{13, 0, 6, 14, 0, 7, 15, 0}), v.z,
                                    I{0, 13, 2, 3, 14, 5, 6, 15}));
    return;
  }
#endif
  for (std::size_t i = 0; i < kLanes && i < count; ++i) to[i] = Vec3(v.x[i], v.y[i], v.z[i]);
}

/// 1 in the first `count` lanes, 0 in the others.
inline Pack head(std::size_t count) {
  Pack pack;
  for (int i = 0; i < kLanes; ++i) pack[i] = static_cast<std::size_t>(i) < count ? 1.0 : 0.0;
  return pack;
}

/// a b + c, rounded once where the instruction set can.
inline Pack fma(Pack a, Pack b, Pack c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_pd(a, b, c);
#elif defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}

/// 1 / a to four digits where the instruction set has an estimate; always the same for the same a.
inline Pack rough_reciprocal(Pack a) {
#if defined(__AVX512F__)
  return _mm512_maskz_rcp14_pd(0xff, a);
#else
  return 1.0 / a;
#endif
}

inline Pack dot(const PackVec& a, const PackVec& b) {
  return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}

inline PackVec cross(const PackVec& a, const PackVec& b) {
  return {fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x))};
}

/// s a + b
inline PackVec fma(Pack s, const PackVec& a, const PackVec& b) {
  return {fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z)};
}

inline PackVec spread(const Vec3& a) {
  return {spread(a.x()), spread(a.y()), spread(a.z())};
}

/// Sum of the lanes, in a fixed order.
inline double sum(Pack pack) {
  double lane[kLanes];
  store(lane, pack);
  for (int half = kLanes / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) lane[i] += lane[i + half];
  }
  return lane[0];
}

inline Vec3 sum(const PackVec& a) {
  return {sum(a.x), sum(a.y), sum(a.z)};
}

/// One truth value per lane.
#if defined(__AVX512F__)
using Mask = __mmask8;
inline Mask greater(Pack a, Pack b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ);
}
inline Mask differ(Pack a, Pack b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_NEQ_UQ);
}
#else
using Mask = decltype(Pack{} > Pack{});
inline Mask greater(Pack a, Pack b) {
  return a > b;
}
inline Mask differ(Pack a, Pack b) {
  return a != b;
}
#endif

struct InversePowers {
  Pack first, third;
};

/// `mass` / r and `mass` / r^3 where r^2 = `square`, to a few units in the last place; 0 outside `mask`.
/// With AVX-512 y = rsqrt14 leaves h = 1 - r^2 y^2 below 2^-13, and the series of (1-h)^(-1/2) and
/// (1-h)^(-3/2) are cut after h^3.
template <bool need_first>
inline InversePowers inverse_powers(Mask mask, Pack square, Pack mass) {
#if defined(__AVX512F__)
  const Pack y = _mm512_maskz_rsqrt14_pd(mask, square);
  const Pack y2 = y * y;
  const Pack h = _mm512_fnmadd_pd(square, y2, spread(1.0));
  const Pack my = mass * y, my3 = my * y2;
  const Pack s3 = fma(fma(h, spread(35.0 / 16), spread(15.0 / 8)), h, spread(1.5)) * h;
  InversePowers result{Pack{}, fma(my3, s3, my3)};
  if constexpr (need_first) {
    const Pack s1 = fma(fma(h, spread(5.0 / 16), spread(3.0 / 8)), h, spread(0.5)) * h;
    result.first = fma(my, s1, my);
  }
  return result;
#else
  Pack root;
  for (int i = 0; i < kLanes; ++i) root[i] = std::sqrt(square[i]);
  const Pack first = mass / root, third = first / square;
  return {mask ? first : Pack{}, mask ? third : Pack{}};
#endif
}

}  // namespace cairn::gravity
