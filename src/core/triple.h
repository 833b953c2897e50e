// A vector whose components are doubles or batches of them.
#pragma once

namespace cairn {

template <class T>
struct Triple {
  T x, y, z;
};

/// Here for code that is not compiled for each instruction set; all else is in core/simd-inl.h.
inline Triple<double> operator*(double s, const Triple<double>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

}  // namespace cairn
