// Signed distances against closed forms, against winding numbers and against FCL.
#include "shape/signed_distance.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "models.h"

namespace cairn {
namespace {

double distance_from_cube(const Vec3& x) {
  const Vec3 q = x.cwiseAbs() - Vec3::Constant(0.5);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

/// How often the surface winds around x.
double winding(const TriangleMesh& mesh, const Vec3& x) {
  double angle = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - x, b = mesh.vertices[t[1]] - x, c = mesh.vertices[t[2]] - x;
    angle += std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                               b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return angle / (2.0 * kPi);
}

TEST(SignedDistance, Cube) {
  const SignedDistance distance(make_solid(models::cube()));
  Random random(1, 0);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 x = 1.2 * random.in_ball();
    ASSERT_NEAR(distance(x).distance, distance_from_cube(x), 1e-14);
  }
  // Points whose nearest is exactly an edge, a vertex, a diagonal of a face, or the surface itself.
  for (double x = -1.0; x <= 1.0; x += 0.25)
    for (double y = -1.0; y <= 1.0; y += 0.25)
      for (double z = -1.0; z <= 1.0; z += 0.25) {
        const SignedDistance::Answer answer = distance({x, y, z});
        ASSERT_NEAR(answer.distance, distance_from_cube({x, y, z}), 1e-15);
        ASSERT_NEAR(answer.normal.norm(), 1.0, 1e-15);
        ASSERT_NEAR((Vec3(x, y, z) - answer.distance * answer.normal - answer.point).norm(), 0.0, 1e-15);
      }
}

TEST(SignedDistance, Tetrahedron) {
  const TriangleMesh mesh = models::tetrahedron();
  const SignedDistance distance(make_solid(mesh));
  const double height = 1.0 / std::sqrt(24.0);  // of the faces from the centre
  EXPECT_NEAR(distance(Vec3::Zero()).distance, -height, 1e-15);
  for (const Vec3& v : mesh.vertices) {
    EXPECT_NEAR(distance(v).distance, 0.0, 1e-15);
    EXPECT_NEAR(distance(3.0 * v).distance, 2.0 * v.norm(), 1e-15);  // beyond a vertex
    EXPECT_NEAR(distance(-v).distance, v.norm() - height, 1e-15);    // beyond the opposite face
    for (const Vec3& w : mesh.vertices) {
      if (&v == &w) continue;
      const Vec3 middle = 0.5 * (v + w);
      EXPECT_NEAR(distance(middle).distance, 0.0, 1e-15);
      EXPECT_NEAR(distance(2.0 * middle).distance, middle.norm(), 1e-15);  // beyond an edge
      EXPECT_LT(distance(0.99 * middle).distance, 0.0);
    }
  }
}

TEST(SignedDistance, FineEllipsoid) {
  const Vec3 a(1.0, 0.7, 0.4);
  const SignedDistance distance(make_solid(models::ellipsoid(a, 60)));
  Random random(2, 0);
  for (int k = 0; k < 2000; ++k) {
    // On the normal of a point of the ellipsoid, nearer than its centre of curvature.
    const Vec3 on = random.direction().cwiseProduct(a);
    const Vec3 normal = on.cwiseQuotient(a).cwiseQuotient(a).normalized();
    const double height = random.uniform(-0.15, 1.0);
    ASSERT_NEAR(distance(on + height * normal).distance, height, 4e-4);
  }
}

TEST(SignedDistance, SignsAreThoseOfTheWindingNumber) {
  // Spikes: sharp vertices and edges, where the nearest face alone gives wrong sides.
  TriangleMesh spiky = models::ball(3);
  Random random(5, 0);
  for (Vec3& x : spiky.vertices) x *= random.uniform(0.25, 1.0);
  for (const TriangleMesh& mesh : {spiky, models::boulder(2), models::top()}) {
    const SignedDistance distance(make_solid(mesh));
    const double size = mesh.vertices[0].norm();
    int inside = 0;
    for (int k = 0; k < 20000; ++k) {
      Vec3 x = 1.5 * size * random.in_ball();
      // Close to vertices, edges and faces as well.
      const auto& t = mesh.triangles[random.bits() % mesh.triangles.size()];
      const double u = k % 3 == 0 ? 0.0 : random.uniform(),
                   v = k % 3 < 2 ? 0.0 : (1.0 - u) * random.uniform();
      if (k % 2)
        x = (1.0 - u - v) * mesh.vertices[t[0]] + u * mesh.vertices[t[1]] + v * mesh.vertices[t[2]] +
            std::pow(10.0, random.uniform(-6.0, -1.0)) * size * random.direction();
      const double w = winding(mesh, x);
      ASSERT_EQ(distance.inside(x), w > 0.5)
          << x.transpose() << " distance " << distance(x).distance << " " << w;
      inside += w > 0.5;
    }
    EXPECT_GT(inside, 2000);
  }
}

TEST(SignedDistance, AgreesWithFcl) {
  const TriangleMesh mesh = models::boulder(3);
  const SignedDistance distance(make_solid(mesh));
  fcl::BVHModel<fcl::OBBRSSd> model;
  std::vector<fcl::Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
  model.beginModel();
  model.addSubModel(mesh.vertices, triangles);
  model.endModel();
  const double radius = 1e-3;
  const fcl::Sphered probe(radius);
  Random random(6, 0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 x = 1.5 * random.in_ball();
    const double ours = std::abs(distance(x).distance);
    if (ours < 2.0 * radius) continue;
    fcl::Transform3d place = fcl::Transform3d::Identity();
    place.translation() = x;
    fcl::DistanceResultd result;
    fcl::distance<double>(&model, fcl::Transform3d::Identity(), &probe, place, fcl::DistanceRequestd(),
                          result);
    ASSERT_NEAR(result.min_distance + radius, ours, 1e-12);
  }
}

TEST(SignedDistance, FarFromTheOrigin) {
  const Vec3 far(1e9, -2e9, 3e9);
  TriangleMesh mesh = models::cube();
  for (Vec3& x : mesh.vertices) x += far;
  const SignedDistance distance(make_solid(mesh));
  Random random(7, 0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 x = (far + 1.2 * random.in_ball()).eval();
    ASSERT_NEAR(distance(x).distance, distance_from_cube(x - far), 2e-6);
  }
}

}  // namespace
}  // namespace cairn
