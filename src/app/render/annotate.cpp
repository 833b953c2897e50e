#include "app/render/annotate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/render/color.h"
#include "app/render/text.h"
#include "core/error.h"

namespace cairn::render {
namespace {

constexpr double kBarPart = 0.26;   // largest width of the scale bar, of the picture's width
constexpr double kBarBlock = 0.30;  // width kept for it
constexpr int kTicks = 5;

/// All lengths of the layout, in pixels.
struct Layout {
  double text, title, margin, row;              // heights of text and title, border, distance of baselines
  double top = 0.0, bottom = 0.0, right = 0.0;  // bands taken by the annotation
  std::vector<std::vector<Swatch>> key;         // rows of the categorical key
  double key_left = 0.0;
};

/// Widths are asked of a surface too small to draw on.
Pen measuring_pen(const Surface& surface) {
  return Pen(surface.get(), Vec3::Zero(), Vec3::Ones());
}
Surface small_surface() {
  return Surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1));
}

double swatch_width(Pen& pen, const Swatch& swatch, double text) {
  return 2.1 * text + pen.text_width(swatch.name, text);
}

double row_width(Pen& pen, const std::vector<Swatch>& row, double text) {
  double width = 0.0;
  for (const Swatch& swatch : row) width += swatch_width(pen, swatch, text);
  return width;
}

/// The key in rows not wider than `width` (but at least one entry each).
std::vector<std::vector<Swatch>> key_rows(Pen& pen, const std::vector<Swatch>& key, double text,
                                          double width) {
  std::vector<std::vector<Swatch>> rows;
  double used = 0.0;
  for (const Swatch& swatch : key) {
    const double needed = swatch_width(pen, swatch, text);
    if (rows.empty() || used + needed > width) {
      rows.emplace_back();
      used = 0.0;
    }
    rows.back().push_back(swatch);
    used += needed;
  }
  return rows;
}

void draw_key_row(Pen& pen, const std::vector<Swatch>& row, double x, double baseline, double text) {
  for (const Swatch& swatch : row) {
    pen.disc(x + 0.55 * text, baseline - 0.36 * text, 0.42 * text, swatch.color);
    pen.text(swatch.name, x + 1.25 * text, baseline, text);
    x += swatch_width(pen, swatch, text);
  }
}

std::vector<std::pair<double, std::string>> ticks_of(const ColorBar& bar) {
  if (!std::isfinite(bar.low) || !std::isfinite(bar.high) || !(bar.low < bar.high))
    throw InputError("colour bar \"{}\": the range {} to {} is empty", bar.label, bar.low, bar.high);
  std::vector<std::pair<double, std::string>> ticks;
  for (const double value : round_ticks(bar.low, bar.high, kTicks))
    ticks.emplace_back(value, fmt::format("{:.6g}", value));
  return ticks;
}

Layout lay_out(const Annotation& annotation, int width, int height) {
  const Surface surface = small_surface();
  Pen pen = measuring_pen(surface);
  Layout layout;
  layout.text = std::max(7.0, 0.032 * std::min(width, height) * annotation.text_scale);
  layout.title = 1.2 * layout.text;
  layout.margin = 0.9 * layout.text;
  layout.row = 1.45 * layout.text;
  const double lines = static_cast<double>(annotation.lines.size());
  if (!annotation.title.empty()) layout.top += 1.25 * layout.title;
  layout.top += lines * layout.row;
  if (layout.top > 0.0) layout.top += layout.margin;
  if (annotation.scale_bar) layout.bottom = 1.9 * layout.text + layout.margin;
  layout.key_left = annotation.scale_bar ? kBarBlock * width : layout.margin;
  layout.key = key_rows(pen, annotation.key, layout.text, width - layout.key_left - layout.margin);
  if (!layout.key.empty())
    layout.bottom =
        std::max(layout.bottom, static_cast<double>(layout.key.size()) * layout.row + layout.margin);
  if (annotation.color_bar) {
    double widest = 0.0;
    for (const auto& [value, label] : ticks_of(*annotation.color_bar))
      widest = std::max(widest, pen.text_width(label, layout.text));
    layout.right = layout.margin + widest + (annotation.color_bar->label.empty() ? 1.9 : 3.4) * layout.text;
  }
  return layout;
}

void draw_heading(Pen& pen, const Annotation& annotation, const Layout& layout) {
  double y = layout.margin;
  if (!annotation.title.empty()) {
    pen.text(annotation.title, layout.margin, y + 0.8 * layout.title, layout.title, true);
    y += 1.25 * layout.title;
  }
  for (const std::string& line : annotation.lines) {
    pen.text(line, layout.margin, y + 0.85 * layout.text, layout.text);
    y += layout.row;
  }
}

void draw_scale_bar(Pen& pen, const Layout& layout, const Image& image, double pixels_per_metre) {
  const double length = scale_bar_length(kBarPart * image.width / pixels_per_metre);
  const double pixels = length * pixels_per_metre;
  const double thick = std::max(2.0, std::round(0.16 * layout.text));
  // Whole pixels: a bar with blurred ends cannot be measured.
  const double left = std::round(layout.margin), top = std::round(image.height - layout.margin) - thick;
  pen.rectangle(left - 1.0, top - 1.0, std::round(pixels) + 2.0, thick + 2.0, pen.paper());
  pen.rectangle(left, top, std::round(pixels), thick, pen.ink());
  const std::string label = length_label(length);
  const double x = left + 0.5 * (pixels - pen.text_width(label, layout.text));
  pen.text(label, std::max(left, x), top - 0.4 * layout.text, layout.text);
}

