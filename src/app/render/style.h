// How a picture is made, whatever it shows.
#pragma once

#include "core/math.h"

namespace cairn::render {

enum class Background { white, dark };

/// Quality against time, and the ground. Rays per pixel: samples^2 of the camera, and for each that hits one
/// to the sun and `sky_rays` to the sky.
struct Style {
  Background background = Background::white;
  int samples = 4;       ///< per pixel and axis: 1, 2, 4 or 8
  int sky_rays = 2;      ///< per camera ray, 1..64
  bool outlines = true;  ///< thin dark lines between different bodies

  static Style draft(Background ground = Background::white) { return {ground, 2, 2, true}; }
  static Style fine(Background ground = Background::white) { return {ground, 8, 2, true}; }

  /// Colours of the ground and of what is written on it, sRGB 0..1.
  Vec3 paper() const { return background == Background::white ? Vec3::Ones() : Vec3(0.055, 0.06, 0.075); }
  Vec3 ink() const { return background == Background::white ? Vec3::Constant(0.1) : Vec3::Constant(0.93); }
};

}  // namespace cairn::render
