#include "app/render/draw.h"

#include <algorithm>
#include <cmath>

#include "app/render/color.h"
#include "app/render/text.h"
#include "app/render/trace.h"
#include "core/error.h"

namespace cairn::render {
namespace {

constexpr int kCell = 320;           // pixels, width of a cell of the sheet
constexpr int kCaption = 76;         // pixels below the picture
constexpr double kCaptionText = 25;  // pixels

void centred(Pen& pen, const std::string& text, double baseline, double height, bool bold) {
  // Long names shrink to their cell.
  const double room = 0.94 * kCell;
  const double size = height * std::min(1.0, room / std::max(1.0, pen.text_width(text, height, bold)));
  pen.text(text, 0.5 * (kCell - pen.text_width(text, size, bold)), baseline, size, bold);
}

Image sheet_cell(const Shape& shape, std::size_t index, const Style& style) {
  const std::vector<Ball> balls = shape_balls(shape, category_color(index));
  if (balls.empty()) throw InputError("shape \"{}\" has no spheres to draw", shape.name);
  View view;
  view.direction = Vec3(1.0, -1.5, 0.9);
  view.field_of_view = 18.0;
  view = frame(balls, view, {.fraction = 1.0, .margin = 0.12});
  const Rectangle room{0.0, 0.0, kCell, kCell};
  const Image picture = trace(balls, view, kCell, kCell + kCaption, room, style);
  const Surface surface = to_surface(picture);
  {
    Pen pen(surface.get(), style.ink(), style.paper());
    const std::size_t count = shape.centers.size();
    centred(pen, shape.name, kCell + 22.0, kCaptionText, true);
    centred(pen, fmt::format("{} sphere{}", count, count == 1 ? "" : "s"), kCell + 54.0, 0.84 * kCaptionText,
            false);
  }
  return to_image(surface.get());
}

}  // namespace

Image draw(const std::vector<Ball>& balls, const View& view, const Annotation& annotation, int width,
           int height, const Style& style) {
  const Rectangle room = free_room(annotation, width, height);
  Image image = trace(balls, view, width, height, room, style);
  annotate(image, annotation, pixels_per_metre(view, room), style);
  return image;
}

std::vector<Ball> shape_balls(const Shape& shape, const Vec3& color) {
  std::vector<Ball> balls;
  balls.reserve(shape.centers.size());
  for (std::size_t i = 0; i < shape.centers.size(); ++i)
    balls.push_back({shape.centers[i], shape.radii[i], color, 0});
  return balls;
}

void render_shape_sheet(const std::vector<Shape>& shapes, const std::filesystem::path& path,
                        const Style& style) {
  if (shapes.empty()) throw InputError("there are no shapes to draw on {}", path.string());
  std::vector<Image> cells;
  for (std::size_t i = 0; i < shapes.size(); ++i) cells.push_back(sheet_cell(shapes[i], i, style));
  // A little wider than high, as a page on its side.
  const double columns = std::ceil(std::sqrt(1.6 * static_cast<double>(shapes.size())));
  write_png(grid(cells, static_cast<int>(columns), 10, style.paper()), path);
}

}  // namespace cairn::render
