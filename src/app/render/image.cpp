#include "app/render/image.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "app/render/surface.h"
#include "core/error.h"
#include "core/safe_file.h"

namespace cairn::render {
namespace {

cairo_status_t add_bytes(void* text, const unsigned char* data, unsigned int size) try {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
} catch (const std::bad_alloc&) {
  return CAIRO_STATUS_NO_MEMORY;
}

}  // namespace

Image Image::filled(int width, int height, const Vec3& color) {
  constexpr int largest = 32768;
  if (width < 1 || height < 1 || width > largest || height > largest)
    throw InputError("a picture of {} x {} pixels cannot be made (each side must be in 1..{})", width, height,
                     largest);
  Image image{width, height, {}};
  image.rgb.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    const double value = std::clamp(color[static_cast<Eigen::Index>(i % 3)], 0.0, 1.0);
    image.rgb[i] = static_cast<std::uint8_t>(std::lround(255.0 * value));
  }
  return image;
}

void write_png(const Image& image, const std::filesystem::path& path) {
  std::string png;
  const Surface surface = to_surface(image);
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), add_bytes, &png);
  if (status != CAIRO_STATUS_SUCCESS)
    throw InputError("{}: the picture cannot be made: {}", path.string(), cairo_status_to_string(status));
  write_file(path, png, true);
}

Image grid(const std::vector<Image>& panels, int columns, int gap, const Vec3& color) {
  if (panels.empty() || columns < 1 || gap < 0) throw InputError("a grid of pictures needs a picture");
  columns = std::min(columns, static_cast<int>(panels.size()));
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  std::vector<int> widths(static_cast<std::size_t>(columns)), heights(static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    int& width = widths[i % widths.size()];
    int& height = heights[i / widths.size()];
    width = std::max(width, panels[i].width);
    height = std::max(height, panels[i].height);
  }
  int total_width = (columns - 1) * gap, total_height = (rows - 1) * gap;
  for (const int width : widths) total_width += width;
  for (const int height : heights) total_height += height;
  Image figure = Image::filled(total_width, total_height, color);
  int top = 0;
  for (std::size_t row = 0; row < heights.size(); ++row) {
    int left = 0;
    for (std::size_t column = 0; column < widths.size(); ++column) {
      const std::size_t i = row * widths.size() + column;
      if (i == panels.size()) break;
      const Image& panel = panels[i];
      const int x = left + (widths[column] - panel.width) / 2;
      const int y = top + (heights[row] - panel.height) / 2;
      for (int line = 0; line < panel.height; ++line)
        std::copy_n(panel.pixel(0, line), 3 * panel.width, figure.pixel(x, y + line));
      left += widths[column] + gap;
    }
    top += heights[row] + gap;
  }
  return figure;
}

Image side_by_side(const std::vector<Image>& panels, int gap, const Vec3& color) {
  return grid(panels, std::max(1, static_cast<int>(panels.size())), gap, color);
}

Image stacked(const std::vector<Image>& panels, int gap, const Vec3& color) {
  return grid(panels, 1, gap, color);
}

}  // namespace cairn::render
