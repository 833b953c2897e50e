// Which meshes bound a solid, and the mass properties of those that do.
#include "shape/solid_mesh.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <filesystem>

#include "core/error.h"
#include "core/random.h"
#include "core/safe_file.h"
#include "folder.h"
#include "models.h"
#include "shape/self_crossing.h"

namespace cairn {
namespace {

constexpr double kHuge = 1e9;

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [x, y, z] : b.triangles) a.triangles.push_back({first + x, first + y, first + z});
  return a;
}

TriangleMesh moved(TriangleMesh mesh, const Quat& turn, const Vec3& by, double scale = 1.0) {
  for (Vec3& x : mesh.vertices) x = turn * (scale * x) + by;
  return mesh;
}

TriangleMesh inverted(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::string complaint(const TriangleMesh& mesh) {
  try {
    make_solid(mesh);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

void expect_complaint(const TriangleMesh& mesh, const std::string& words) {
  const std::string what = complaint(mesh);
  EXPECT_NE(what.find(words), std::string::npos) << what << " instead of " << words;
  EXPECT_EQ(what.find('\n'), std::string::npos);
}

TEST(MassOfMesh, ClosedForms) {
  const MassProperties cube = mass_of(models::cube());
  EXPECT_NEAR(cube.volume, 1.0, 1e-15);
  EXPECT_NEAR(cube.centroid.norm(), 0.0, 1e-15);
  EXPECT_NEAR((cube.inertia - Mat3::Identity() / 6.0).norm(), 0.0, 1e-15);

  const MassProperties tetrahedron = mass_of(models::tetrahedron());
  const double volume = 1.0 / (6.0 * std::sqrt(2.0));
  EXPECT_NEAR(tetrahedron.volume, volume, 1e-15);
  EXPECT_NEAR((tetrahedron.inertia - volume / 20.0 * Mat3::Identity()).norm(), 0.0, 1e-15);

  // A polyhedron with its vertices on an ellipsoid: the image of one in a ball, and nearly the ellipsoid.
  const Vec3 a(3.0, 2.0, 0.5);
  const MassProperties ball = mass_of(models::ball(12)), ellipsoid = mass_of(models::ellipsoid(a, 12));
  EXPECT_NEAR(ellipsoid.volume, a.prod() * ball.volume, 1e-13);
  EXPECT_NEAR(ball.volume, 4.0 / 3.0 * kPi, 0.04);
  const double second = 0.5 * ball.inertia(0, 0) * a.prod();
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(ellipsoid.inertia(k, k), second * (a.squaredNorm() - a[k] * a[k]), 1e-12);
  EXPECT_NEAR((equivalent_ellipsoid(ellipsoid) - std::cbrt(ball.volume / (4.0 / 3.0 * kPi)) * a).norm(), 0.0,
              1e-12);
}

TEST(MassOfMesh, MovesAndTurnsWithTheMeshAlsoFarAway) {
  Random random(3, 0);
  const TriangleMesh mesh = models::boulder(2);
  const MassProperties mass = mass_of(mesh);
  for (const double far : {0.0, 1.0, kHuge}) {
    const Quat turn = random.rotation();
    const Vec3 by = far * random.direction();
    const MassProperties other = mass_of(moved(mesh, turn, by, 2.0));
    const double rounding = 1e-13 + 4e-16 * far;  // of the coordinates themselves
    EXPECT_NEAR(other.volume / (8.0 * mass.volume), 1.0, rounding);
    EXPECT_NEAR((other.centroid - (turn * (2.0 * mass.centroid) + by)).norm(), 0.0, rounding);
    const Mat3 r = turn.toRotationMatrix();
    EXPECT_NEAR((other.inertia / 32.0 - r * mass.inertia * r.transpose()).norm() / mass.inertia.norm(), 0.0,
                rounding);
  }
}

TEST(MassOfMesh, PrincipalFrame) {
  Random random(4, 0);
  const TriangleMesh mesh = moved(models::boulder(4), random.rotation(), {5, 6, 7});
  const MassProperties before = mass_of(mesh), after = mass_of(in_principal_frame(mesh, before));
  EXPECT_NEAR(after.volume, before.volume, 1e-13);
  EXPECT_NEAR(after.centroid.norm(), 0.0, 1e-14);
  const Mat3 rest = after.inertia - Mat3(after.inertia.diagonal().asDiagonal());
  EXPECT_NEAR(rest.norm(), 0.0, 1e-14);
  EXPECT_LE(after.inertia(0, 0), after.inertia(1, 1));
  EXPECT_LE(after.inertia(1, 1), after.inertia(2, 2));
  EXPECT_GT(make_solid(in_principal_frame(mesh, before)).surface.triangles.size(), 0u);
}

TEST(MassOfMesh, RealMeshesHaveTheirKnownFigures) {
  const std::filesystem::path folder = CAIRN_REAL_MESHES;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real meshes beside the repository";
  struct Known {
    const char* file;
    double volume;
    Vec3 moments, axes;  // per unit volume; full
  };
  const Known known[] = {
      {"didymos_dart_spc_v003_12288.obj",
       0.2031889,
       {0.04869, 0.052306, 0.0653695},
       {0.82949, 0.78481, 0.5961}},
      {"didymos_radar_1996.obj", 2.485482e8, {59946.3, 61039.8, 62703.8}, {796.54, 782.77, 761.33}},
      {"dimorphos_dart_spc_v003_3072.obj",
       0.001800115,
       {0.0021415, 0.00217687, 0.00302841},
       {0.17501, 0.17298, 0.11356}},
      {"itokawa_hayabusa_5430.obj",
       0.01774547,
       {0.00630609, 0.0213259, 0.0224198},
       {0.58898, 0.26185, 0.21976}},
      {"chrono_offroad_rock1.obj", 10.58429, {0.723809, 0.76467, 1.15368}, {3.4074, 3.2887, 1.8039}},
      {"chrono_offroad_rock2.obj", 7.56781, {0.385605, 1.10228, 1.28501}, {4.4003, 2.3447, 1.4009}},
      {"chrono_rock1.obj", 0.4557577, {0.0852097, 0.093619, 0.138195}, {1.2067, 1.1354, 0.6353}},
      {"ibois_stone_0.ply", 0.00166602, {0.00176016, 0.00320736, 0.00405776}, {0.22484, 0.15483, 0.091402}},
      {"particlepack_grain39.stl", 0.5236234, {0.0893228, 0.102905, 0.117484}, {1.1415, 1.0163, 0.86201}},
  };
  for (const Known& k : known) {
    SCOPED_TRACE(k.file);
    const SolidMesh solid = load_solid(folder / k.file, 1.0);
    const MassProperties mass = mass_of(solid.surface);
    // The figures have six or seven digits: half of the last one, and 1e-6.
    EXPECT_NEAR(mass.volume / k.volume, 1.0, 1.3e-6);
    Mat3 inertia = mass.inertia / mass.volume;
    Eigen::SelfAdjointEigenSolver<Mat3> solver(inertia);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(solver.eigenvalues()[i] / k.moments[i], 1.0, 5e-6);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(2.0 * equivalent_ellipsoid(mass)[i] / k.axes[i], 1.0, 7e-5);
    EXPECT_EQ(solid.cavities, 0u);
  }
}

TEST(SolidMesh, SoundOnesPassUnchanged) {
  for (const auto& [file, mesh] : models::all()) {
    SCOPED_TRACE(file);
    for (const double far : {0.0, 1e6}) {
      const SolidMesh solid = make_solid(moved(mesh, Quat::Identity(), Vec3::Constant(far)));
      EXPECT_EQ(solid.surface.triangles, mesh.triangles);
      EXPECT_TRUE(solid.repairs.empty());
      EXPECT_EQ(solid.cavities, 0u);
    }
  }
}

TEST(SolidMesh, TrianglesThatFaceInwardsAreTurned) {
  const TriangleMesh mesh = models::boulder(1);
  const SolidMesh all = make_solid(inverted(mesh));
  EXPECT_NEAR(mass_of(all.surface).volume, mass_of(mesh).volume, 1e-14);
  ASSERT_EQ(all.repairs.size(), 1u);
  EXPECT_TRUE(all.repairs[0].starts_with("turned 720 facets that faced inwards, the first is facet 1 at"));
  TriangleMesh some = mesh;
  for (std::size_t t = 10; t < 200; t += 3) std::swap(some.triangles[t][0], some.triangles[t][1]);
  const SolidMesh repaired = make_solid(some);
  EXPECT_NEAR(mass_of(repaired.surface).volume, mass_of(mesh).volume, 1e-14);
  EXPECT_TRUE(
      repaired.repairs[0].starts_with("turned 64 facets that faced inwards, the first is facet 11 at"))
      << repaired.repairs[0];
}

TEST(SolidMesh, NeighboursAreAcrossTheEdges) {
  const SolidMesh solid = make_solid(inverted(models::boulder(3)));
  const auto& triangles = solid.surface.triangles;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto& other = triangles[solid.neighbours[t][k]];
      bool runs_back = false;
      for (std::uint32_t j = 0; j < 3; ++j)
        runs_back =
            runs_back || (other[j] == triangles[t][(k + 1) % 3] && other[(j + 1) % 3] == triangles[t][k]);
      EXPECT_TRUE(runs_back) << t << ' ' << k;
    }
}

TEST(SolidMesh, CavitiesCountNegative) {
  const TriangleMesh block = models::cube(),
                     hole = moved(models::cube(), Quat::Identity(), Vec3::Zero(), 0.5);
  for (const TriangleMesh& mesh :
       {joined(block, hole), joined(hole, block), joined(inverted(block), inverted(hole))}) {
    const SolidMesh solid = make_solid(mesh);
    EXPECT_EQ(solid.cavities, 1u);
    EXPECT_NEAR(mass_of(solid.surface).volume, 0.875, 1e-14);
  }
  const SolidMesh outwards = make_solid(joined(block, hole));
  ASSERT_EQ(outwards.repairs.size(), 1u);
  EXPECT_TRUE(
      outwards.repairs[0].starts_with("took shells inside another as cavities: turned 12 facets that faced "
                                      "out of them, the first is facet 13"))
      << outwards.repairs[0];
  const SolidMesh inwards = make_solid(joined(inverted(block), inverted(hole)));
  ASSERT_EQ(inwards.repairs.size(), 1u);
  EXPECT_TRUE(inwards.repairs[0].starts_with("turned 12 facets that faced inwards, the first is facet 1 "))
      << inwards.repairs[0];
  const TriangleMesh core = moved(models::cube(), Quat::Identity(), Vec3::Zero(), 0.2);
  expect_complaint(joined(joined(block, hole), core), "separate parts");
}

TEST(SolidMesh, BrokenOnesAreRefusedWithTheirFirstOffendingFacet) {
  const TriangleMesh cube = models::cube();
  expect_complaint({}, "found no triangle");
  TriangleMesh open = cube;
  open.triangles.erase(open.triangles.begin() + 4);
  expect_complaint(
      open,
      "not closed: an edge of facet 2 at (0.166667, -0.166667, -0.5) has no other facet (3 such edges)");
  TriangleMesh fin = cube;
  fin.vertices.push_back({2, 2, 2});
  fin.triangles.push_back({0, 1, 8});
  fin.triangles.push_back({1, 0, 8});
  expect_complaint(fin, "not a manifold: an edge of facet 2 at");
  TriangleMesh nan = cube;
  nan.vertices[3].y() = std::nan("");
  expect_complaint(nan, "facet 1 has a vertex that is not finite");
  TriangleMesh missing = cube;
  missing.triangles[6][1] = 99;
  expect_complaint(missing, "facet 7 has a vertex that does not exist");
  TriangleMesh twice = cube;
  twice.triangles[6][1] = twice.triangles[6][0];
  expect_complaint(twice, "the same vertex twice");

  const TriangleMesh beside = moved(cube, Quat::Identity(), {3, 0, 0});
  expect_complaint(joined(cube, beside), "separate parts; one of them begins with facet 13 at");
  // Two cubes with one corner in common, once welded.
  const TriangleMesh corner = weld(joined(cube, moved(cube, Quat::Identity(), {1, 1, 1})), 1e-9);
  expect_complaint(corner, "touches others at a single vertex");
  const TriangleMesh edge = weld(joined(cube, moved(cube, Quat::Identity(), {1, 1, 0})), 1e-9);
  expect_complaint(edge, "belongs to more than two facets");

  // A strip with half a twist, closed by a cap on its single rim: no such surface without crossings bounds a
  // solid, and it has one side.
  TriangleMesh band;
  const std::uint32_t n = 12;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double a = 2.0 * kPi * k / n;
    for (const double s : {-0.3, 0.3})
      band.vertices.push_back({(1 + s * std::cos(a / 2)) * std::cos(a),
                               (1 + s * std::cos(a / 2)) * std::sin(a), s * std::sin(a / 2)});
  }
  band.vertices.push_back({0, 0, 5});
  for (std::uint32_t k = 0; k < n; ++k) {
    const bool last = k + 1 == n;
    const std::uint32_t a = 2 * k, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    band.triangles.insert(band.triangles.end(), {{a, b, d}, {a, d, c}, {a, c, 2 * n}, {b, d, 2 * n}});
  }
  expect_complaint(band, "one-sided");

  TriangleMesh flat = models::tetrahedron();
  for (Vec3& x : flat.vertices) x.z() *= 1e-14;
  expect_complaint(flat, "encloses no volume");
}

TEST(SolidMesh, CrossingsAreFound) {
  const TriangleMesh cube = models::cube();
  Random random(8, 0);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE(trial);
    const Vec3 by = random.uniform(0.2, 0.9) * random.direction();
    expect_complaint(joined(cube, moved(cube, random.rotation(), by)), "crosses itself: facet ");
  }
  expect_complaint(joined(cube, moved(cube, Quat::Identity(), {0.5, 0.5, 0.0})), "crosses itself");
  // One vertex pushed through the opposite side.
  TriangleMesh ball = models::ball(4);
  ball.vertices[7] *= -1.5;
  expect_complaint(ball, "crosses itself");
  ball.vertices[7] *= -0.5 / 1.5;
  EXPECT_EQ(complaint(ball), "none");
}

