// Colours of things: kinds, quantities and bodies. All are sRGB 0..1 unless said otherwise.
#pragma once

#include <cstdint>

#include "core/math.h"

namespace cairn::render {

/// Twelve colours that stay apart for colour-blind readers (Okabe & Ito 2008, completed from the "muted" set
/// of Tol 2021); index 12 starts again.
Vec3 category_color(std::size_t index);
inline constexpr std::size_t kCategoryColors = 12;

/// The perceptually uniform map "viridis" (van der Walt & Smith 2015, public domain) from nine of its
/// colours; t is clamped to 0..1, NaN is grey.
Vec3 scalar_color(double t);

/// A pleasant colour for a body, the same for the same id; lightness and chroma hardly vary, the hue does.
/// `chroma` is OKLCH chroma: 0.09 is lively, 0.015 looks like differently weathered stone.
Vec3 id_color(std::uint64_t id, double chroma = 0.09);

/// Light proportional to photons from sRGB, per channel, and back (IEC 61966-2-1).
double to_linear(double srgb);
double to_srgb(double linear);

}  // namespace cairn::render
