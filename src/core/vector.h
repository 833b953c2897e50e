// One vector, three forms: Eigen's, the contact law's triple, and the array in a packed struct.
#pragma once

#include "core/math.h"
#include "core/triple.h"

namespace cairn {

inline Vec3 vector(const Triple<double>& t) {
  return {t.x, t.y, t.z};
}
inline Vec3 vector(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}
inline Triple<double> triple(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace cairn
