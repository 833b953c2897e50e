// Points as the kernels read them.
#pragma once

#include <vector>

#include "core/math.h"
#include "gravity/points.h"

namespace cairn::gravity {

/// Points as separate arrays, padded with massless points so that eight can be read anywhere.
struct PointArrays {
  static constexpr std::size_t kPadding = 8;
  std::vector<double> x, y, z;  ///< m
  std::vector<double> mass;     ///< kg
  std::vector<double> group;    ///< group number

  void resize(std::size_t points) {
    const std::size_t padded = points + kPadding;
    for (auto* column : {&x, &y, &z, &mass, &group}) column->resize(padded);
    for (std::size_t i = points; i < padded; ++i) set(i, Vec3::Zero(), 0.0, -1.0);
  }
  void assign(const Points& points) {
    resize(points.size());
    for (std::size_t g = 0; g < points.groups(); ++g)
      for (std::size_t i = points.first[g]; i < points.first[g + 1]; ++i)
        set(i, points.positions[i], points.masses[i], static_cast<double>(g));
  }
  void set(std::size_t i, const Vec3& position, double m, double g) {
    x[i] = position.x();
    y[i] = position.y();
    z[i] = position.z();
    mass[i] = m;
    group[i] = g;
  }
};

}  // namespace cairn::gravity
