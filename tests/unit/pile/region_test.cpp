#include "pile/region.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "folder.h"

namespace cairn {
namespace {

constexpr const char* kCube = R"(v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

RegionSpec spec_of(RegionKind kind) {
  RegionSpec spec;
  spec.kind = kind;
  return spec;
}

TEST(Region, DistanceFromAnEllipsoidIsThatOfTheNearestOfManyPoints) {
  const Vec3 semi(3.0, 2.0, 0.7);
  std::vector<Vec3> surface;
  Random random(1, 0);
  for (int k = 0; k < 200000; ++k) surface.push_back(semi.cwiseProduct(random.direction()));
  std::vector<Vec3> places{
      {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.9, 0.0}, {0.0, 0.0, 5.0}, {2.9, 0.0, 0.01}};
  for (int k = 0; k < 60; ++k) places.push_back(4.0 * random.in_ball());
  for (const Vec3& x : places) {
    double nearest = 1e9;
    for (const Vec3& p : surface) nearest = std::min(nearest, (p - x).norm());
    const double found = ellipsoid_distance(semi, x);
    EXPECT_EQ(found < 0.0, x.cwiseQuotient(semi).norm() < 1.0);
    EXPECT_LE(std::abs(found), nearest + 1e-9);
    EXPECT_GT(std::abs(found), nearest - 0.02);  // points are some 0.02 apart
  }
  EXPECT_NEAR(ellipsoid_distance(Vec3::Constant(2.0), {0.3, 0.4, 1.2}), -0.7, 1e-11);
  EXPECT_NEAR(ellipsoid_distance(semi, {10.0, 0.0, 0.0}), 7.0, 1e-9);
  EXPECT_NEAR(ellipsoid_distance(semi, Vec3::Zero()), -0.7, 1e-9);
}

TEST(Region, MeshStretchedToABoxIsThatBox) {
  const Folder folder;
  folder.write("cube.obj", kCube);
  RegionSpec mesh = spec_of(RegionKind::mesh);
  mesh.size = {4.0, 6.0, 8.0};
  mesh.file = "cube.obj";
  mesh.position = {1.0, 2.0, 3.0};
  mesh.orientation = Quat(1.0, 0.2, 0.3, -0.4).normalized();
  RegionSpec box = spec_of(RegionKind::box);
  box.size = mesh.size;
  box.orientation = mesh.orientation;
  box.position = mesh.position + mesh.orientation * Vec3(2.0, 3.0, 4.0);  // a mesh's origin is its corner
  const Region a(mesh, folder.path()), b(box, InputFiles());
  EXPECT_NEAR(a.volume(), 192.0, 1e-9);
  EXPECT_EQ(b.volume(), 192.0);
  Random random(2, 0);
  for (int k = 0; k < 500; ++k) {
    const Vec3 x = box.position + 8.0 * random.in_ball();
    EXPECT_NEAR(a.distance(x), b.distance(x), 1e-9);
  }
}

// A box of 4 x 6 x 8 m somewhere in its file, turned.
TEST(Region, MeshIsMovedToItsCentroidAndTurnedToItsPrincipalAxes) {
  const Folder folder;
  const Quat turn = Quat(1.0, 0.5, -0.3, 0.8).normalized();
  const Vec3 place(30.0, -20.0, 10.0);
  std::string obj;
  for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0, 0, 1),
                             Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(0, 1, 1)}) {
    const Vec3 v = place + turn * corner.cwiseProduct(Vec3(6.0, 8.0, 4.0));
    obj += fmt::format("v {:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  }
  folder.write("box.obj", obj + std::string(kCube).substr(std::string(kCube).find("f ")));
  RegionSpec mesh = spec_of(RegionKind::mesh), box = spec_of(RegionKind::box);
  mesh.file = "box.obj";
  mesh.position = box.position = {1.0, 2.0, 3.0};
  mesh.frame = MeshFrame::principal;
  box.size = {8.0, 6.0, 4.0};  // the longest along x, the shortest along z
  const Region principal(mesh, folder.path()), expected(box, InputFiles());
  mesh.frame = MeshFrame::centroid;
  box.size = {6.0, 8.0, 4.0};
  box.orientation = turn;
  const Region centred(mesh, folder.path()), turned(box, InputFiles());
  Random random(4, 0);
  for (int k = 0; k < 500; ++k) {
    const Vec3 x = box.position + 8.0 * random.in_ball();
    EXPECT_NEAR(principal.distance(x), expected.distance(x), 1e-5);  // single precision of the file
    EXPECT_NEAR(centred.distance(x), turned.distance(x), 1e-5);
  }
}

TEST(Region, BallHasItsVolumeAndDistance) {
  RegionSpec spec;
  spec.radius = 2.0;
  spec.position = {1.0, 0.0, 0.0};
  const Region region(spec, InputFiles());
  EXPECT_NEAR(region.volume(), 32.0 / 3.0 * kPi, 1e-12);
  EXPECT_NEAR(region.distance({4.0, 4.0, 0.0}), 3.0, 1e-12);
  EXPECT_EQ(region.reach(), 2.0);
}

TEST(Region, NeedsAClosedMesh) {
  const Folder folder;
  folder.write("open.obj", std::string(kCube).substr(0, std::string(kCube).rfind("f 4")));
  RegionSpec open = spec_of(RegionKind::mesh);
  open.file = "open.obj";
  EXPECT_THROW(Region(open, folder.path()), InputError);
}

}  // namespace
}  // namespace cairn
