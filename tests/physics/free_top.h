// The free asymmetric top in closed form, by Jacobi's elliptic functions [Landau & Lifshitz, Mechanics, 37].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math.h"

namespace cairn {

struct Elliptic {
  double sn, cn, dn;
};

/// Jacobi's functions of argument u and parameter m = k^2, 0 <= m < 1, by the arithmetic-geometric mean
/// [Abramowitz & Stegun 16.4]. The complement m1 = 1 - m is given: near the separatrix it is small.
inline Elliptic jacobi(double u, double m1) {
  const double m = std::max(0.0, 1.0 - m1);
  std::array<double, 12> a{1.0}, c{std::sqrt(m)};
  double b = std::sqrt(1.0 - m);
  if (m > 0.5) b = std::sqrt(m1);
  std::size_t n = 0;
  for (; std::abs(c[n]) > 1e-15 && n + 1 < a.size(); ++n) {
    a[n + 1] = 0.5 * (a[n] + b);
    c[n + 1] = 0.5 * (a[n] - b);
    b = std::sqrt(a[n] * b);
  }
  double phi = std::ldexp(a[n] * u, static_cast<int>(n));
  for (std::size_t k = n; k > 0; --k) phi = 0.5 * (phi + std::asin(c[k] / a[k] * std::sin(phi)));
  const double sn = std::sin(phi), cn = std::cos(phi);
  return {sn, cn, std::sqrt(1.0 - m + m * cn * cn)};
}

/// A free top with principal moments I1 < I2 < I3 (kg m^2), angular momentum of length L and energy E (J)
/// with 2 E I1 < L^2 < 2 E I3; at time 0 the body-frame momentum lies in the plane of the axes 1 and 3.
class FreeTop {
 public:
  FreeTop(const Vec3& inertia, double momentum, double energy) : inertia_(inertia), length_(momentum) {
    const double l2 = momentum * momentum;
    const double i1 = inertia[0], i2 = inertia[1], i3 = inertia[2];
    const double low = l2 - 2.0 * energy * i1, high = 2.0 * energy * i3 - l2;
    amplitude_[0] = i1 * std::sqrt(high / (i1 * (i3 - i1)));
    amplitude_[2] = i3 * std::sqrt(low / (i3 * (i3 - i1)));
    about_third_ = l2 > 2.0 * energy * i2;
    if (about_third_) {  // the momentum circles axis 3
      amplitude_[1] = i2 * std::sqrt(high / (i2 * (i3 - i2)));
      rate_ = std::sqrt((i3 - i2) * low / (i1 * i2 * i3));
      complement_ = (l2 - 2.0 * energy * i2) * (i3 - i1) / ((i3 - i2) * low);
    } else {
      amplitude_[1] = i2 * std::sqrt(low / (i2 * (i2 - i1)));
      rate_ = std::sqrt((i2 - i1) * high / (i1 * i2 * i3));
      complement_ = (2.0 * energy * i2 - l2) * (i3 - i1) / ((i2 - i1) * high);
    }
  }

  /// Angular momentum in the body frame at time t (s).
  Vec3 body_momentum(double t) const {
    const Elliptic e = jacobi(rate_ * t, complement_);
    return about_third_ ? Vec3(amplitude_[0] * e.cn, amplitude_[1] * e.sn, amplitude_[2] * e.dn)
                        : Vec3(amplitude_[0] * e.dn, amplitude_[1] * e.sn, amplitude_[2] * e.cn);
  }

  /// Attitude at time t (s), angular momentum along the space axis z. With p the momentum in the body frame,
  /// R = Rz(phi) B(p) where B takes p / L to z, and phi' = L (2 E - p_k^2 / I_k) / (L^2 - p_k^2) for the axis
  /// k that the momentum circles; integrated by Gauss-Legendre quadrature (8 points, `panels` panels).
  Quat attitude(double t, int panels) const {
    static constexpr double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                    0.9602898564975363};
    static constexpr double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                    0.1012285362903763};
    double phi = 0.0;
    const double width = t / panels;
    for (int p = 0; p < panels; ++p)
      for (int k = 0; k < 4; ++k)
        phi += 0.5 * width * w[k] *
               (precession((p + 0.5 * (1.0 + x[k])) * width) + precession((p + 0.5 * (1.0 - x[k])) * width));
    return Quat(Eigen::AngleAxisd(phi, Vec3::UnitZ()) * frame(body_momentum(t)));
  }

 private:
  int axis() const { return about_third_ ? 2 : 0; }

  double precession(double t) const {
    const Vec3 p = body_momentum(t);
    const int k = axis(), a = (k + 1) % 3, b = (k + 2) % 3;
    return length_ * (p[a] * p[a] / inertia_[a] + p[b] * p[b] / inertia_[b]) / (p[a] * p[a] + p[b] * p[b]);
  }

  /// Rows: the space axes x, y, z in the body frame when phi = 0: x is the projection of the body axis k.
  Mat3 frame(const Vec3& p) const {
    const Vec3 z = p.normalized();
    Vec3 body_axis = Vec3::Zero();
    body_axis[axis()] = 1.0;
    const Vec3 x = (body_axis - body_axis.dot(z) * z).normalized();
    Mat3 rows;
    rows << x.transpose(), z.cross(x).transpose(), z.transpose();
    return rows;
  }

  Vec3 inertia_, amplitude_;
  double length_, rate_ = 0.0, complement_ = 1.0;
  bool about_third_ = true;
};

}  // namespace cairn
