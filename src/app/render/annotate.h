// What is written on a picture: title, lines, scale bar, colour key.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/render/image.h"
#include "app/render/style.h"
#include "app/render/trace.h"

namespace cairn::render {

/// One entry of a categorical key.
struct Swatch {
  std::string name;
  Vec3 color = Vec3::Zero();  ///< sRGB 0..1
};

/// A continuous key in the colours of scalar_color.
struct ColorBar {
  std::string label;  ///< with its unit, e.g. "pressure (Pa)"
  double low = 0.0;   ///< value of the colour at t = 0
  double high = 1.0;
};

/// All of it is optional; texts are UTF-8. Empty parts take no room.
struct Annotation {
  std::string title;
  std::vector<std::string> lines;  ///< below the title, e.g. "t = 3.21 h   T = 2.41 h"
  bool scale_bar = true;           ///< exact at the target's distance
  std::vector<Swatch> key;
  std::optional<ColorBar> color_bar;
  double text_scale = 1.0;
};

/// Largest of 1, 2, 5 x 10^k that is not above `available` (m, > 0).
double scale_bar_length(double available);

/// A length in the unit that suits it: "200 m", "5 km", "20 \u00b5m".
std::string length_label(double metres);

/// Round values (1, 2 or 5 x 10^k apart) in [low, high], about `count` of them.
std::vector<double> round_ticks(double low, double high, int count);

/// The part of a picture that the annotation leaves free.
Rectangle free_room(const Annotation& annotation, int width, int height);

/// Writes the annotation on a picture whose scale at the target is `pixels_per_metre`.
/// @throws InputError when the colour bar's range is empty or not finite.
void annotate(Image& image, const Annotation& annotation, double pixels_per_metre, const Style& style);

/// A strip with only the categorical key, centred, to be stacked below a row of panels.
Image key_strip(const std::vector<Swatch>& key, int width, double text_height, const Style& style = {});

}  // namespace cairn::render
