#include "app/render/scene.h"

#include <algorithm>
#include <cmath>

#include "app/render/color.h"
#include "core/error.h"

namespace cairn::render {
namespace {

/// Balls farther than this from the target (halves of the view's larger side) cannot matter to the picture,
/// and would cost the near ones digits.
constexpr double kReach = 40.0;

Eigen::Vector3f linear(const Vec3& color) {
  return Vec3(to_linear(color.x()), to_linear(color.y()), to_linear(color.z())).cast<float>();
}

std::vector<Globe> visible_globes(const std::vector<Ball>& balls, const View& view) {
  const Mat3 camera = camera_frame(view);
  const double unit = 0.5 * std::max(view.width, view.height);
  const double eye = eye_distance(view);
  std::vector<Globe> globes;
  globes.reserve(balls.size());
  for (const Ball& ball : balls) {
    const Vec3 center = camera * ((ball.center - view.target) / unit);
    const double radius = ball.radius / unit;
    if (center.norm() - radius > kReach) continue;
    // A ball at the eye would hide everything.
    if (eye > 0.0 && center.z() + radius > 0.9 * eye) continue;
    globes.push_back({center.cast<float>(), linear(ball.color), static_cast<float>(radius), ball.body});
  }
  return globes;
}

std::vector<Flat> visible_flats(const std::vector<Facet>& facets, const View& view) {
  const Mat3 camera = camera_frame(view);
  const double unit = 0.5 * std::max(view.width, view.height);
  const double eye = eye_distance(view);
  std::vector<Flat> flats;
  for (const Facet& facet : facets) {
    Flat flat;
    bool shown = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 corner = camera * ((facet.corners[k] - view.target) / unit);
      shown = shown && corner.norm() <= kReach && !(eye > 0.0 && corner.z() > 0.9 * eye);
      flat.corners[k] = corner.cast<float>();
    }
    if (!shown) continue;
    flat.normal = (flat.corners[1] - flat.corners[0]).cross(flat.corners[2] - flat.corners[0]).normalized();
    flat.albedo = linear(facet.color);
    flat.body = facet.body;
    flats.push_back(flat);
  }
  return flats;
}

}  // namespace

double eye_distance(const View& view) {
  return view.field_of_view > 0.0 ? 1.0 / std::tan(view.field_of_view * kPi / 360.0) : 0.0;
}

Scene::Scene(const std::vector<Ball>& balls, const std::vector<Facet>& facets, const View& view) {
  require_finite(balls);
  globes_ = visible_globes(balls, view);
  flats_ = visible_flats(facets, view);
  // One thread: the tree, and with it the choice between equal hits, is then the same on every machine.
  device_.reset(rtcNewDevice("threads=1,set_affinity=0"));
  if (!device_)
    throw InputError("the ray tracer does not start (Embree error {})", rtcGetDeviceError(nullptr));
  scene_.reset(rtcNewScene(device_.get()));
  if (!globes_.empty() || !flats_.empty()) front_ = -HUGE_VALF;
  if (!globes_.empty()) add_globes();
  if (!flats_.empty()) add_flats();
  front_ += 0.01f;
  rtcCommitScene(scene_.get());
  if (const RTCError error = rtcGetDeviceError(device_.get()); error != RTC_ERROR_NONE)
    throw InputError("the ray tracer cannot hold {} balls and {} triangles (Embree error {})", globes_.size(),
                     flats_.size(), static_cast<int>(error));
}

void Scene::add_globes() {
  const Owned<RTCGeometry> geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT));
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), globes_.size()));
  if (!vertices) throw InputError("no memory to draw {} balls", globes_.size());
  for (const Globe& globe : globes_) {
    vertices = std::copy_n(globe.center.data(), 3, vertices);
    *vertices++ = globe.radius;
    front_ = std::max(front_, globe.center.z() + globe.radius);
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(scene_.get(), geometry.get(), kGlobes);
}

void Scene::add_flats() {
  const Owned<RTCGeometry> geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * flats_.size()));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), flats_.size()));
  if (!vertices || !indices) throw InputError("no memory to draw {} triangles", flats_.size());
  unsigned next = 0;
  for (const Flat& flat : flats_)
    for (const Eigen::Vector3f& corner : flat.corners) {
      vertices = std::copy_n(corner.data(), 3, vertices);
      *indices++ = next++;
      front_ = std::max(front_, corner.z());
    }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(scene_.get(), geometry.get(), kFlats);
}

void Scene::intersect(const int* valid, RTCRayHit16& rays) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, scene_.get(), &context, &rays);
}

void Scene::occlude(const int* valid, RTCRay16& rays, bool coherent) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, scene_.get(), &context, &rays);
}

}  // namespace cairn::render
