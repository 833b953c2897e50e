#include "app/render/text.h"

namespace cairn::render {

Pen::Pen(cairo_surface_t* surface, const Vec3& ink, const Vec3& paper)
    : context_(cairo_create(surface)), ink_(ink), paper_(paper) {
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
}

void Pen::font(double height, bool bold) {
  cairo_select_font_face(context_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context_.get(), height);
}

void Pen::color(const Vec3& rgb) {
  cairo_set_source_rgb(context_.get(), rgb.x(), rgb.y(), rgb.z());
}

double Pen::text_width(const std::string& text, double height, bool bold) {
  font(height, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(context_.get(), text.c_str(), &extents);
  return extents.x_advance;
}

void Pen::text(const std::string& text, double x, double y, double height, bool bold) {
  font(height, bold);
  cairo_move_to(context_.get(), x, y);
  cairo_text_path(context_.get(), text.c_str());
  color(paper_);
  cairo_set_line_width(context_.get(), 0.22 * height);
  cairo_stroke_preserve(context_.get());
  color(ink_);
  cairo_fill(context_.get());
}

void Pen::upright_text(const std::string& text, double x, double y, double height) {
  const double width = text_width(text, height);
  cairo_save(context_.get());
  cairo_translate(context_.get(), x, y);
  cairo_rotate(context_.get(), -0.5 * kPi);
  this->text(text, -0.5 * width, 0.0, height);
  cairo_restore(context_.get());
}

void Pen::rectangle(double x, double y, double width, double height, const Vec3& fill) {
  color(fill);
  cairo_rectangle(context_.get(), x, y, width, height);
  cairo_fill(context_.get());
}

void Pen::frame(double x, double y, double width, double height, double line) {
  color(ink_);
  cairo_set_line_width(context_.get(), line);
  cairo_rectangle(context_.get(), x, y, width, height);
  cairo_stroke(context_.get());
}

void Pen::disc(double x, double y, double radius, const Vec3& fill) {
  color(fill);
  cairo_new_path(context_.get());
  cairo_arc(context_.get(), x, y, radius, 0.0, 2.0 * kPi);
  cairo_fill_preserve(context_.get());
  color(0.5 * (ink_ + fill));
  cairo_set_line_width(context_.get(), 0.12 * radius);
  cairo_stroke(context_.get());
}

}  // namespace cairn::render