void draw_color_bar(Pen& pen, const ColorBar& bar, const Layout& layout, const Image& image) {
  const double left = image.width - layout.right + 0.3 * layout.text, width = 0.9 * layout.text;
  const double free_top = std::max(layout.top, layout.margin);
  const double free_height = image.height - free_top - std::max(layout.bottom, layout.margin);
  const double height = std::round(0.86 * free_height), top = std::round(free_top + 0.07 * free_height);
  for (double y = 0.0; y < height; y += 1.0)
    pen.rectangle(left, top + y, width, 1.0, scalar_color(1.0 - (y + 0.5) / height));
  pen.frame(left, top, width, height, std::max(1.0, 0.05 * layout.text));
  double widest = 0.0;
  for (const auto& [value, label] : ticks_of(bar)) {
    const double y = top + height * (1.0 - (value - bar.low) / (bar.high - bar.low));
    const double thick = std::max(1.0, 0.07 * layout.text);
    pen.rectangle(left + width, y - 0.5 * thick, 0.25 * layout.text, thick, pen.ink());
    pen.text(label, left + width + 0.45 * layout.text, y + 0.36 * layout.text, layout.text);
    widest = std::max(widest, pen.text_width(label, layout.text));
  }
  if (!bar.label.empty())
    pen.upright_text(bar.label, left + width + 1.75 * layout.text + widest, top + 0.5 * height, layout.text);
}

}  // namespace

double scale_bar_length(double available) {
  const double decade = std::pow(10.0, std::floor(std::log10(available)));
  for (const double digit : {10.0, 5.0, 2.0}) {
    if (digit * decade <= available) return digit * decade;
  }
  return decade;
}

std::string length_label(double metres) {
  struct Unit {
    double size;
    const char* name;
  };
  // A hundredth of a percent of slack: 0.01 m must not become 10 mm for a rounding error.
  constexpr std::array<Unit, 5> units = {
      {{1e3, "km"}, {1.0, "m"}, {1e-2, "cm"}, {1e-3, "mm"}, {1e-6, "\u00b5m"}}};
  for (const Unit& unit : units) {
    if (metres >= 0.9999 * unit.size) return fmt::format("{:.4g} {}", metres / unit.size, unit.name);
  }
  return fmt::format("{:.4g} nm", metres * 1e9);
}

std::vector<double> round_ticks(double low, double high, int count) {
  const double step = scale_bar_length(1.001 * (high - low) / std::max(1, count - 1));
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1.0)
    ticks.push_back(i == 0.0 ? 0.0 : i * step);
  return ticks;
}

Rectangle free_room(const Annotation& annotation, int width, int height) {
  const Layout layout = lay_out(annotation, width, height);
  // Never less than a third, however much is written.
  const double free_width = std::max(width - layout.right, width / 3.0);
  const double top = std::min(layout.top, height / 3.0);
  const double bottom = std::min(layout.bottom, height / 3.0);
  return {0.0, top, free_width, height - top - bottom};
}

void annotate(Image& image, const Annotation& annotation, double pixels_per_metre, const Style& style) {
  const Layout layout = lay_out(annotation, image.width, image.height);
  const Surface surface = to_surface(image);
  {
    Pen pen(surface.get(), style.ink(), style.paper());
    draw_heading(pen, annotation, layout);
    if (annotation.scale_bar) draw_scale_bar(pen, layout, image, pixels_per_metre);
    double baseline = image.height - layout.margin;
    for (auto row = layout.key.rbegin(); row != layout.key.rend(); ++row, baseline -= layout.row) {
      const double free = image.width - layout.key_left - row_width(pen, *row, layout.text);
      draw_key_row(pen, *row, layout.key_left + (annotation.scale_bar ? std::max(0.0, free) : 0.0), baseline,
                   layout.text);
    }
    if (annotation.color_bar) draw_color_bar(pen, *annotation.color_bar, layout, image);
  }
  image = to_image(surface.get());
}

Image key_strip(const std::vector<Swatch>& key, int width, double text_height, const Style& style) {
  const Surface small = small_surface();
  Pen ruler = measuring_pen(small);
  const auto rows = key_rows(ruler, key, text_height, width);
  const double height = (1.5 * static_cast<double>(rows.size()) + 0.5) * text_height;
  const Surface surface =
      to_surface(Image::filled(width, static_cast<int>(std::ceil(height)), style.paper()));
  {
    Pen pen(surface.get(), style.ink(), style.paper());
    double baseline = 1.35 * text_height;
    for (const auto& row : rows) {
      draw_key_row(pen, row, std::max(0.0, 0.5 * (width - row_width(pen, row, text_height))), baseline,
                   text_height);
      baseline += 1.5 * text_height;
    }
  }
  return to_image(surface.get());
}

}  // namespace cairn::render
