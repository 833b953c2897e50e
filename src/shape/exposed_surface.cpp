#include "shape/exposed_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/elementary.h"

namespace cairn {
namespace {

// The integral runs over latitudes z. On a circle of latitude the covered arcs are known in closed form and
// the trigonometric polynomials are integrated over the gaps analytically. As a function of z the result is
// smooth between critical latitudes (where a cap begins or ends, or two rims cross), with square-root
// singularities there that z = middle + half sin(pi t / 2) removes: Gauss-Legendre quadrature in t converges
// exponentially.

constexpr int kMonomials = 20;  // x^a y^b z^c with a + b + c <= 3
using Monomials = Eigen::Array<double, kMonomials, 1>;

// Exponents (a, b) of the azimuthal factor cos^a sin^b, in the order of `add_gap`.
constexpr std::array<std::array<int, 2>, 10> kAzimuth = {
    {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}}};

int monomial_index(int a, int b, int c) {
  int index = 0;
  for (const auto& exponent : kAzimuth) {
    if (exponent[0] == a && exponent[1] == b) return index + c;
    index += 4 - exponent[0] - exponent[1];
  }
  return kMonomials;
}

// A cap in the polar coordinates of the latitude circles.
struct PolarCap {
  double height, cos_tilt, sin_tilt, azimuth;  // azimuth of the axis in [0, 2 pi)
};

struct Gauss {
  static constexpr int kNodes = 16;
  std::array<double, kNodes> node, weight;
};

// Gauss-Legendre nodes and weights on [-1, 1], by Newton's method on the Legendre polynomial.
Gauss gauss_legendre() {
  Gauss rule;
  constexpr int n = Gauss::kNodes;
  for (int i = 0; i < n; ++i) {
    double x = sine_and_cosine(kPi * (i + 0.75) / (n + 0.5)).cosine, slope = 1.0;
    for (int iteration = 0; iteration < 10; ++iteration) {
      double previous = 1.0, value = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = std::exchange(value, next);
      }
      slope = n * (x * value - previous) / (x * x - 1.0);
      x -= value / slope;
    }
    rule.node[i] = x;
    rule.weight[i] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}

class LatitudeIntegral {
 public:
  explicit LatitudeIntegral(const std::vector<Cap>& caps) {
    for (const Cap& cap : caps) {
      double azimuth = arc_tangent(cap.axis.y(), cap.axis.x());
      if (azimuth < 0.0) azimuth += 2.0 * kPi;
      caps_.push_back(
          {cap.height, cap.axis.z(), std::sqrt(squared(cap.axis.x()) + squared(cap.axis.y())), azimuth});
    }
  }

  // Integral between two neighbouring critical latitudes.
  Monomials between(double low, double high) {
    middle_ = 0.5 * (low + high);
    half_ = 0.5 * (high - low);
    return refine(-1.0, 1.0, panel(-1.0, 1.0), 0);
  }

 private:
  // Halves the panel until that changes nothing: needed where another critical latitude lies just outside.
  Monomials refine(double begin, double end, const Monomials& whole, int depth) {
    constexpr double tolerance = 2e-14;
    constexpr int deepest = 24;
    const double split = 0.5 * (begin + end);
    const Monomials left = panel(begin, split), right = panel(split, end);
    const Monomials halves = left + right;
    if (depth == deepest || (halves - whole).abs().maxCoeff() <= tolerance) return halves;
    return refine(begin, split, left, depth + 1) + refine(split, end, right, depth + 1);
  }

  Monomials panel(double begin, double end) {
    static const Gauss rule = gauss_legendre();
    Monomials sum = Monomials::Zero();
    for (int i = 0; i < Gauss::kNodes; ++i) {
      const double angle = 0.5 * kPi * (0.5 * (begin + end) + 0.5 * (end - begin) * rule.node[i]);
      const double jacobian = 0.25 * kPi * (end - begin) * half_ * sine_and_cosine(angle).cosine;
      add_latitude(middle_ + half_ * sine_and_cosine(angle).sine, jacobian * rule.weight[i], sum);
    }
    return sum;
  }

  void add_latitude(double z, double weight, Monomials& sum) {
    const double radius = std::sqrt(std::max(0.0, (1.0 - z) * (1.0 + z)));
    if (!find_covered(z, radius)) return;
    azimuth_.fill(0.0);
    double reach = 0.0;
    for (const auto& [begin, end] : covered_) {
      if (begin > reach) add_gap(reach, begin);
      reach = std::max(reach, end);
    }
    if (reach < 2.0 * kPi) add_gap(reach, 2.0 * kPi);

    int index = 0;
    for (std::size_t k = 0; k < kAzimuth.size(); ++k) {
      const int degree = kAzimuth[k][0] + kAzimuth[k][1];
      double term = weight * azimuth_[k];
      for (int n = 0; n < degree; ++n) term *= radius;
      for (int c = 0; c <= 3 - degree; ++c, term *= z) sum[index++] += term;
    }
  }

  // Arcs of the circle of latitude under the caps, sorted, cut at azimuth 0; false if one cap covers all of
  // it.
  bool find_covered(double z, double radius) {
    covered_.clear();
    for (const PolarCap& cap : caps_) {
      const double reach = radius * cap.sin_tilt, distance = cap.height - z * cap.cos_tilt;
      if (distance >= reach) continue;
      if (distance <= -reach) return false;
      const double half_width = arc_cosine(distance / reach);
      double begin = cap.azimuth - half_width;
      if (begin < 0.0) begin += 2.0 * kPi;
      const double end = begin + 2.0 * half_width;
      covered_.emplace_back(begin, std::min(end, 2.0 * kPi));
      if (end > 2.0 * kPi) covered_.emplace_back(0.0, end - 2.0 * kPi);
    }
    std::sort(covered_.begin(), covered_.end());
    return true;
  }

