// Tables of numbers that shape models of asteroids come as.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "shape/mesh.h"
#include "shape/solid_mesh.h"

namespace cairn {
namespace {

MassProperties mass_of_table(const std::string& text, Welding* welding = nullptr) {
  return mass_of(make_solid(parse_mesh(text, "tab", "file", 1.0, welding)).surface);
}

void expect_error(const std::string& text, const std::string& start) {
  try {
    parse_mesh(text, "txt", "file", 1.0);
    ADD_FAILURE() << start;
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(start)) << error.what() << "\n  instead of " << start;
  }
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

// A tetrahedron of volume 2.
const char* const kPoints[] = {"0.0 0.0 0.0", "2.0 0.0 0.0", "0.0 2.0 0.0", "0.0 0.0 3.0"};
const std::array<int, 3> kFacets[] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

// `head` and `middle` before vertices and facets, which count from `base` and have their numbers if `own`.
std::string table(const std::string& head, const std::string& middle, int base, bool own,
                  const char* count = "") {
  std::string text = head;
  for (int v = 0; v < 4; ++v)
    text += own ? fmt::format("{:5} {}\n", base + v, kPoints[v]) : fmt::format("{}\n", kPoints[v]);
  text += middle;
  for (int f = 0; f < 4; ++f) {
    const auto& [a, b, c] = kFacets[f];
    text += fmt::format("{}{}{} {} {}\n", own ? fmt::format("{:5} ", base + f) : "", count, base + a,
                        base + b, base + c);
  }
  return text;
}

TEST(NumberTable, PlateModels) {
  const std::string plates = table("           4           4\n", "", 1, false),
                    naif = table("4\n", "4\n", 1, true);
  for (const std::string& text :
       {plates, naif, table("4 4\n", "", 0, false), table("4\n", "4\n", 0, true), table("4 4\n", "", 1, true),
        table("4\n", "4\n", 1, false), table("4 4\n", "", 1, false, "3 "),
        table("4 4\n", "", 1, false, "3\n"), replaced(plates, "\n", "\r\n"),
        replaced(plates, "2.0", "2.0D+00"), "# a comment\n\n" + naif,
        replaced(replaced(table("4 4\n", "\n", 1, false), " ", ","), ",,", ","),
        replaced(naif, "3.0", "+3.")}) {
    SCOPED_TRACE(text);
    EXPECT_DOUBLE_EQ(mass_of_table(text).volume, 2.0);
  }
  expect_error(plates.substr(0, plates.size() - 6),
               "file:8: 4 vertices and 4 facets are promised, the file ends after 4 and 3");
  expect_error(plates + "1 2 3\n", "file:10: expected the end of the file after 4 vertices and 4 facets");
  expect_error(replaced(plates, "2.0 0.0 0.0", "2.0 0.0"), "file:3: expected a vertex of 3 numbers, found 2");
  expect_error(replaced(plates, "2.0 0.0 0.0", "2.0 0.0 0.0 1"),
               "file:3: expected a vertex of 3 numbers, found 4");
  expect_error(replaced(plates, "2.0 0.0 0.0", "2.0 x 0.0"), "file:3: expected a number, found 'x'");
  expect_error(replaced(plates, "2.0 0.0 0.0", "2.0,0.0 0.0"), "file:3: expected commas between all numbers");
  expect_error(replaced(plates, "2.0 0.0 0.0", "1,000.0 2,000.0 3"),
               "file:3: expected commas between all numbers");
  expect_error(replaced(plates, "2 3 4", "2 3 5"),
               "file:9: corner 5: expected one of the 4 vertices, counted from 1");
  expect_error(replaced(plates, "2 3 4", "2 3.5 4"), "file:9: expected a corner, found 3.5");
  expect_error(replaced(plates, "2 3 4", "2 -3 4"), "file:9: expected a corner, found -3");
  expect_error(replaced(plates, "2 3 4", "0 3 4"), "file:9: corner 0: expected vertices counted from 1");
  expect_error(replaced(naif, "    2 2.0", "    3 2.0"), "file:3: expected vertex 2, found number 3");
  expect_error(replaced(naif, "    4 2 3 4", "    5 2 3 4"), "file:10: expected facet 4, found number 5");
  expect_error(naif.substr(0, naif.size() - 12),
               "file:9: 4 vertices and 4 facets are promised, the file ends after 4 and 3");
  expect_error("4 4 4 4\n0 0 0 0\n", "file:2: expected counts, or a grid of latitudes");
}

// A body on the rays of a grid, which no symmetry turns into another.
double radius(double latitude, double longitude) {
  return 2.0 + 0.3 * std::sin(latitude) +
         std::cos(latitude) * (0.5 * std::cos(longitude) + 0.2 * std::sin(2.0 * longitude));
}

// Rows of a grid at steps of `step` degrees, longitudes from `first` to `last`.
std::string grid(double step, double first, double last, bool longitude_first, const std::string& more = "") {
  std::string text;
  for (double latitude = -90.0; latitude <= 90.0; latitude += step)
    for (double longitude = first; longitude <= last; longitude += step) {
      const double r = radius(latitude * kPi / 180.0, longitude * kPi / 180.0);
      const double pole = std::abs(latitude) == 90.0 ? 2.0 + 0.3 * latitude / 90.0 : r;
      text += longitude_first ? fmt::format("{:5} {:5} {:.12f}{}\n", longitude, latitude, pole, more)
                              : fmt::format("{:9.4f} {:9.4f} {:.12f}{}\n", latitude, longitude, pole, more);
    }
  return text;
}

TEST(NumberTable, GridsOfRadii) {
  Welding welding;
  const MassProperties mass = mass_of_table(grid(2.0, 0.0, 360.0, false), &welding);
  ASSERT_EQ(welding.notes.size(), 1u);
  EXPECT_NE(welding.notes[0].find("west"), std::string::npos);
  // Volume and centroid by quadrature over directions; longitudes run west.
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const double z = -1.0 + (i + 0.5) * 2.0 / n, longitude = (j + 0.5) * kPi / n;
      const double r = radius(std::asin(z), longitude), across = std::sqrt(1.0 - z * z),
                   part = 2.0 / n * kPi / n;
      volume += part * r * r * r / 3.0;
      first +=
          part * r * r * r * r / 4.0 * Vec3(across * std::cos(longitude), -across * std::sin(longitude), z);
    }
  EXPECT_NEAR(mass.volume / volume, 1.0, 2e-3);
  EXPECT_NEAR((mass.centroid - first / volume).norm(), 0.0, 3e-3);
  // The same body whichever way it is written.
  for (const std::string& text :
       {grid(2.0, 0.0, 358.0, false), grid(2.0, -180.0, 178.0, false), grid(2.0, -180.0, 180.0, true),
        grid(2.0, 0.0, 360.0, true), grid(2.0, 0.0, 360.0, false, " 1 2 3"),
        replaced(grid(2.0, 0.0, 360.0, false), "\n", " \r\n")}) {
    const MassProperties other = mass_of_table(text);
    EXPECT_NEAR(other.volume / mass.volume, 1.0, 1e-9);
    EXPECT_NEAR((other.centroid - mass.centroid).norm(), 0.0, 1e-9);
    EXPECT_NEAR((other.inertia - mass.inertia).norm(), 0.0, 1e-8);
  }
}

// Facets tell which way longitudes run.
TEST(NumberTable, PlatesWithVerticesAtLatitudesAndLongitudes) {
  enum class Kind { places, east, west, longitude_first };
  const auto plates = [](Kind kind) {
    constexpr int rows = 13, ring = 24;
    std::string vertices, facets;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < ring; ++j) {
        const double latitude = -90.0 + 15.0 * i, longitude = 15.0 * j, phi = latitude * kPi / 180.0,
                     lambda = longitude * kPi / 180.0;
        const double r = i % (rows - 1) == 0 ? 2.0 : radius(phi, lambda);
        if (kind == Kind::places)
          vertices += fmt::format("{:.15g} {:.15g} {:.15g}\n", r * std::cos(phi) * std::cos(lambda),
                                  r * std::cos(phi) * std::sin(lambda), r * std::sin(phi));
        else if (kind == Kind::longitude_first)
          vertices += fmt::format("{} {} {:.15g}\n", longitude, latitude, r);
        else
          vertices +=
              fmt::format("{} {} {:.15g}\n", latitude, kind == Kind::west ? 360.0 - longitude : longitude, r);
        if (i + 1 == rows) continue;
        const int a = i * ring + j + 1, b = i * ring + (j + 1) % ring + 1;
        facets += fmt::format("{} {} {}\n{} {} {}\n", a, b, b + ring, a, b + ring, a + ring);
      }
    return fmt::format("{} {}\n{}{}", rows * ring, 2 * (rows - 1) * ring, vertices, facets);
  };
  const MassProperties mass = mass_of_table(plates(Kind::places));
  EXPECT_GT(mass.centroid.norm(), 0.1);
  for (const Kind kind : {Kind::east, Kind::west, Kind::longitude_first}) {
    Welding welding;
    const MassProperties other = mass_of_table(plates(kind), &welding);
    EXPECT_NEAR(other.volume / mass.volume, 1.0, 1e-12);
    EXPECT_NEAR((other.centroid - mass.centroid).norm(), 0.0, 1e-12);
    EXPECT_NEAR((other.inertia - mass.inertia).norm(), 0.0, 1e-11);
    ASSERT_EQ(welding.notes.size(), 1u);
    EXPECT_NE(welding.notes[0].find(kind == Kind::west ? "run west" : "run east"), std::string::npos);
  }
}

