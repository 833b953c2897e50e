// Polygons of files: triangles with all of their corners that cover each point once.
#include "shape/mesh_file/triangulate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "shape/mesh.h"
#include "shape/solid_mesh.h"

namespace cairn {
namespace {

FileSurface polygon(const std::vector<Vec3>& outline) {
  FileSurface surface;
  surface.vertices = outline;
  for (std::uint32_t k = 0; k < outline.size(); ++k) surface.corners.push_back(k);
  surface.end_facet(7);
  return surface;
}

Vec3 vector_area(const std::vector<Vec3>& outline) {
  Vec3 twice = Vec3::Zero();
  for (std::size_t k = 0; k < outline.size(); ++k)
    twice += (outline[k] - outline[0]).cross(outline[(k + 1) % outline.size()] - outline[0]);
  return 0.5 * twice;
}

// Triangles that all turn the polygon's way and whose areas sum to the polygon's cover each point once.
void expect_covered(const std::vector<Vec3>& outline, bool flat = true) {
  const Vec3 whole = vector_area(outline);
  const Triangulation cut = triangulate(polygon(outline), "file");
  ASSERT_EQ(cut.triangles.size(), outline.size() - 2);
  double sum = 0.0;
  for (const auto& [a, b, c] : cut.triangles) {
    EXPECT_TRUE(has_area(outline[a], outline[b], outline[c]));
    const Vec3 part = 0.5 * (outline[b] - outline[a]).cross(outline[c] - outline[a]);
    EXPECT_GT(part.dot(whole), 0.0);
    sum += flat ? part.norm() : part.dot(whole.normalized());
  }
  EXPECT_NEAR(sum / whole.norm(), 1.0, 1e-9);
}

// From each starting corner, turned in space and moved.
void expect_covered_from_everywhere(std::vector<Vec3> outline, std::uint64_t seed, bool flat = true) {
  Random random(seed, 0);
  for (std::size_t start = 0; start < outline.size(); ++start) {
    SCOPED_TRACE(start);
    const Quat turn = random.rotation();
    const Vec3 by = 10.0 * random.direction();
    std::vector<Vec3> placed;
    for (const Vec3& x : outline) placed.push_back(turn * x + by);
    expect_covered(placed, flat);
    std::rotate(outline.begin(), outline.begin() + 1, outline.end());
  }
}

TEST(Triangulate, ConcaveOutlinesFromAnyCorner) {
  expect_covered_from_everywhere({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, 1);  // L
  expect_covered_from_everywhere({{0, 0, 0}, {3, 1, 0}, {0, 2, 0}, {1, 1, 0}}, 2);  // arrow
  std::vector<Vec3> comb, star;
  for (int k = 0; k < 12; ++k) comb.push_back({static_cast<double>(k), k % 2 ? 5.0 : 0.1, 0.0});
  comb.push_back({11, -1, 0});
  comb.push_back({0, -1, 0});
  for (int k = 0; k < 20; ++k)
    star.push_back((k % 2 ? 0.2 : 1.0) * Vec3(std::cos(kPi * k / 10), std::sin(kPi * k / 10), 0.0));
  std::reverse(comb.begin(), comb.end());
  expect_covered_from_everywhere(comb, 3);
  expect_covered_from_everywhere(star, 4);
}

TEST(Triangulate, CornersOnALineMakeNoTriangleWithoutArea) {
  expect_covered_from_everywhere({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, 5);
  expect_covered_from_everywhere({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 2, 0}}, 6);  // a triangle
  std::vector<Vec3> square, edge;
  for (int k = 0; k < 40; ++k) {
    const double t = 0.1 * (k % 10);
    square.push_back(k < 10   ? Vec3(t, 0, 0)
                     : k < 20 ? Vec3(1, t, 0)
                     : k < 30 ? Vec3(1 - t, 1, 0)
                              : Vec3(0, 1 - t, 0));
  }
  expect_covered_from_everywhere(square, 7);
  for (int k = 0; k < 20; ++k) edge.push_back({0.1 * k, 0, 0});
  edge.push_back({1, 1, 0});
  expect_covered_from_everywhere(edge, 8);
}

TEST(Triangulate, RandomOutlines) {
  Random random(9, 0);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const int corners = 4 + static_cast<int>(random.uniform(0.0, 40.0));
    std::vector<Vec3> outline;  // round a point that sees all of it
    for (int k = 0; k < corners; ++k) {
      const double angle = 2.0 * kPi * (k + random.uniform(0.0, 0.9)) / corners;
      outline.push_back(random.uniform(0.05, 1.0) * Vec3(std::cos(angle), std::sin(angle), 0.0));
    }
    if (corners < 7) outline = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, random.uniform(0.1, 0.9), 0}, {0, 2, 0}};
    const Quat turn = random.rotation();
    for (Vec3& x : outline) x = turn * x;
    expect_covered(outline);
  }
}

