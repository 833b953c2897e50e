#include "app/render/shade.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cairn::render {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr float kPif = static_cast<float>(kPi);
constexpr float kSunRadius = 0.09f;  // tangent; wide enough for shadows with soft borders
const Vec3f kSunlight = 0.80f * Vec3f(1.03f, 1.0f, 0.95f);  // reflected by a white surface that faces the sun
const Vec3f kSkylight = 0.42f * Vec3f(0.96f, 1.0f, 1.06f);  // reflected by a white surface under the open sky
constexpr float kBounce = 0.13f;  // light from what blocks the sky, of the sky's own

/// Points of low discrepancy in the unit square (Roberts 2018, "R2"). The pixels of a square of 4 x 4 take
/// their turns on one sequence, so that errors of neighbours cancel for the eye; each square and purpose has
/// its own random shift. All depends on pixel, sample and purpose alone: no order of work shows in the
/// picture.
class Samples {
 public:
  Samples(std::uint32_t x, std::uint32_t y, std::uint32_t purpose) {
    shift_u_ = mix(x / 4 + 0x9e3779b9u * mix(y / 4 + 0x85ebca6bu * (purpose + 1)));
    shift_v_ = mix(shift_u_ ^ 0x68bc21ebu);
    // Bits of x and y interleaved: each quarter of the square is spread over the sequence as well.
    turn_ = (x & 1) | (y & 1) << 1 | (x & 2) << 1 | (y & 2) << 2;
  }
  /// Point i of the `count` points of this pixel.
  std::pair<float, float> operator()(std::uint32_t i, std::uint32_t count) const {
    const std::uint32_t number = turn_ * count + i;
    return {unit(shift_u_ + 3242174889u * number), unit(shift_v_ + 2447445414u * number)};
  }