// Two cones of n facets each, base to base.
TriangleMesh lens(std::uint32_t n) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t k = 0; k < n; ++k) {
    const double a = 2.0 * kPi * k / n;
    mesh.vertices.push_back({10 * std::cos(a), 10 * std::sin(a), 0});
    const std::uint32_t next = 2 + (k + 1) % n;
    mesh.triangles.push_back({0, k + 2, next});
    mesh.triangles.push_back({1, next, k + 2});
  }
  return mesh;
}

// A disk of height 1 whose faces are fans about one vertex of their rims, which has number 0 or 1.
TriangleMesh disk(std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double a = 2.0 * kPi * k / n;
    for (const double z : {0.0, 1.0}) mesh.vertices.push_back({10 * std::cos(a), 10 * std::sin(a), z});
    const std::uint32_t low = 2 * k, next = 2 * ((k + 1) % n);
    mesh.triangles.push_back({low, next, next + 1});
    mesh.triangles.push_back({low, next + 1, low + 1});
    if (k == 0 || next == 0) continue;
    mesh.triangles.push_back({0, next, low});
    mesh.triangles.push_back({1, low + 1, next + 1});
  }
  return mesh;
}

TEST(SolidMesh, CrossingsAreFoundWhereManyFacetsMeet) {
  EXPECT_EQ(complaint(lens(1000)), "none");
  TriangleMesh one_in = lens(1000);  // a vertex of the rim moved through the fans
  one_in.vertices[102] = Vec3(-5, 1, 3);
  expect_complaint(one_in, "crosses itself: facet ");
  // The tip of one cone through the other.
  TriangleMesh tip = lens(1000);
  tip.vertices[0] = Vec3(5, 0, -0.7);
  expect_complaint(tip, "crosses itself: facet ");
  // Something small through a facet of each fan.
  for (const double z : {0.5, -0.5}) {
    const TriangleMesh needle = moved(models::tetrahedron(), Quat::Identity(), {5, 0.01, z}, 0.5);
    expect_complaint(joined(lens(1000), needle), "crosses itself: facet ");
  }
}

