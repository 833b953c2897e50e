// What is looked at, and from where.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math.h"

namespace cairn::render {

/// One sphere to be drawn.
struct Ball {
  Vec3 center = Vec3::Zero();        ///< m
  double radius = 0.0;               ///< m
  Vec3 color = Vec3::Constant(0.7);  ///< sRGB 0..1
  std::uint32_t body = 0;            ///< balls of one body are drawn as one solid, without lines between
};

/// One flat triangle to be drawn, seen from both sides.
struct Facet {
  std::array<Vec3, 3> corners;       ///< m
  Vec3 color = Vec3::Constant(0.7);  ///< sRGB 0..1
  std::uint32_t body = 0;
};

/// A camera. The region of `width` x `height` metres around `target` is fitted into the free part of the
/// picture; what lies around it is seen as far as the picture goes.
struct View {
  Vec3 direction = Vec3(1.0, -1.0, 0.8);  ///< from the target towards the viewer, any length
  Vec3 up = Vec3::UnitZ();                ///< this direction points up in the picture
  Vec3 target = Vec3::Zero();             ///< m
  double width = 1.0;                     ///< m
  double height = 1.0;                    ///< m
  double field_of_view = 0.0;             ///< degrees across the larger side; 0 is orthographic, below 120
  Vec3 sun = Vec3(-0.55, 0.65, 0.65);     ///< towards the sun, in the frame of the viewer: right, up, nearer
};

/// Rows are the viewer's right, up and towards-the-viewer directions in space.
/// @throws InputError when the view's directions or lengths do not define a camera.
Mat3 camera_frame(const View& view);

/// How `frame` chooses the region.
struct Framing {
  double fraction = 1.0;  ///< of the volume of all balls that must be seen; 0.99 leaves far-flung ones out
  double margin = 0.03;   ///< empty border, as part of the region
};

/// A view like `like` with target, width and height such that the balls are seen. With a fraction below 1 the
/// balls nearest to the (volume-weighted, per axis) median of the centres are framed.
/// @throws InputError when there is no ball with finite centre and finite positive radius.
View frame(const std::vector<Ball>& balls, const View& like = {}, const Framing& framing = {});

/// @throws InputError naming the first ball whose centre, radius or colour is not finite, or radius <= 0.
void require_finite(const std::vector<Ball>& balls);

}  // namespace cairn::render
