// Ray tracing of balls: sunlight with soft shadows, sky light with occlusion, lines between bodies.
#pragma once

#include <vector>

#include "app/render/image.h"
#include "app/render/style.h"
#include "app/render/view.h"

namespace cairn::render {

/// Part of a picture, in pixels from its top left corner.
struct Rectangle {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
};

/// Pixels per metre at the target when the view's region is fitted into `room`.
double pixels_per_metre(const View& view, const Rectangle& room);

/// The whole picture without any writing; the view's target is in the middle of `room`.
/// The same bytes come out for any number of threads.
/// @throws InputError for a view, style, size or ball that cannot be drawn.
Image trace(const std::vector<Ball>& balls, const View& view, int width, int height, const Rectangle& room,
            const Style& style, const std::vector<Facet>& facets = {});

}  // namespace cairn::render
