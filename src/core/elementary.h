// Elementary functions whose bits are the same everywhere: libraries of mathematics differ in the last one,
// from version to version and from processor to processor. Where time does not matter they are rounded
// correctly (MPFR); the others are made of additions and multiplications, and right to about a unit in the
// last place.
#pragma once

#include "core/math.h"

namespace cairn {

struct SineAndCosine {
  double sine, cosine;
};
SineAndCosine sine_and_cosine(double x);
double exponential(double x);
double cube_root(double x);
double arc_cosine(double x);
double arc_tangent(double y, double x);  ///< of y / x, in the quadrant of (x, y)
double hyperbolic_sine(double x);
double hyperbolic_cosine(double x);
double complementary_error_function(double x);  ///< to 1e-11 of itself
Quat rotation(double angle, const Vec3& axis);  ///< by an angle about a unit vector

// Correctly rounded, some microseconds each.
double area_sine(double x);  ///< inverse of the hyperbolic sine
double logarithm(double x);
double logarithm_of_one_plus(double x);
double exponential_less_one(double x);
double power(double base, double exponent);

}  // namespace cairn
