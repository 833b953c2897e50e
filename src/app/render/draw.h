// The whole way from balls to a finished picture.
#pragma once

#include <filesystem>
#include <vector>

#include "app/render/annotate.h"
#include "app/render/image.h"
#include "app/render/style.h"
#include "app/render/view.h"
#include "shape/mesh.h"
#include "shape/shape.h"

namespace cairn::render {

/// Ray-traces the balls and writes the annotation around them. Pixels; the same bytes for any number of
/// threads. No balls give an empty picture.
/// @throws InputError for a ball that is not finite (use require_finite to test), a view, style or size that
/// cannot be drawn.
Image draw(const std::vector<Ball>& balls, const View& view, const Annotation& annotation, int width,
           int height, const Style& style = {});

/// The balls of a shape in its own frame and units, in one colour.
std::vector<Ball> shape_balls(const Shape& shape, const Vec3& color);

/// A sheet with one cell per shape: an oblique view, its name and its number of spheres.
/// @throws InputError when there are no shapes, a shape has no spheres, or the file cannot be written.
void render_shape_sheet(const std::vector<Shape>& shapes, const std::filesystem::path& path,
                        const Style& style = Style::fine());

/// A fitted shape beside its mesh, given in the shape's frame and units: two cells of such a sheet.
/// @throws InputError when the file cannot be written.
void render_beside_mesh(const Shape& shape, const TriangleMesh& mesh, const std::filesystem::path& path,
                        const Style& style = Style::fine());

}  // namespace cairn::render
