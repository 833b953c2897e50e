#include "app/render/color.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.h"

namespace cairn::render {
namespace {

Vec3 from_hex(std::uint32_t rgb) {
  return Vec3(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255) / 255.0;
}

constexpr std::array<std::uint32_t, kCategoryColors> kCategories = {0xE69F00, 0x56B4E9, 0x009E73, 0xF0E442,
                                                                    0x0072B2, 0xD55E00, 0xCC79A7, 0x999933,
                                                                    0x882255, 0xBBBBBB, 0x44AA99, 0x5B4BB0};

constexpr std::array<std::uint32_t, 9> kViridis = {0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21918C,
                                                   0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725};

/// OKLab (Ottosson 2020) to sRGB, clipped to the gamut.
Vec3 from_oklab(double lightness, double a, double b) {
  const double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
  const double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
  const double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
  const Vec3 cones(l * l * l, m * m * m, s * s * s);
  Mat3 to_rgb;
  to_rgb << 4.0767416621, -3.3077115913, 0.2309699292,  //
      -1.2684380046, 2.6097574011, -0.3413193965,       //
      -0.0041960863, -0.7034186147, 1.7076147010;
  const Vec3 linear = to_rgb * cones;
  return Vec3(to_srgb(linear.x()), to_srgb(linear.y()), to_srgb(linear.z()));
}

}  // namespace

Vec3 category_color(std::size_t index) {
  return from_hex(kCategories[index % kCategories.size()]);
}

Vec3 scalar_color(double t) {
  if (std::isnan(t)) return Vec3::Constant(0.6);
  const double x = std::clamp(t, 0.0, 1.0) * (kViridis.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(x), kViridis.size() - 2);
  const double f = x - static_cast<double>(i);
  return (1.0 - f) * from_hex(kViridis[i]) + f * from_hex(kViridis[i + 1]);
}

Vec3 id_color(std::uint64_t id, double chroma) {
  Random random(0, id);
  const double hue = random.uniform(0.0, 2.0 * kPi);
  const double lightness = random.uniform(0.66, 0.80);
  // A faint warm offset keeps stones of little chroma from looking like plastic.
  return from_oklab(lightness, chroma * std::cos(hue) + 0.003, chroma * std::sin(hue) + 0.012);
}

double to_linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

double to_srgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
}

}  // namespace cairn::render
