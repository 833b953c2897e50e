// The light that the balls send to the viewer.
#pragma once

#include <cstdint>

#include "app/render/scene.h"

namespace cairn::render {

/// What sixteen camera rays see. A miss has body kNothing.
struct Seen {
  static constexpr std::uint64_t kNothing = UINT64_MAX;

  Eigen::Vector3f light[kLanes];  ///< linear RGB
  std::uint64_t body[kLanes];
  float radius[kLanes];  ///< of the ball hit, units of the scene
};

/// Camera rays and where their random numbers come from.
struct Bundle {
  bool lit = true;                                    ///< false: only what is hit is asked for, not its light
  Eigen::Vector3f origin[kLanes], direction[kLanes];  ///< directions of unit length
  std::uint32_t pixel_x[kLanes], pixel_y[kLanes];
  std::uint32_t sample[kLanes];  ///< number of the sample within its pixel
  std::uint32_t samples = 1;     ///< per pixel
};

/// Follows a bundle to its first hits and lights them.
class Shader {
 public:
  Shader(const Scene& scene, const Eigen::Vector3f& sun, int sky_rays);
  void operator()(const Bundle& bundle, Seen& seen) const;

 private:
  struct Hits;
  void add_sunlight(const Bundle& bundle, const Hits& hits, Seen& seen) const;
  void add_skylight(const Bundle& bundle, const Hits& hits, Seen& seen) const;

  const Scene& scene_;
  Eigen::Vector3f sun_;
  int sky_rays_;
};

}  // namespace cairn::render
