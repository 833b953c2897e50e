// Packs of eight points, whatever a register has, so that sums over points have one order.

#include <cmath>
#include <cstddef>

#include "core/math.h"
#include "core/simd-inl.h"

#if defined(CAIRN_GRAVITY_PACK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CAIRN_GRAVITY_PACK_INL_H
#undef CAIRN_GRAVITY_PACK_INL_H
#else
#define CAIRN_GRAVITY_PACK_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {

using cairn::HWY_NAMESPACE::Batch;
using Pack = cairn::HWY_NAMESPACE::Octet;
using PackVec = Triple<Pack>;
inline constexpr std::size_t kPack = 8;  ///< doubles of a pack

CAIRN_INLINE Pack load(const double* from) {
  return Pack::load(from);
}
CAIRN_INLINE PackVec spread(const Vec3& a) {
  return {Pack(a.x()), Pack(a.y()), Pack(a.z())};
}
CAIRN_INLINE PackVec zeros() {
  return {Pack(0.0), Pack(0.0), Pack(0.0)};
}

/// The first `count` of kPack vectors, the others are zero.
CAIRN_INLINE PackVec load(const Vec3* from, std::size_t count) {
  namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET <= HWY_AVX3
  if (count >= kPack) {
    PackVec v;
    hn::LoadInterleaved3(cairn::HWY_NAMESPACE::Tag(), from->data(), v.x.v, v.y.v, v.z.v);
    return v;
  }
#endif
  alignas(64) double x[kPack] = {}, y[kPack] = {}, z[kPack] = {};
  for (std::size_t i = 0; i < kPack && i < count; ++i) {
    x[i] = from[i].x();
    y[i] = from[i].y();
    z[i] = from[i].z();
  }
  return {load(x), load(y), load(z)};
}

/// Writes the first `count` vectors.
CAIRN_INLINE void store(Vec3* to, const PackVec& v, std::size_t count) {
  namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET <= HWY_AVX3
  if (count >= kPack)
    return hn::StoreInterleaved3(v.x.v, v.y.v, v.z.v, cairn::HWY_NAMESPACE::Tag(), to->data());
#endif
  alignas(64) double x[kPack], y[kPack], z[kPack];
  v.x.store(x);
  v.y.store(y);
  v.z.store(z);
  for (std::size_t i = 0; i < kPack && i < count; ++i) to[i] = Vec3(x[i], y[i], z[i]);
}

/// 1 in the first `count` lanes, 0 in the others.
CAIRN_INLINE Pack head(std::size_t count) {
  alignas(64) static constexpr double kOnes[2 * kPack] = {1, 1, 1, 1, 1, 1, 1, 1};
  return load(kOnes + kPack - (count < kPack ? count : kPack));
}

/// Sum of the lanes, in a fixed order.
inline double sum(const Pack& pack) {
  alignas(64) double lane[kPack];
  pack.store(lane);
  for (std::size_t half = kPack / 2; half > 0; half /= 2)
    for (std::size_t i = 0; i < half; ++i) lane[i] += lane[i + half];
  return lane[0];
}
inline Vec3 sum(const PackVec& a) {
  return {sum(a.x), sum(a.y), sum(a.z)};
}

struct InversePowers {
  Pack first, third;
};

/// `mass` / r and `mass` / r^3 where r^2 = `square`, to a few units in the last place; 0 where r^2 is not
/// greater than `least` (> 0).
CAIRN_INLINE InversePowers inverse_powers(const Pack& square, double least, const Pack& mass) {
  const auto counts = square > Pack(least);
  const Pack y = select(counts, rsqrt(square), Pack(0.0));
  const Pack first = mass * y;
  return {first, first * (y * y)};
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#endif
