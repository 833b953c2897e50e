// External fields.
#pragma once

#include <span>

#include "core/math.h"

namespace cairn::gravity {

/// The same acceleration everywhere.
struct UniformField {
  Vec3 acceleration = Vec3::Zero();  ///< m/s^2
};

/// Adds the field to the accelerations (m/s^2) of points.
inline void add_field(const UniformField& field, std::span<Vec3> acceleration) {
  for (Vec3& a : acceleration) a += field.acceleration;
}

}  // namespace cairn::gravity