 private:
  /// An integer hash with good avalanche (Wellons 2018, "lowbias32").
  static std::uint32_t mix(std::uint32_t h) {
    h = (h ^ h >> 16) * 0x7feb352du;
    h = (h ^ h >> 15) * 0x846ca68bu;
    return h ^ h >> 16;
  }
  static float unit(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

  std::uint32_t shift_u_, shift_v_, turn_;
};

/// The two directions that complete a unit vector to a right-handed frame (Duff et al. 2017).
std::pair<Vec3f, Vec3f> tangents(const Vec3f& n) {
  const float sign = std::copysign(1.0f, n.z());
  const float a = -1.0f / (sign + n.z());
  const float b = n.x() * n.y() * a;
  return {Vec3f(1.0f + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Vec3f(b, sign + n.y() * n.y() * a, -n.y())};
}

void set_ray(RTCRay16& rays, int lane, const Vec3f& origin, const Vec3f& direction) {
  rays.org_x[lane] = origin.x();
  rays.org_y[lane] = origin.y();
  rays.org_z[lane] = origin.z();
  rays.dir_x[lane] = direction.x();
  rays.dir_y[lane] = direction.y();
  rays.dir_z[lane] = direction.z();
  rays.tnear[lane] = 0.0f;
  rays.tfar[lane] = std::numeric_limits<float>::infinity();
  rays.time[lane] = 0.0f;
  rays.mask[lane] = ~0u;
  rays.id[lane] = 0;
  rays.flags[lane] = 0;
}

}  // namespace

struct Shader::Hits {
  alignas(64) int valid[kLanes];
  bool any = false;
  Vec3f point[kLanes], normal[kLanes], albedo[kLanes];
};

Shader::Shader(const Scene& scene, const Vec3f& sun, int sky_rays)
    : scene_(scene), sun_(sun.normalized()), sky_rays_(sky_rays) {}

void Shader::operator()(const Bundle& bundle, Seen& seen) const {
  RTCRayHit16 rays{};
  for (int i = 0; i < kLanes; ++i) {
    set_ray(rays.ray, i, bundle.origin[i], bundle.direction[i]);
    rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  alignas(64) int all[kLanes];
  std::fill_n(all, kLanes, -1);
  scene_.intersect(all, rays);
  Hits hits;
  for (int i = 0; i < kLanes; ++i) {
    seen.light[i].setZero();
    seen.body[i] = Seen::kNothing;
    seen.radius[i] = 0.0f;
    const bool hit = rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    hits.valid[i] = hit ? -1 : 0;
    if (!hit) continue;
    hits.any = true;
    const Vec3f rough = bundle.origin[i] + rays.ray.tfar[i] * bundle.direction[i];
    Vec3f albedo;
    if (rays.hit.geomID[i] == Scene::kGlobes) {
      const Globe& globe = scene_.globes()[rays.hit.primID[i]];
      seen.body[i] = globe.body;
      seen.radius[i] = globe.radius;
      albedo = globe.albedo;
      hits.normal[i] = (rough - globe.center).normalized();
      // Back onto the sphere, and off it by more than the rounding of its surface.
      hits.point[i] = globe.center + (1.0003f * globe.radius + 1e-6f) * hits.normal[i];
    } else {
      const Flat& flat = scene_.flats()[rays.hit.primID[i]];
      seen.body[i] = flat.body;
      seen.radius[i] = 1.0f;  // wide enough for lines
      albedo = flat.albedo;
      hits.normal[i] = flat.normal.dot(bundle.direction[i]) < 0.0f ? flat.normal : Vec3f(-flat.normal);
      hits.point[i] = rough + 1e-4f * hits.normal[i];
    }
    // Surfaces seen edge-on are darkened a little: it rounds the spheres and costs no ray.
    const float facing = std::max(0.0f, -hits.normal[i].dot(bundle.direction[i]));
    const float edge = (1.0f - facing) * (1.0f - facing) * (1.0f - facing);
    hits.albedo[i] = (1.0f - 0.25f * edge) * albedo;
  }
  if (!hits.any || !bundle.lit) return;
  add_sunlight(bundle, hits, seen);
  add_skylight(bundle, hits, seen);
}

void Shader::add_sunlight(const Bundle& bundle, const Hits& hits, Seen& seen) const {
  const auto [across, along] = tangents(sun_);
  RTCRay16 rays{};
  alignas(64) int valid[kLanes];
  float cosine[kLanes];
  bool any = false;
  for (int i = 0; i < kLanes; ++i) {
    valid[i] = 0;
    if (!hits.valid[i]) continue;
    const auto [u, v] = Samples(bundle.pixel_x[i], bundle.pixel_y[i], 0)(bundle.sample[i], bundle.samples);
    const float r = kSunRadius * std::sqrt(u), angle = 2.0f * kPif * v;
    const Vec3f direction = (sun_ + r * std::cos(angle) * across + r * std::sin(angle) * along).normalized();
    cosine[i] = direction.dot(hits.normal[i]);
    if (cosine[i] <= 0.0f) continue;
    valid[i] = -1;
    any = true;
    set_ray(rays, i, hits.point[i], direction);
  }
  if (!any) return;
  scene_.occlude(valid, rays, true);
  for (int i = 0; i < kLanes; ++i) {
    if (valid[i] && rays.tfar[i] >= 0.0f) seen.light[i] += cosine[i] * hits.albedo[i].cwiseProduct(kSunlight);
  }
}

void Shader::add_skylight(const Bundle& bundle, const Hits& hits, Seen& seen) const {
  std::pair<Vec3f, Vec3f> frame[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    if (hits.valid[i]) frame[i] = tangents(hits.normal[i]);
  }
  float sky[kLanes] = {};
  RTCRay16 rays{};
  const std::uint32_t rays_per_pixel = static_cast<std::uint32_t>(sky_rays_) * bundle.samples;
  for (int k = 0; k < sky_rays_; ++k) {
    for (int i = 0; i < kLanes; ++i) {
      if (!hits.valid[i]) continue;
      const auto number =
          static_cast<std::uint32_t>(sky_rays_) * bundle.sample[i] + static_cast<std::uint32_t>(k);
      const auto [u, v] = Samples(bundle.pixel_x[i], bundle.pixel_y[i], 1)(number, rays_per_pixel);
      const float r = std::sqrt(u), angle = 2.0f * kPif * v;
      const Vec3f direction = r * std::cos(angle) * frame[i].first + r * std::sin(angle) * frame[i].second +
                              std::sqrt(1.0f - u) * hits.normal[i];
      set_ray(rays, i, hits.point[i], direction);
    }
    scene_.occlude(hits.valid, rays, false);
    for (int i = 0; i < kLanes; ++i) {
      // The sky is brighter above and behind the viewer, which keeps the shaded side readable. What blocks it
      // sends back a part, so that hollows are dim and not black.
      if (hits.valid[i])
        sky[i] += rays.tfar[i] >= 0.0f ? 0.75f + 0.25f * rays.dir_y[i] + 0.25f * rays.dir_z[i] : kBounce;
    }
  }
  for (int i = 0; i < kLanes; ++i) {
    if (hits.valid[i])
      seen.light[i] += sky[i] / static_cast<float>(sky_rays_) * hits.albedo[i].cwiseProduct(kSkylight);
  }
}

}  // namespace cairn::render