TEST(NumberTable, GridsThatAreNotWholeAreRefused) {
  const std::string whole = grid(30.0, 0.0, 330.0, false);
  EXPECT_GT(mass_of_table(whole).volume, 30.0);
  const auto without = [&](std::size_t line) {
    std::size_t begin = 0;
    for (std::size_t k = 1; k < line; ++k) begin = whole.find('\n', begin) + 1;
    return whole.substr(0, begin) + whole.substr(whole.find('\n', begin) + 1);
  };
  expect_error(without(30), "file:83: no radius for latitude -30, longitude 150");
  expect_error(whole.substr(0, whole.find("\n  90.0000") + 1),
               "file:72: expected counts, or a grid of latitudes");
  expect_error(whole + "-90 0 1.7\n", "file:85: latitude -90, longitude 0 for a second time");
  expect_error(replaced(whole, " -90.0000   30.0000 1.7", " -90.0000   30.0000 1.8"),
               "file:2: expected the radius 1.7 as before");
  expect_error(replaced(whole, "   0.0000   30.0000 2", "   0.0000   30.0000 -2"),
               "file:38: expected a positive radius");
  expect_error(grid(30.0, 0.0, 270.0, false),
               "file:70: expected longitudes all round, found none between 270 and 360");
  expect_error(replaced(whole, "  60.0000", "  50.0000"),
               "file:84: expected latitudes at steps of 30 degrees");
  expect_error("1 2 3\n4 5 6\n", "file:2: expected counts, or a grid of latitudes");
  expect_error("1 2 3\n4 5\n", "file:2: expected 3 numbers as in the lines before, found 2");
}

