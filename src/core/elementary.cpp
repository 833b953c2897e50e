#include "core/elementary.h"

#include <mpfr.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>

namespace cairn {

namespace {

/// A number of MPFR with as many digits as a double.
class Exact {
 public:
  explicit Exact(double x) {
    mpfr_init2(value_, 53);
    mpfr_set_d(value_, x, MPFR_RNDN);
  }
  ~Exact() { mpfr_clear(value_); }
  Exact(const Exact&) = delete;
  Exact& operator=(const Exact&) = delete;

  mpfr_ptr get() { return value_; }
  double number() const { return mpfr_get_d(value_, MPFR_RNDN); }

 private:
  mpfr_t value_;
};

template <class Function>
double rounded(Function function, double x) {
  Exact value(x);
  function(value.get(), value.get(), MPFR_RNDN);
  return value.number();
}
template <class Function>
double rounded(Function function, double x, double y) {
  Exact first(x), second(y);
  function(first.get(), first.get(), second.get(), MPFR_RNDN);
  return first.number();
}

}  // namespace

SineAndCosine sine_and_cosine(double x) {
  constexpr double kMost = 1e6;
  if (!(std::abs(x) < kMost)) return {rounded(mpfr_sin, x), rounded(mpfr_cos, x)};
  // x = k pi / 2 + r; pi / 2 in three parts, of which k times the first two are exact.
  constexpr double kPart1 = 0x1.921fb544p+0, kPart2 = 0x1.0b4611a6p-34, kPart3 = 0x1.3198a2e037073p-69;
  const double k = std::nearbyint(x * 0x1.45f306dc9c883p-1);
  const double far = x - k * kPart1, near = k * kPart2;
  const double high = far - near;
  const double r = high - (k * kPart3 - ((far - high) - near)),
               rest = (high - r) - (k * kPart3 - ((far - high) - near));
  const double q = r * r;
  double s = 1.0 / 355687428096000.0, c = 1.0 / 20922789888000.0;
  for (const double term : {-1.0 / 1307674368000.0, 1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0,
                            -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0})
    s = s * q + term;
  for (const double term :
       {-1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0, 1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0})
    c = c * q + term;
  const double sine = r + (r * q * s + rest), half = 0.5 * q, one = 1.0 - half;
  const double cosine = one + (((1.0 - one) - half) + (q * q * c - r * rest));
  switch (static_cast<std::int64_t>(k) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

double exponential(double x) {
  if (!(std::abs(x) < 700.0)) return rounded(mpfr_exp, x);
  // x = k ln 2 + r; ln 2 in two parts, of which k times the first is exact.
  constexpr double kPart1 = 0x1.62e42feep-1, kPart2 = 0x1.a39ef35793c76p-33;
  const double k = std::nearbyint(x * 0x1.71547652b82fep+0);
  const double far = x - k * kPart1, near = k * kPart2, r = far - near, rest = (far - r) - near;
  double e = 1.0 / 6227020800.0;
  for (const double term :
       {1.0 / 479001600.0, 1.0 / 39916800.0, 1.0 / 3628800.0, 1.0 / 362880.0, 1.0 / 40320.0, 1.0 / 5040.0,
        1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5})
    e = e * r + term;
  const double result = 1.0 + (r + (r * r * e + rest));
  return std::ldexp(result, static_cast<int>(k));
}

double cube_root(double x) {
  if (x == 0.0 || !std::isfinite(x)) return x;
  int exponent;
  const double part = std::frexp(std::abs(x), &exponent);   // in [1/2, 1)
  const int third = (exponent + 3 * 1024) / 3 - 1024;       // floor
  const double y = std::ldexp(part, exponent - 3 * third);  // in [1/2, 4)
  double root = 0.6 + 0.3 * y;
  // Halley's steps; the first estimate is off by less than a fourth.
  for (int k = 0; k < 4; ++k) {
    const double cube = root * root * root;
    root -= root * (cube - y) / (2.0 * cube + y);
  }
  return std::copysign(std::ldexp(root, third), x);
}

double arc_tangent(double y, double x) {
  // Up to pi / 4 from the nearest of eight tangents; then the series.
  const double up = std::abs(y), right = std::abs(x), most = std::max(up, right), least = std::min(up, right);
  if (!(most > 0.0) || !std::isfinite(most)) return rounded(mpfr_atan2, y, x);
  constexpr double kAngle[9] = {0x0.0p+0,
                                0x1.fd5ba9aac2f6ep-4,
                                0x1.f5b75f92c80ddp-3,
                                0x1.6f61941e4def1p-2,
                                0x1.dac670561bb4fp-2,
                                0x1.1e00babdefeb4p-1,
                                0x1.4978fa3269ee1p-1,
                                0x1.700a7c5784634p-1,
                                0x1.921fb54442d18p-1};
  const double t = least / most, k = std::nearbyint(8.0 * t), c = 0.125 * k;
  const double u = (t - c) / (1.0 + t * c), q = u * u;
  double series = 1.0 / 13.0;
  for (const double term : {-1.0 / 11.0, 1.0 / 9.0, -1.0 / 7.0, 1.0 / 5.0, -1.0 / 3.0})
    series = series * q + term;
  double angle = kAngle[static_cast<int>(k)] + (u + u * q * series);
  if (up > right) angle = 0x1.921fb54442d18p+0 - angle;
  if (std::signbit(x)) angle = 0x1.921fb54442d18p+1 - angle;
  return std::copysign(angle, y);
}

double arc_cosine(double x) {
  return arc_tangent(std::sqrt((1.0 - x) * (1.0 + x)), x);
}

double hyperbolic_sine(double x) {
  if (std::abs(x) < 0.5) return rounded(mpfr_sinh, x);  // a difference would lose digits
  const double e = exponential(x);
  return 0.5 * (e - 1.0 / e);
}

double hyperbolic_cosine(double x) {
  const double e = exponential(x);
  return 0.5 * (e + 1.0 / e);
}

Quat rotation(double angle, const Vec3& axis) {
  const auto [sine, cosine] = sine_and_cosine(0.5 * angle);
  return {cosine, sine * axis.x(), sine * axis.y(), sine * axis.z()};
}

double area_sine(double x) {
  return rounded(mpfr_asinh, x);
}
double logarithm(double x) {
  return rounded(mpfr_log, x);
}
double logarithm_of_one_plus(double x) {
  return rounded(mpfr_log1p, x);
}
double exponential_less_one(double x) {
  return rounded(mpfr_expm1, x);
}
double complementary_error_function(double x) {
  if (x < 0.0) return 2.0 - complementary_error_function(-x);
  const double square = x * x;
  if (x < 2.5) {  // 1 - 2 / sqrt(pi) e^(-x^2) (x + 2 x^3 / 3 + 4 x^5 / 15 + ...)
    double term = x, sum = x;
    for (int n = 1; term > 1e-18 * sum; ++n) sum += term *= 2.0 * square / (2 * n + 1);
    return 1.0 - 0x1.20dd750429b6dp+0 * exponential(-square) * sum;
  }
  double fraction = 0.0;  // of Laplace, from behind
  for (int n = 60; n > 0; --n) fraction = 0.5 * n / (x + fraction);
  return exponential(-square) * 0x1.20dd750429b6dp-1 / (x + fraction);
}
double power(double base, double exponent) {
  return rounded(mpfr_pow, base, exponent);
}

}  // namespace cairn
