#include "app/render/surface.h"

#include <cstring>

#include "core/error.h"

namespace cairn::render {

Surface to_surface(const Image& image) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS)
    throw InputError("no memory for a picture of {} x {} pixels", image.width, image.height);
  cairo_surface_flush(surface.get());
  unsigned char* data = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      const std::uint32_t word = std::uint32_t{p[0]} << 16 | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]};
      std::memcpy(data + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(x), &word, 4);
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

Image to_image(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  Image image = Image::filled(cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface),
                              Vec3::Zero());
  const unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::uint32_t word;
      std::memcpy(&word, data + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(x), 4);
      std::uint8_t* p = image.pixel(x, y);
      p[0] = static_cast<std::uint8_t>(word >> 16);
      p[1] = static_cast<std::uint8_t>(word >> 8);
      p[2] = static_cast<std::uint8_t>(word);
    }
  }
  return image;
}

}  // namespace cairn::render