  void add_gap(double begin, double end) {
    add_antiderivative(end, 1.0);
    add_antiderivative(begin, -1.0);
  }

  void add_antiderivative(double angle, double sign) {
    const double s = sine_and_cosine(angle).sine, c = sine_and_cosine(angle).cosine, s3 = s * s * s / 3.0,
                 c3 = c * c * c / 3.0;
    const std::array<double, 10> value = {
        angle, s, -c, 0.5 * (angle + s * c), 0.5 * s * s, 0.5 * (angle - s * c), s - s3, -c3, s3, c3 - c};
    for (std::size_t k = 0; k < value.size(); ++k) azimuth_[k] += sign * value[k];
  }

  std::vector<PolarCap> caps_;
  double middle_ = 0.0, half_ = 0.0;
  std::vector<std::pair<double, double>> covered_;  // kept between calls for its memory
  std::array<double, 10> azimuth_{};
};

// True when `point` lies well inside another cap: what happens there is invisible.
bool is_hidden(const Vec3& point, const std::vector<Cap>& caps) {
  constexpr double margin = 1e-9;
  return std::any_of(caps.begin(), caps.end(),
                     [&](const Cap& cap) { return point.dot(cap.axis) > cap.height + margin; });
}

// Without the caps that lie inside another one.
std::vector<Cap> outermost(const std::vector<Cap>& caps) {
  constexpr double margin = 1e-14;  // never drop a cap that protrudes; keeping one too many does no harm
  const auto contains = [](const Cap& outer, const Cap& inner) {
    return outer.height <= inner.height &&
           outer.axis.dot(inner.axis) > outer.height * inner.height + outer.rim * inner.rim + margin;
  };
  std::vector<Cap> kept;
  for (const Cap& cap : caps)
    if (std::none_of(caps.begin(), caps.end(), [&](const Cap& other) { return contains(other, cap); }))
      kept.push_back(cap);
  return kept;
}

// Latitudes between which the integrand is smooth, sorted. One too many does no harm.
std::vector<double> critical_latitudes(const std::vector<Cap>& caps) {
  std::vector<double> latitudes = {-1.0, 1.0};
  const auto add = [&](const Vec3& point) {
    if (!is_hidden(point, caps)) latitudes.push_back(std::clamp(point.z(), -1.0, 1.0));
  };
  for (std::size_t i = 0; i < caps.size(); ++i) {
    const Cap& a = caps[i];
    const double sin_tilt = std::sqrt(squared(a.axis.x()) + squared(a.axis.y()));
    if (sin_tilt == 0.0) {
      latitudes.push_back(a.axis.z() > 0.0 ? a.height : -a.height);
    } else {  // the northernmost and southernmost points of the rim
      const double slope = a.axis.z() / sin_tilt;
      const Vec3 north(-slope * a.axis.x(), -slope * a.axis.y(), sin_tilt);
      add(a.height * a.axis + a.rim * north);
      add(a.height * a.axis - a.rim * north);
    }
    for (std::size_t j = i + 1; j < caps.size(); ++j) {
      const Cap& b = caps[j];
      const Vec3 normal = a.axis.cross(b.axis);
      const double sine2 = normal.squaredNorm(), cosine = a.axis.dot(b.axis);
      constexpr double parallel = 1e-20, tangent = 1e-12;
      if (sine2 < parallel) continue;
      const double along_a = (a.height - b.height * cosine) / sine2;
      const double along_b = (b.height - a.height * cosine) / sine2;
      const double rest = 1.0 - along_a * a.height - along_b * b.height;
      if (rest < -tangent) continue;
      const Vec3 foot = along_a * a.axis + along_b * b.axis;
      const Vec3 side = std::sqrt(std::max(0.0, rest) / sine2) * normal;
      add(foot + side);
      add(foot - side);
    }
  }
  std::sort(latitudes.begin(), latitudes.end());
  return latitudes;
}

}  // namespace

SurfaceMoments exposed_moments(const std::vector<Cap>& all_caps) {
  const std::vector<Cap> caps = outermost(all_caps);
  SurfaceMoments moments;
  if (caps.empty()) {  // exact, so that loose spheres come out exact
    moments.area = 4.0 * kPi;
    moments.second = (4.0 * kPi / 3.0) * Mat3::Identity();
    return moments;
  }
  LatitudeIntegral integral(caps);
  const std::vector<double> latitudes = critical_latitudes(caps);
  Monomials sum = Monomials::Zero();
  for (std::size_t i = 0; i + 1 < latitudes.size(); ++i)
    if (latitudes[i + 1] > latitudes[i]) sum += integral.between(latitudes[i], latitudes[i + 1]);

  const auto monomial = [&](std::initializer_list<int> directions) {
    std::array<int, 3> exponent = {0, 0, 0};
    for (const int direction : directions) ++exponent[static_cast<std::size_t>(direction)];
    return sum[monomial_index(exponent[0], exponent[1], exponent[2])];
  };
  moments.area = monomial({});
  for (int i = 0; i < 3; ++i) {
    moments.first[i] = monomial({i});
    for (int j = 0; j < 3; ++j) {
      moments.second(i, j) = monomial({i, j});
      for (int k = 0; k < 3; ++k) moments.third[static_cast<std::size_t>(k)](i, j) = monomial({i, j, k});
    }
  }
  return moments;
}

}  // namespace cairn
