// Cairo handles that free themselves, and the way between an Image and a cairo surface.
#pragma once

#include <cairo.h>

#include <memory>

#include "app/render/image.h"

namespace cairn::render {

struct CairoFree {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, CairoFree>;
using Context = std::unique_ptr<cairo_t, CairoFree>;

/// A surface that holds a copy of the picture.
Surface to_surface(const Image& image);

/// The picture a surface of format RGB24 or ARGB32 holds.
Image to_image(cairo_surface_t* surface);

}  // namespace cairn::render
