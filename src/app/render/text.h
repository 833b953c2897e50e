// Text and simple marks on a cairo surface.
#pragma once

#include <string>

#include "app/render/surface.h"

namespace cairn::render {

/// Draws on a surface in the ink and paper of a picture; lengths in pixels. A font that is missing is
/// replaced by the system's own choice.
class Pen {
 public:
  Pen(cairo_surface_t* surface, const Vec3& ink, const Vec3& paper);

  /// Width of a text of the given height.
  double text_width(const std::string& text, double height, bool bold = false);
  /// Text whose baseline starts at (x, y), with a rim of paper so that it can be read on anything.
  void text(const std::string& text, double x, double y, double height, bool bold = false);
  /// Text that reads upwards, its baseline's middle at (x, y).
  void upright_text(const std::string& text, double x, double y, double height);
  void rectangle(double x, double y, double width, double height, const Vec3& fill);
  void frame(double x, double y, double width, double height, double line);
  void disc(double x, double y, double radius, const Vec3& fill);

  const Vec3& ink() const { return ink_; }
  const Vec3& paper() const { return paper_; }

 private:
  void font(double height, bool bold);
  void color(const Vec3& rgb);

  Context context_;
  Vec3 ink_, paper_;
};

}  // namespace cairn::render