// A square with a square hole, joined by a cut that is passed twice.
TEST(Triangulate, AHoleBehindACut) {
  expect_covered_from_everywhere({{0, 0, 0},
                                  {3, 0, 0},
                                  {3, 3, 0},
                                  {0, 3, 0},
                                  {0, 0, 0},
                                  {1, 1, 0},
                                  {1, 2, 0},
                                  {2, 2, 0},
                                  {2, 1, 0},
                                  {1, 1, 0}},
                                 10);
}

TEST(Triangulate, BentFacetsAndCoincidentCorners) {
  expect_covered_from_everywhere({{0, 0, 0.1}, {1, 0, -0.1}, {1, 1, 0.1}, {0, 1, -0.1}}, 11, false);
  const Triangulation pole =
      triangulate(polygon({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}), "file");
  EXPECT_EQ(pole.triangles.size(), 1u);
  EXPECT_EQ(triangulate(polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}}), "file").triangles.size(),
            1u);  // flat
  // A convex one is a fan about its first corner.
  const Triangulation fan =
      triangulate(polygon({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}}), "file");
  const std::vector<std::array<std::uint32_t, 3>> expected = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(fan.triangles, expected);
}

TEST(Triangulate, OutlinesThatCrossThemselvesAreRefused) {
  std::vector<Vec3> pentagram;
  for (int k = 0; k < 5; ++k) pentagram.push_back({std::cos(0.8 * kPi * k), std::sin(0.8 * kPi * k), 0.0});
  const std::vector<Vec3> bow = {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}},
                          lopsided = {{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 1, 0}},
                          twice = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const auto& outline : {pentagram, bow, lopsided, twice}) {
    try {
      triangulate(polygon(outline), "file");
      ADD_FAILURE() << outline.size();
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("file:7: facet 1 of the file has ")) << error.what();
    }
  }
}

// A solid with concave caps, the first corner of both at each of their six places.
TEST(Triangulate, PrismOnAnL) {
  for (std::uint32_t start = 0; start < 6; ++start) {
    std::string text =
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 "
        "1\nv 0 2 1\n";
    std::string low = "f", high = "f";
    for (std::uint32_t k = 0; k < 6; ++k) {
      low += fmt::format(" {}", 1 + (start + 6 - k) % 6);
      high += fmt::format(" {}", 7 + (start + k) % 6);
      text += fmt::format("f {} {} {} {}\n", 1 + k, 1 + (k + 1) % 6, 7 + (k + 1) % 6, 7 + k);
    }
    text += low + '\n' + high + '\n';
    const TriangleMesh mesh = parse_mesh(text, "obj", "file", 1.0);
    double area = 0.0;
    for (const auto& [a, b, c] : mesh.triangles)
      area += 0.5 * (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
    EXPECT_NEAR(area, 14.0, 1e-12);
    EXPECT_NEAR(mass_of(make_solid(mesh).surface).volume, 3.0, 1e-12);
  }
}

}  // namespace
}  // namespace cairn
