// Sums of volume integrals, and mass properties from them.
#pragma once

#include "shape/shape.h"

namespace cairn {

/// Integrals of 1, x and x x^T over a solid, about a common origin.
struct SolidMoments {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();

  SolidMoments& operator+=(const SolidMoments& other) {
    volume += other.volume;
    first += other.first;
    second += other.second;
    return *this;
  }
};

/// `origin`: where the integrals are about.
inline MassProperties about_centroid(const SolidMoments& moments, const Vec3& origin) {
  const Vec3 centroid = moments.first / moments.volume;
  const Mat3 second = moments.second - moments.volume * centroid * centroid.transpose();
  return {moments.volume, origin + centroid, second.trace() * Mat3::Identity() - second};
}

}  // namespace cairn
