// Pictures in memory, PNG files, and panels put together into one figure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/math.h"

namespace cairn::render {

/// An opaque picture: 8-bit sRGB, rows from the top, three bytes a pixel without padding.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  /// A picture of one colour (sRGB 0..1). @throws InputError when a side is not in 1..32768.
  static Image filled(int width, int height, const Vec3& color);

  std::uint8_t* pixel(int x, int y) { return &rgb[3 * (static_cast<std::size_t>(y) * width + x)]; }
  const std::uint8_t* pixel(int x, int y) const {
    return &rgb[3 * (static_cast<std::size_t>(y) * width + x)];
  }
  bool operator==(const Image&) const = default;
};

/// Writes a PNG as write_file does; replaces a file that is there.
/// @throws InputError when the file cannot be written.
void write_png(const Image& image, const std::filesystem::path& path);

/// Panels in rows of `columns`, centred in cells as large as the largest of their row and column, `gap`
/// pixels apart on `color` (sRGB 0..1).
/// @throws InputError when there are no panels or columns < 1.
Image grid(const std::vector<Image>& panels, int columns, int gap = 0, const Vec3& color = Vec3::Ones());

/// One row of panels, e.g. before, at and after failure.
Image side_by_side(const std::vector<Image>& panels, int gap = 0, const Vec3& color = Vec3::Ones());

/// The panels below each other, e.g. a row of pictures and their common key.
Image stacked(const std::vector<Image>& panels, int gap = 0, const Vec3& color = Vec3::Ones());

}  // namespace cairn::render
