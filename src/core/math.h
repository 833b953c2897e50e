// Vectors, matrices, rotations and physical constants (SI).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace cairn {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;  ///< unit quaternion, body frame -> space frame

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kGravitationalConstant = 6.67430e-11;  ///< m^3 kg^-1 s^-2 (CODATA 2018)

constexpr double squared(double x) {
  return x * x;
}
constexpr double cubed(double x) {
  return x * x * x;
}

}  // namespace cairn
