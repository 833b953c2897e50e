// Principal axes of an inertia tensor.
#pragma once

#include "core/math.h"

namespace cairn {

struct PrincipalFrame {
  Vec3 moments;  ///< ascending
  Mat3 axes;     ///< columns, right-handed
};

/// Moments that are equal to round-off are made equal and their axes turned to the given frame's; signs are
/// those that turn least from the given frame.
PrincipalFrame principal_frame(const Mat3& inertia);

}  // namespace cairn
