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

View sheet_view(const std::vector<Ball>& balls) {
  View view;
  view.direction = Vec3(1.0, -1.5, 0.9);
  view.field_of_view = 18.0;
  return frame(balls, view, {.fraction = 1.0, .margin = 0.12});
}

Image sheet_cell(const std::vector<Ball>& balls, const std::vector<Facet>& facets, const View& view,
                 const std::string& title, const std::string& caption, const Style& style) {
  const Rectangle room{0.0, 0.0, kCell, kCell};
  const Image picture = trace(balls, view, kCell, kCell + kCaption, room, style, facets);
  const Surface surface = to_surface(picture);
  {
    Pen pen(surface.get(), style.ink(), style.paper());
    centred(pen, title, kCell + 22.0, kCaptionText, true);
    centred(pen, caption, kCell + 54.0, 0.84 * kCaptionText, false);
  }
  return to_image(surface.get());
}

Image shape_cell(const Shape& shape, std::size_t index, const View& view, const Style& style) {
  const std::size_t count = shape.centers.size();
  return sheet_cell(shape_balls(shape, category_color(index)), {}, view, shape.name,
                    fmt::format("{} sphere{}", count, count == 1 ? "" : "s"), style);
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
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::vector<Ball> balls = shape_balls(shapes[i], category_color(i));
    if (balls.empty()) throw InputError("shape \"{}\" has no spheres to draw", shapes[i].name);
    cells.push_back(shape_cell(shapes[i], i, sheet_view(balls), style));
  }
  // A little wider than high, as a page on its side.
  const double columns = std::ceil(std::sqrt(1.6 * static_cast<double>(shapes.size())));
  write_png(grid(cells, static_cast<int>(columns), 10, style.paper()), path);
}

void render_beside_mesh(const Shape& shape, const TriangleMesh& mesh, const std::filesystem::path& path,
                        const Style& style) {
  std::vector<Ball> extent = shape_balls(shape, Vec3::Zero());
  std::vector<Facet> facets;
  for (const auto& [a, b, c] : mesh.triangles) {
    facets.push_back({{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}, category_color(1), 0});
    extent.push_back({mesh.vertices[a], 1e-9, Vec3::Zero(), 0});
  }
  const View view = sheet_view(extent);
  const std::string file = std::filesystem::path(shape.source->file).filename().string();
  const std::vector<Image> cells = {
      sheet_cell({}, facets, view, file, fmt::format("{} facets", facets.size()), style),
      shape_cell(shape, 0, view, style)};
  write_png(grid(cells, 2, 10, style.paper()), path);
}

}  // namespace cairn::render
