// Point sets and measures that the gravity tests share.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/random.h"
#include "gravity/points.h"

namespace cairn::gravity {

struct Cloud {
  std::vector<Vec3> x;
  std::vector<double> mass;
  std::vector<std::uint32_t> first{0};

  void add_group(const std::vector<Vec3>& positions, double each) {
    x.insert(x.end(), positions.begin(), positions.end());
    mass.insert(mass.end(), positions.size(), each);
    first.push_back(static_cast<std::uint32_t>(x.size()));
  }
  Points points() const { return {x, mass, first}; }
  std::size_t size() const { return x.size(); }
};

/// n points in a ball of 400 m with masses of 1e9 to 2e9 kg, in groups of `group` neighbours within 10 m.
inline Cloud ball(std::size_t n, std::size_t group = 1, std::uint64_t seed = 1) {
  Cloud cloud;
  Random random(seed, 0);
  for (std::size_t i = 0; i < n; i += group) {
    const Vec3 centre = 400.0 * random.in_ball();
    std::vector<Vec3> members{centre};
    while (members.size() < std::min(group, n - i)) members.push_back(centre + 10.0 * random.in_ball());
    cloud.add_group(members, 1e9 * (1.0 + random.uniform()));
  }
  return cloud;
}

struct Field {
  std::vector<Vec3> acceleration;
  std::vector<double> potential;
};

template <class Method>
Field evaluate(Method&& method, const Cloud& cloud) {
  Field f{std::vector<Vec3>(cloud.size()), std::vector<double>(cloud.size())};
  method.evaluate(cloud.points(), f.acceleration, f.potential);
  return f;
}

/// The pair sum in long double.
inline Field exact(const Cloud& cloud) {
  Field f;
  for (std::size_t g = 0; g + 1 < cloud.first.size(); ++g) {
    for (std::size_t i = cloud.first[g]; i < cloud.first[g + 1]; ++i) {
      Eigen::Matrix<long double, 3, 1> a = Eigen::Matrix<long double, 3, 1>::Zero();
      long double phi = 0.0L;
      for (std::size_t j = 0; j < cloud.size(); ++j) {
        if (j >= cloud.first[g] && j < cloud.first[g + 1]) continue;
        const Eigen::Matrix<long double, 3, 1> d =
            cloud.x[j].cast<long double>() - cloud.x[i].cast<long double>();
        const long double r = d.norm();
        if (r == 0.0L) continue;
        a += cloud.mass[j] / (r * r * r) * d;
        phi -= cloud.mass[j] / r;
      }
      f.acceleration.push_back((kGravitationalConstant * a).cast<double>());
      f.potential.push_back(static_cast<double>(kGravitationalConstant * phi));
    }
  }
  return f;
}

/// sqrt(sum |a - b|^2 / sum |b|^2).
inline double rms_error(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]).squaredNorm();
    size += b[i].squaredNorm();
  }
  return std::sqrt(difference / size);
}

/// The part-th quantile of |a - b| over rms |b|.
inline double quantile_error(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double part) {
  std::vector<double> errors;
  double size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    errors.push_back((a[i] - b[i]).norm());
    size += b[i].squaredNorm() / static_cast<double>(a.size());
  }
  std::sort(errors.begin(), errors.end());
  return errors[static_cast<std::size_t>(part * static_cast<double>(a.size() - 1))] / std::sqrt(size);
}

inline double worst_relative(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] / b[i] - 1.0));
  return worst;
}

/// Net force and net torque about the mass centre, each over the sum of magnitudes of its terms.
struct Net {
  double force, torque;
};
inline Net net(const Cloud& cloud, const std::vector<Vec3>& acceleration) {
  Vec3 centre = Vec3::Zero(), force = Vec3::Zero(), torque = Vec3::Zero();
  double mass = 0.0, forces = 0.0, torques = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    mass += cloud.mass[i];
    centre += cloud.mass[i] * cloud.x[i];
  }
  centre /= mass;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3 f = cloud.mass[i] * acceleration[i];
    force += f;
    torque += (cloud.x[i] - centre).cross(f);
    forces += f.norm();
    torques += (cloud.x[i] - centre).norm() * f.norm();
  }
  return {force.norm() / forces, torque.norm() / torques};
}

}  // namespace cairn::gravity
