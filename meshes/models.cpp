#include "models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "shape/solid_mesh.h"

namespace cairn::models {

namespace {

/// Moves every vertex of a unit ball along its ray: `distance(direction)` from the origin.
template <class Distance>
TriangleMesh star(std::uint32_t parts, Distance&& distance) {
  TriangleMesh mesh = ball(parts);
  for (Vec3& x : mesh.vertices) x *= distance(x);
  return mesh;
}

/// The distance at which a ray leaves the planes n . x = height.
struct Planes {
  std::vector<Vec3> normals;
  std::vector<double> heights;

  double operator()(const Vec3& ray) const {
    double nearest = 1e300;
    for (std::size_t k = 0; k < normals.size(); ++k)
      if (const double along = normals[k].dot(ray); along > 0.0)
        nearest = std::min(nearest, heights[k] / along);
    return nearest;
  }
};

}  // namespace

TriangleMesh ball(std::uint32_t parts) {
  const double g = std::numbers::phi;
  TriangleMesh ico;
  for (const double s : {-1.0, 1.0})
    for (const double t : {-g, g})
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 x = Vec3::Zero();
        x[(axis + 1) % 3] = s;
        x[(axis + 2) % 3] = t;
        ico.vertices.push_back(x);
      }
  TriangleMesh mesh;
  const double edge = 2.0;
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c) {
        const Vec3 &x = ico.vertices[a], &y = ico.vertices[b], &z = ico.vertices[c];
        const auto apart = [edge](const Vec3& p, const Vec3& q) {
          return std::abs((p - q).norm() - edge) > 1e-6;
        };
        if (apart(x, y) || apart(y, z) || apart(z, x)) continue;
        const bool outward = (y - x).cross(z - x).dot(x) > 0.0;
        const Vec3 along = (outward ? y : z) - x, across = (outward ? z : y) - x;
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        const auto at = [&](std::uint32_t i, std::uint32_t j) { return first + i * (i + 1) / 2 + j; };
        for (std::uint32_t i = 0; i <= parts; ++i)
          for (std::uint32_t j = 0; j <= i; ++j)
            mesh.vertices.push_back((x + (along * (i - j) + across * j) / parts).normalized());
        for (std::uint32_t i = 0; i < parts; ++i)
          for (std::uint32_t j = 0; j <= i; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            if (j < i) mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
          }
      }
  return weld(mesh, 1e-9);
}

TriangleMesh ellipsoid(const Vec3& semi_axes, std::uint32_t parts) {
  TriangleMesh mesh = ball(parts);
  for (Vec3& x : mesh.vertices) x = x.cwiseProduct(semi_axes);
  return mesh;
}

TriangleMesh cube() {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back(Vec3((corner & 1) - 0.5, (corner >> 1 & 1) - 0.5, (corner >> 2 & 1) - 0.5));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  const double half = 0.5 / std::numbers::sqrt2;
  mesh.vertices = {{half, half, half}, {half, -half, -half}, {-half, half, -half}, {-half, -half, half}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return mesh;
}

TriangleMesh boulder(std::uint64_t seed) {
  Random random(seed, 0);
  const double middle = random.uniform(0.7, 0.95), low = middle * random.uniform(0.6, 0.9);
  const Vec3 semi_axes(1.0, middle, low);
  Planes planes;
  const auto face = [&](const Vec3& normal, double depth) {
    planes.normals.push_back(normal);
    planes.heights.push_back(depth * normal.cwiseProduct(semi_axes).norm());  // of the ellipsoid's tangent
  };
  for (int axis = 0; axis < 3; ++axis)  // a tilted block, then cuts
    for (const double side : {-1.0, 1.0})
      face((side * Vec3::Unit(axis) + 0.35 * random.in_ball()).normalized(), random.uniform(0.75, 0.9));
  for (int cut = 0; cut < 10; ++cut) face(random.direction(), random.uniform(0.78, 1.0));
  std::vector<Vec3> bumps;
  std::vector<double> sizes;
  for (int k = 0; k < 12; ++k) {
    bumps.push_back(random.direction());
    sizes.push_back(random.uniform(-0.06, 0.03));
  }
  const Quat turn = random.rotation();
  return star(6, [&](const Vec3& ray) {
    double rough = 1.0;
    for (std::size_t k = 0; k < bumps.size(); ++k)
      rough += sizes[k] * std::exp(8.0 * (bumps[k].dot(ray) - 1.0));
    return planes(turn * ray) * rough;
  });
}

TriangleMesh top() {
  TriangleMesh mesh = star(8, [](const Vec3& ray) {
    const double sine = std::abs(ray.z());                                   // of the latitude
    const double cone = 1.0 / (0.72 * sine + std::hypot(ray.x(), ray.y()));  // of flanks at 36 degrees
    const double ridge = 0.05 * std::exp(-std::pow(sine / 0.12, 2));
    const double smooth = 1.0 / std::pow(std::pow(1.0 / (1.06 * cone), 6) + 1.0, 1.0 / 6.0);
    const double poles = sine > 0.0 ? 0.93 / sine : 1e300;
    const double lobes =
        0.01 * (ray.x() * ray.x() * ray.x() * ray.x() - ray.x() * ray.x() * ray.y() * ray.y());
    return std::min(smooth + ridge + lobes, poles);
  });
  // Symmetric about the planes of coordinates: stretching along the axes stretches the equivalent ellipsoid.
  const Vec3 wanted = 0.5 * Vec3(797.0, 783.0, 761.0);
  const MassProperties mass = mass_of(mesh);
  Vec3 semi_axes;
  for (Eigen::Index k = 0; k < 3; ++k)
    semi_axes[k] = std::sqrt(2.5 * (mass.inertia.trace() - 2.0 * mass.inertia(k, k)) / mass.volume);
  semi_axes *= std::cbrt(mass.volume / (4.0 / 3.0 * kPi * semi_axes.prod()));
  for (Vec3& x : mesh.vertices) x = x.cwiseProduct(wanted.cwiseQuotient(semi_axes));
  return mesh;
}

std::vector<Model> all() {
  std::vector<Model> models = {{"cube.obj", cube()},
                               {"tetrahedron.obj", tetrahedron()},
                               {"ellipsoid.obj", ellipsoid({1.0, 0.8, 0.6}, 6)},
                               {"needle.obj", ellipsoid({1.0, 0.3, 0.3}, 6)},
                               {"top.obj", top()}};
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    models.push_back({fmt::format("boulder{}.obj", seed), boulder(seed)});
  return models;
}

}  // namespace cairn::models
