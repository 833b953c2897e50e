// Packs of doubles as wide as the instruction set of the build, with fused multiply-adds where it has them.
#pragma once

#if defined(__AVX512F__) || defined(__FMA__)
#include <immintrin.h>
#endif

#include <cmath>
#include <cstddef>
#include <cstring>

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

/// Sum of the lanes, in a fixed order.
inline double sum(Pack pack) {
  double lane[kLanes];
  store(lane, pack);
  for (int half = kLanes / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) lane[i] += lane[i + half];
  }
  return lane[0];
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