// A cube of edge 2 in Gaskell's order: six faces of (Q + 1)^2 points.
std::string cube_grid(int q) {
  std::string text = fmt::format("{}\n", q);
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j <= q; ++j)
      for (int i = 0; i <= q; ++i) {
        double x[3];
        x[face % 3] = face < 3 ? 1.0 : -1.0;
        x[(face + 1) % 3] = 2.0 * i / q - 1.0;
        x[(face + 2) % 3] = 2.0 * j / q - 1.0;
        text += fmt::format("{:12.5f}{:12.5f}{:12.5f}\n", x[0], x[1], x[2]);
      }
  return text;
}

TEST(NumberTable, GridsOnACube) {
  for (const int q : {1, 2, 5}) {
    const TriangleMesh mesh = parse_mesh(cube_grid(q), "txt", "file", 1.0);
    EXPECT_EQ(mesh.triangles.size(), 12u * q * q);
    EXPECT_EQ(mesh.vertices.size(), 6u * q * q + 2);
    EXPECT_NEAR(mass_of(make_solid(mesh).surface).volume, 8.0, 1e-12);
  }
  const std::string grid = cube_grid(4);
  expect_error(grid.substr(0, grid.rfind("\n", grid.size() - 2) + 1),
               "file:6: expected the number of facets after 4 vertices (or 6 x 5");
}

}  // namespace
}  // namespace cairn
