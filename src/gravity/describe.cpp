#include "gravity/tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gravity/describe.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <cmath>

#include "core/elementary.h"
#include "gravity/pack-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cairn::gravity {
namespace HWY_NAMESPACE {

Cell describe(const PointArrays& points, std::size_t from, std::size_t to) {
  Cell c{Vec3::Zero(), 0.0, 0.0, 0.0, 0.0};
  if (from == to) return c;
  // About one of the points, so that a small cell far from the origin keeps its digits.
  const Pack x0 = points.x[from], y0 = points.y[from], z0 = points.z[from];
  Pack mass = 0.0, mx = 0.0, my = 0.0, mz = 0.0, x = 0.0, y = 0.0, z = 0.0;
  for (std::size_t i = from; i < to; i += kPack) {
    const Pack live = head(to - i), m = live * load(&points.mass[i]);
    const Pack dx = live * (load(&points.x[i]) - x0), dy = live * (load(&points.y[i]) - y0),
               dz = live * (load(&points.z[i]) - z0);
    mass += m;
    mx += m * dx;
    my += m * dy;
    mz += m * dz;
    x += dx;
    y += dy;
    z += dz;
  }
  const double total = sum(mass);
  const Vec3 offset = total > 0.0 ? Vec3(Vec3(sum(mx), sum(my), sum(mz)) / total)
                                  : Vec3(Vec3(sum(x), sum(y), sum(z)) / static_cast<double>(to - from));
  c.centre = Vec3(points.x[from], points.y[from], points.z[from]) + offset;

  const Pack cx = c.centre.x(), cy = c.centre.y(), cz = c.centre.z();
  Pack largest = 0.0, sixth = 0.0;
  for (std::size_t i = from; i < to; i += kPack) {
    const Pack dx = load(&points.x[i]) - cx, dy = load(&points.y[i]) - cy, dz = load(&points.z[i]) - cz;
    const Pack d2 = head(to - i) * fma(dx, dx, fma(dy, dy, dz * dz));
    largest = max(d2, largest);
    sixth = fma(load(&points.mass[i]) * d2, d2 * d2, sixth);
  }
  alignas(64) double square[kPack];
  largest.store(square);
  c.radius = std::sqrt(*std::max_element(square, square + kPack));
  c.mass = total;
  c.spread = total > 0.0 ? std::min(c.radius, std::sqrt(cube_root(sum(sixth) / total))) : c.radius;
  return c;
}

}  // namespace HWY_NAMESPACE
}  // namespace cairn::gravity
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cairn::gravity {

HWY_EXPORT(describe);

Cell describe(const PointArrays& points, std::size_t from, std::size_t to) {
  return HWY_DYNAMIC_DISPATCH(describe)(points, from, to);
}

}  // namespace cairn::gravity
#endif
