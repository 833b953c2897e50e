// The balls and facets as a ray tracer sees them: an Embree scene in the frame and units of the view.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "app/render/view.h"

namespace cairn::render {

/// Rays are traced sixteen at a time.
inline constexpr int kLanes = 16;

/// A sphere in the viewer's frame; lengths in halves of the view's larger side.
struct Globe {
  Eigen::Vector3f center, albedo;  ///< albedo: linear RGB
  float radius;
  std::uint32_t body;
};

/// A triangle in that frame.
struct Flat {
  Eigen::Vector3f corners[3], normal, albedo;  ///< either unit normal
  std::uint32_t body;
};

/// Owns the Embree device and scene. Balls that the view cannot show are left out, so coordinates stay small.
class Scene {
 public:
  /// @throws InputError when a ball is not finite, the view is no camera, or the ray tracer does not start.
  Scene(const std::vector<Ball>& balls, const std::vector<Facet>& facets, const View& view);

  /// Which of the two lists a hit's number counts in.
  static constexpr unsigned kGlobes = 0, kFlats = 1;

  const std::vector<Globe>& globes() const { return globes_; }
  const std::vector<Flat>& flats() const { return flats_; }
  /// Depth (towards the viewer) of a plane in front of everything.
  float front() const { return front_; }

  /// First hits of the rays whose `valid` is -1; misses keep RTC_INVALID_GEOMETRY_ID.
  void intersect(const int* valid, RTCRayHit16& rays) const;
  /// Sets tfar of the blocked among the valid rays to minus infinity.
  void occlude(const int* valid, RTCRay16& rays, bool coherent) const;

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
  };
  template <class Handle>
  using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

  void add_globes();
  void add_flats();

  std::vector<Globe> globes_;
  std::vector<Flat> flats_;
  float front_ = 0.0f;
  Owned<RTCDevice> device_;
  Owned<RTCScene> scene_;
};

/// Distance of the viewer's eye from the target in the units of the scene; 0 when orthographic.
double eye_distance(const View& view);

}  // namespace cairn::render