// The same by a look at every edge and every triangle.
std::optional<std::pair<std::uint32_t, std::uint32_t>> crossing_of_all(const TriangleMesh& mesh) {
  std::optional<std::pair<std::uint32_t, std::uint32_t>> first;
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).dot((c - a).cross(d - a));
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  for (std::uint32_t s = 0; s < count; ++s)
    for (std::uint32_t t = 0; t < count; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = mesh.triangles[s][k], to = mesh.triangles[s][(k + 1) % 3];
        const auto& [a, b, c] = mesh.triangles[t];
        if (from == a || from == b || from == c || to == a || to == b || to == c) continue;
        const Vec3 &p = mesh.vertices[from], &q = mesh.vertices[to], &x = mesh.vertices[a],
                   &y = mesh.vertices[b], &z = mesh.vertices[c];
        const double xy = volume(p, q, x, y), yz = volume(p, q, y, z), zx = volume(p, q, z, x);
        const bool passes = (xy > 0.0) == (yz > 0.0) && (yz > 0.0) == (zx > 0.0);
        const double area = (y - x).cross(z - x).norm();
        const double above = volume(x, y, z, p) / area, below = volume(x, y, z, q) / area;
        if (passes && std::min(above, below) < -1e-7 && std::max(above, below) > 1e-7)
          first =
              std::min(first.value_or(std::pair{count, count}), std::pair(std::min(s, t), std::max(s, t)));
      }
  return first;
}

