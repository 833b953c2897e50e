#include "gravity/points.h"

#include <cmath>
#include <stdexcept>

#include "core/error.h"

namespace cairn::gravity {

void check(const Points& points) {
  const std::size_t n = points.size();
  if (points.masses.size() != n || points.first.empty() || points.first.front() != 0 ||
      points.first.back() != n) {
    throw std::invalid_argument("gravity: positions, masses and groups do not fit together");
  }
  for (std::size_t g = 0; g < points.groups(); ++g) {
    if (points.first[g] > points.first[g + 1]) throw std::invalid_argument("gravity: groups overlap");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3& x = points.positions[i];
    if (!x.allFinite()) {
      throw UnstableError("gravity: point {} is at ({}, {}, {}) m", i, x.x(), x.y(), x.z());
    }
    if (!std::isfinite(points.masses[i]) || points.masses[i] < 0.0) {
      throw UnstableError("gravity: point {} has mass {} kg", i, points.masses[i]);
    }
  }
}

}  // namespace cairn::gravity