TEST(SolidMesh, CrossingsAreThoseOfEveryEdgeAndTriangle) {
  Random random(11, 0);
  int crossings = 0;
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    SolidMesh solid = make_solid(trial % 2 == 0 ? lens(150) : disk(150));
    const auto vertex = static_cast<std::size_t>(random.uniform(0.0, 150.0));
    solid.surface.vertices[trial % 5 == 0 ? vertex % 2 : vertex] +=
        random.uniform(0.0, 3.0) * random.direction();
    const auto expected = crossing_of_all(solid.surface);
    EXPECT_EQ(find_crossing(solid.surface, solid.neighbours), expected);
    crossings += expected.has_value();
  }
  EXPECT_GT(crossings, 10);
  EXPECT_LT(crossings, 40);
}

TEST(SolidMesh, ManyFacetsAroundAVertexAreNoQuestionOfTime) {
  EXPECT_EQ(make_solid(lens(200'000)).surface.triangles.size(), 400'000u);  // each with each: hours
}

TEST(SolidMesh, FilesTellWhatWasRepaired) {
  const Folder folder;
  const std::string path = (folder / "rock.obj").string();
  TriangleMesh mesh = inverted(models::boulder(5));
  mesh.vertices.push_back(mesh.vertices[0] + Vec3(3e-7, 0, 0));  // in place of vertex 0 in its first triangle
  for (auto& t : mesh.triangles)
    if (t[0] == 0) {
      t[0] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
      break;
    }
  mesh.triangles.push_back(mesh.triangles[9]);
  mesh.triangles.push_back({5, 5, 6});
  write_file(path, obj_text(mesh, 0.5), true);
  const SolidMesh solid = load_solid(path, 0.5);
  EXPECT_NEAR(mass_of(solid.surface).volume, mass_of(models::boulder(5)).volume, 1e-6);
  ASSERT_EQ(solid.repairs.size(), 4u);
  EXPECT_TRUE(solid.repairs[0].starts_with("turned 720 facets"));
  EXPECT_TRUE(solid.repairs[1].starts_with("joined vertices up to")) << solid.repairs[1];
  EXPECT_EQ(solid.repairs[2], "left out 1 facets without area");
  EXPECT_EQ(solid.repairs[3], "left out 1 copies of facets");
  // Facets keep the numbers that they have in the file: the first is flat and left out.
  TriangleMesh open = models::cube();
  open.triangles.insert(open.triangles.begin(), {0, 0, 1});
  open.triangles.pop_back();
  write_file(path, obj_text(open), true);
  try {
    load_solid(path, 1.0);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_TRUE(
        std::string(error.what()).starts_with(path + ":12: not closed: an edge of facet 4 of the file at"))
        << error.what();
  }
  // Polygons count as one, as in the file.
  const std::string block =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n";
  const SolidMesh turned = load_solid(folder.write("quads.obj", block + "f 1 4 8 5\nf 1 5 8 4\n"), 1.0);
  EXPECT_EQ(turned.facets, 6u);
  ASSERT_EQ(turned.repairs.size(), 2u);
  EXPECT_TRUE(
      turned.repairs[0].starts_with("turned 1 facets that faced inwards, the first is facet 6 of the file"))
      << turned.repairs[0];
  EXPECT_EQ(turned.repairs[1], "left out 1 copies of facets");
}

TEST(SolidMesh, AMillionFacets) {
  const SolidMesh solid = make_solid(models::ball(224));
  EXPECT_EQ(solid.surface.triangles.size(), 1003520u);
  EXPECT_NEAR(mass_of(solid.surface).volume, 4.0 / 3.0 * kPi, 1e-4);
}

}  // namespace
}  // namespace cairn
