// What each format's reader takes, what it refuses, and the line that it names.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "shape/mesh.h"
#include "shape/solid_mesh.h"

namespace cairn {
namespace {

double volume_of(const std::string& kind, const std::string& text) {
  return mass_of(make_solid(parse_mesh(text, kind, "file", 1.0)).surface).volume;
}

std::string error_of(const std::string& kind, const std::string& text) {
  try {
    parse_mesh(text, kind, "file", 1.0);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void expect_error(const std::string& kind, const std::string& text, const std::string& start) {
  const std::string error = error_of(kind, text);
  EXPECT_TRUE(error.starts_with(start)) << error << "\n  instead of " << start;
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

// A cube of edge 2 whose vertices are written by `vertex`.
template <class Vertex>
std::string obj_cube(const Vertex& vertex) {
  std::string text;
  for (int k = 0; k < 8; ++k) text += vertex((k & 1) * 2.0, (k >> 1 & 1) * 2.0, (k >> 2 & 1) * 2.0) + '\n';
  return text;
}
const char* const kQuads = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
std::string plain(double x, double y, double z) {
  return fmt::format("v {} {} {}", x, y, z);
}
const std::string kCube = obj_cube(plain) + kQuads;

TEST(ObjFile, SpellingsOfOneCube) {
  const auto with = [&](const char* format) {
    return obj_cube(
               [&](double x, double y, double z) { return fmt::format(fmt::runtime(format), x, y, z); }) +
           kQuads;
  };
  const std::vector<std::pair<const char*, std::string>> cubes = {
      {"plain", kCube},
      {"weights", with("v {} {} {} 0.5")},
      {"colours", with("v {} {} {} 0.1 0.2 0.3")},
      {"colours with alpha", with("v {} {} {} 0.1 0.2 0.3 1")},
      {"a zero as weight", with("v {} {} {} 0")},
      {"plus signs", with("v +{} +{} +{:.3f}")},
      {"exponents", with("v {}e0 {}E+00 {:.1f}e-0")},
      {"Fortran's exponents", with("v {:.3f}D+00 {:.3f}d0 {:.3f}D-00")},
      {"points without digits after", with("v {}. {}. {}.")},
      {"CR LF", replaced(kCube, "\n", "\r\n")},
      {"CR", replaced(kCube, "\n", "\r")},
      {"tabs and blanks", replaced(replaced(kCube, " ", "\t  "), "\n", " \t\n\n")},
      {"indented", replaced(kCube, "\n", "\n   ")},
      {"comments", "# a cube\n#\n" + replaced(kCube, "\n", " # v 1 2 3\n")},
      {"comment that ends in a backslash", "# C:\\meshes\\\n" + kCube},
      {"byte order mark", "\xEF\xBB\xBF" + kCube},
      {"no line end at the end", kCube.substr(0, kCube.size() - 1)},
      {"goes on", replaced(kCube, "f 1 3 4 2", "f 1 3 \\\n 4\\\r\n2")},
      {"an unused vertex", replaced(kCube, "f 1 3 4 2", "v 9 9 9\nf 1 3 4 2")},
      {"facets before vertices", kQuads + obj_cube(plain)},
      {"from the end", replaced(replaced(kCube, "f 1 3 4 2", "f -8 -6 -5 -7"), "f 2 4 8 6", "f 2 -5 8 -3")},
      {"counted from 0",
       obj_cube(plain) + "f 0 2 3 1\nf 4 5 7 6\nf 0 1 5 4\nf 2 6 7 3\nf 0 4 6 2\nf 1 3 7 5\n"},
      {"textures and normals",
       "vt 0 0\nvt 1\nvt 0 0 0\nvn 0 0 1\nvn nan nan nan\n" +
           replaced(replaced(kCube, "f 1 3 4 2", "f 1/1 3/2 4/3 2/1"), "f 2 4 8 6", "f 2//1 4/1/1 8// 6/")},
      {"groups and materials",
       "mtllib a b.mtl\no cube #1\ng a b\ns off\nusemtl x\ns 1\n" + kCube + "l 1 2 3\np 4\nusemtl\n"},
      {"in a table's file", kCube}};
  for (const auto& [what, text] : cubes) {
    SCOPED_TRACE(what);
    EXPECT_DOUBLE_EQ(volume_of("obj", text), 8.0);
    EXPECT_DOUBLE_EQ(volume_of("tab", text), 8.0);
  }
}

TEST(ObjFile, WhatIsNotReadIsRefusedWithItsLine) {
  const auto changed = [&](const char* what, const char* with) { return replaced(kCube, what, with); };
  expect_error("obj", changed("v 2 0 0", "v 2 0"),
               "file:2: expected a coordinate, found the end of the line");
  expect_error("obj", changed("v 2 0 0", "v 2,0 0 0"), "file:2: expected a coordinate, found '2,0'");
  expect_error("obj", changed("v 2 0 0", "v 1,000.0 0 0"), "file:2: expected a coordinate, found '1,000.0'");
  expect_error("obj", changed("v 2 0 0", "v 0x2 0 0"), "file:2: expected a coordinate, found '0x2'");
  expect_error("obj", changed("v 2 0 0", "v inf 0 0"),
               "file:2: expected a coordinate, found 'inf', which is not");
  expect_error("obj", changed("v 2 0 0", "v 1e999 0 0"),
               "file:2: expected a coordinate, found '1e999', which no");
  expect_error("obj", changed("v 2 0 0", "v ***** 0 0"), "file:2: expected a coordinate, found '*****'");
  expect_error("obj", changed("v 2 0 0", "v -0.1-0.2 0 0"),
               "file:2: expected a coordinate, found '-0.1-0.2'");
  expect_error("obj", changed("v 2 0 0", "v +-2 0 0"), "file:2: expected a coordinate, found '+-2'");
  expect_error("obj", changed("v 2 0 0", "v 2 0 0 5 6"), "file:2: expected 3 coordinates");
  expect_error("obj", changed("v 2 0 0", "v 2 . 0 0"), "file:2: expected a coordinate, found '.'");
  expect_error("obj", changed("v 2 0 0", "v 2 .5 0 0"),
               "file:2: expected 3 or 6 numbers as in the vertices before");
  expect_error("obj", changed("v 2 0 0", "v 2 0 0 red"), "file:2: expected a number, found 'red'");
  expect_error("obj", changed("f 1 3 4 2", "f 1 3"), "file:9: expected a facet of 3 corners");
  expect_error("obj", changed("f 1 3 4 2", "f 1 3 4 9"), "file:9: corner 9: expected one of the 8 vertices");
  expect_error("obj", changed("f 1 3 4 2", "f 1 3 4 -9"), "file:9: corner -9: there are 8 vertices before");
  expect_error("obj", changed("f 1 3 4 2", "f 0 3 4 2"),
               "file:9: corner 0: expected vertices counted from 1");
  expect_error("obj", changed("f 1 3 4 2", "f 1 3.0 4 2"), "file:9: expected a corner like 5");
  expect_error("obj", changed("f 1 3 4 2", "f 1 3/a 4 2"), "file:9: expected a corner like 5");
  expect_error("obj", changed("f 1 3 4 2", "f 1 3/1/1/1 4 2"), "file:9: expected a corner like 5");
  expect_error("obj", changed("f 1 3 4 2", "f 1 3/0 4 2"), "file:9: expected a corner like 5");
  expect_error("obj", changed("f 1 3 4 2", "f 1 4294967297 4 2"),
               "file:9: corner 4294967297: no such vertex");
  expect_error("obj", changed("f 1 3 4 2", "face 1 3 4 2"), "file:9: expected v, f or another word");
  expect_error("obj", changed("f 1 3 4 2", "surf 0 1 0 1 1 2"), "file:9: 'surf': curves and free-form");
  expect_error("obj", changed("f 1 3 4 2", "vn 1 2\nf 1 3 4 2"), "file:9: expected 3 numbers, found 2");
  expect_error("obj", kCube + "f 1 2 \\", "file:15: the file ends in a line that is to go on");
  expect_error("obj", kCube + "f 1 2 \\\n", "file:15: the file ends in a line that is to go on");
  expect_error("obj", kCube.substr(0, kCube.size() - 5), "file:14: expected a facet of 3 corners");
  expect_error("obj", std::string("v 0 0 0\nv 1 \0 0\n", 16), "file:2: expected a coordinate, found '?'");
  expect_error("obj", "\xFF\xFE" + kCube, "file:1: text in UTF-16");
}

const std::string kOffPoints = "0 0 0\n2 0 0\n0 2 0\n0 0 3\n",
                  kOffFacets = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

TEST(OffFile, ItsKindsAndWhatIsRefused) {
  const std::string body = kOffPoints + kOffFacets;
  const auto points = [&](const std::string& more) { return replaced(kOffPoints, "\n", " " + more + "\n"); };
  for (const std::string& text :
       {"OFF\n4 4 6\n" + body, "OFF 4 4 0\n" + body, "# a\nOFF # b\n\n4 4\n" + body,
        "COFF\n4 4 6\n" + points("255 0 0 255") + kOffFacets, "COFF\n4 4 6\n" + points("1 0 0") + kOffFacets,
        "NOFF\n4 4 6\n" + points("0 0 nan") + kOffFacets,
        "CNOFF\n4 4 6\n" + points("0 0 1 9 9 9 9") + kOffFacets,
        "STOFF\n4 4 6\n" + points("0 0") + kOffFacets,
        "OFF\n4 4 6\n" + kOffPoints + replaced(kOffFacets, "\n", " 0.5 0.5 0.5\n"),
        "OFF\n4 4 6\n" + kOffPoints + replaced(kOffFacets, "\n", " 7\n")}) {
    SCOPED_TRACE(text);
    EXPECT_DOUBLE_EQ(volume_of("off", text), 2.0);
    EXPECT_DOUBLE_EQ(volume_of("txt", text), 2.0);
  }
  expect_error("off", "4OFF\n4 4 6\n" + body, "file:1: expected OFF, COFF");
  expect_error("off", "OFF BINARY\n", "file:1: expected the number of vertices, found 'BINARY'");
  expect_error("off", "OFF\n5 4 6\n" + body, "file:7: expected 3 numbers for a vertex, found 4");
  expect_error("off", "OFF\n4 5 6\n" + body, "file:10: 5 facets are promised, the file ends after 4");
  expect_error("off", "OFF\n4 3 6\n" + body,
               "file:10: expected the end of the file after 4 vertices and 3 facets");
  expect_error("off", "OFF\n4000000000 4 6\n" + body, "file:7: expected 3 numbers for a vertex, found 4");
  expect_error("off", "OFF\n4 -4 6\n" + body, "file:2: expected the number of facets, found -4");
  expect_error("off", "OFF\n4 4 6\n" + points("1 0 0") + kOffFacets,
               "file:3: expected 3 numbers for a vertex, found 6");
  expect_error("off", "COFF\n4 4 6\n" + body, "file:3: expected 6 or 7 numbers for a vertex, found 3");
  expect_error("off", "OFF\n4 4 6\n" + replaced(body, "3 1 2 3", "3 1 2 4"),
               "file:10: corner 4: expected one of the 4");
  expect_error("off", "OFF\n4 4 6\n" + replaced(body, "3 1 2 3", "2 1 2"),
               "file:10: expected a facet of 3 corners");
  expect_error("off", "OFF\n4 4 6\n" + replaced(body, "3 1 2 3", "3 1 2"),
               "file:10: expected a corner, found the end");
  expect_error("off", "OFF\n4 4 6\n" + replaced(body, "3 1 2 3", "3 1 2 3 1 1"),
               "file:10: expected 3 corners and a colour");
}

const std::string kPly =
    "ply\nformat ascii 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n" +
    kOffPoints + kOffFacets;

TEST(PlyFile, WhatItsHeaderPromises) {
  EXPECT_DOUBLE_EQ(volume_of("ply", kPly), 2.0);
  EXPECT_DOUBLE_EQ(volume_of("ply", replaced(kPly, "\n", "\r\n")), 2.0);
  EXPECT_DOUBLE_EQ(volume_of("ply", replaced(kPly, "\n", "\r")), 2.0);
  EXPECT_DOUBLE_EQ(volume_of("ply", replaced(kPly, "3 0 2 1", "\n3 0 2 1")), 2.0);
  EXPECT_DOUBLE_EQ(volume_of("txt", replaced(kPly, "vertex_indices", "vertex_index")), 2.0);
  expect_error("ply", replaced(kPly, "face 4", "face 5"),
               "file:18: 5 of 'face' are promised (line 8), the file ends");
  expect_error("ply", replaced(kPly, "face 4", "face 3"), "file:18: expected the end of the file, found '3'");
  expect_error("ply", replaced(kPly, "vertex 4", "vertex 5"),
               "file:15: expected the end of the line, found '1'");
  expect_error("ply", replaced(kPly, "vertex 4", "vertex 4000000000"),
               "file:15: expected the end of the line");
  expect_error("ply", replaced(kPly, "0 0 3\n", "0 0\n"),
               "file:14: expected a coordinate, found the end of the line");
  expect_error("ply", replaced(kPly, "0 0 3\n", "0 0 3 4\n"),
               "file:14: expected the end of the line, found '4'");
  expect_error("ply", replaced(kPly, "3 0 2 1", "3 0 2"),
               "file:15: expected a whole number, found the end of the line");
  expect_error("ply", replaced(kPly, "3 0 2 1", "3 0 2 4"),
               "file:15: corner 4: expected one of the 4 vertices");
  expect_error("ply", replaced(kPly, "3 0 2 1", "3 0 2 -1"),
               "file:15: corner -1: expected one of the 4 vertices");
  expect_error("ply", replaced(kPly, "3 0 2 1", "2 0 2"),
               "file:15: expected a list of 3 corners or more, found 2");
  expect_error("ply", "plx\n", "file:1: expected 'ply' as the first line");
  expect_error("ply", "ply\nformat ascii 1.0\n", "file:2: the file ends before 'end_header'");
  expect_error("ply", replaced(kPly, "format ascii 1.0\n", ""), "file:9: expected a line 'format ...'");
  expect_error("ply", replaced(kPly, "ascii 1.0", "ascii 2.0"), "file:2: expected version 1.0, found '2.0'");
  expect_error("ply", replaced(kPly, "property float z\n", ""), "file:4: expected a property z of 'vertex'");
  expect_error("ply", replaced(kPly, "float z", "float x"), "file:7: 'x' for a second time");
  expect_error("ply", replaced(kPly, "element face", "element vertex"), "file:8: 'vertex' for a second time");
  expect_error("ply", replaced(kPly, "float z", "real z"), "file:7: expected a type");
  expect_error("ply", replaced(kPly, "vertex_indices", "corners"), "file:8: expected a list vertex_indices");
  expect_error("ply", replaced(kPly, "element face", "element tristrips"),
               "file:8: strips of triangles are not read");
}

// The bytes of values, those of highest weight first if `swapped`.
template <class... Values>
std::string raw(bool swapped, Values... values) {
  std::string all;
  const auto add = [&](auto value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    if (swapped) std::reverse(bytes.begin(), bytes.end());
    all += bytes;
  };
  (add(values), ...);
  return all;
}

TEST(PlyFile, BinaryOfBothOrders) {
  for (const bool swapped : {false, true}) {
    std::string head =
        "ply\nformat binary_" + std::string(swapped ? "big" : "little") +
        "_endian 1.0\nelement vertex 4\nproperty double x\nproperty float y\nproperty uchar red\n"
        "property short z\nelement face 4\nproperty list uchar uint vertex_index\nend_header\n";
    std::string bytes;
    const double points[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 3}};
    for (const auto& [x, y, z] : points)
      bytes += raw(swapped, x, static_cast<float>(y), std::uint8_t{7}, static_cast<std::int16_t>(z));
    const std::uint32_t facets[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (const auto& [a, b, c] : facets) bytes += raw(swapped, std::uint8_t{3}, a, b, c);
    EXPECT_DOUBLE_EQ(volume_of("ply", head + bytes), 2.0);
    EXPECT_DOUBLE_EQ(volume_of("ply", replaced(head, "\n", "\r\n") + bytes), 2.0);
    expect_error("ply", head + bytes.substr(0, bytes.size() - 1),
                 "file:8: 4 of 'face' are promised, the file ends after 3");
    expect_error("ply", head + bytes.substr(0, 20),
                 "file:3: 4 of 'vertex' are promised, the file ends after 1");
    expect_error("ply", head + bytes + '\n',
                 "file: expected the end of the file after its elements, found 1 more");
    std::string bad = bytes;
    bad.replace(bytes.size() - 4, 4, raw(swapped, 4u));
    expect_error("ply", head + bad, "file:8: 'face' 4: corner 4: expected one of the 4 vertices");
    bad = bytes;
    bad.replace(15, 8, raw(swapped, std::nan("")));
    expect_error("ply", head + bad, "file:3: 'vertex' 2: a coordinate that is not finite");
  }
}

const std::string kStl = [] {
  std::string text = "solid a tetrahedron\n";
  const char* points[] = {"0 0 0", "2 0 0", "0 2 0", "0 0 3"};
  for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})
    text += fmt::format(
        " facet normal 0 -nan 1.0\n  outer loop\n   vertex {}\n   vertex {}\n   vertex {}\n  endloop\n "
        "endfacet\n",
        points[a], points[b], points[c]);
  return text + "endsolid a tetrahedron\n";
}();

TEST(StlFile, WholeFacetsAndEndsolid) {
  EXPECT_DOUBLE_EQ(volume_of("stl", kStl), 2.0);
  EXPECT_DOUBLE_EQ(volume_of("stl", replaced(kStl, "\n", "\r\n")), 2.0);
  EXPECT_DOUBLE_EQ(volume_of("stl", replaced(replaced(kStl, "facet", "FACET"), "solid", "SOLID")), 2.0);
  const std::size_t half = kStl.find(" facet", 200);
  EXPECT_DOUBLE_EQ(volume_of("stl", kStl.substr(0, half) + "endsolid\nsolid\n" + kStl.substr(half)), 2.0);
  for (std::size_t size = 6; size + 23 < kStl.size(); size += 7) {
    const std::string error = error_of("stl", kStl.substr(0, size));
    EXPECT_TRUE(error.starts_with("file:")) << error;
  }
  expect_error("stl", kStl.substr(0, kStl.find("endsolid")),
               "file:29: the file ends before 'endsolid', after 4");
  expect_error("stl", replaced(kStl, "   vertex 0 0 3\n", ""), "file:13: expected 'vertex', found 'endloop'");
  expect_error("stl", replaced(kStl, "  endloop", "   vertex 1 1 1\n  endloop"),
               "file:7: expected 'endloop', found 'vertex'");
  expect_error("stl", replaced(kStl, "0 0 3", "0 0 3 4"), "file:13: expected ");
  expect_error("stl", replaced(kStl, "0 0 3", "0 0 nan"), "file:13: expected a coordinate, found 'nan'");
  expect_error("stl", kStl + "more", "file:31: expected 'solid', found 'more'");
}

std::string binary_stl(const std::string& start) {
  std::string bytes = start;
  bytes.resize(80, ' ');
  bytes += raw(false, 4u);
  const float points[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  for (const auto& corners : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    bytes += raw(false, 0.f, 0.f, std::nanf(""));
    for (const int k : corners) bytes += raw(false, points[k][0], points[k][1], points[k][2]);
    bytes += raw(false, std::uint16_t{0x8fff});
  }
  return bytes;
}

TEST(StlFile, BinarySizesAreHeldAgainstTheHeader) {
  for (const char* start : {"binary", "solid but binary", "solid"}) {
    const std::string stl = binary_stl(start);
    EXPECT_DOUBLE_EQ(volume_of("stl", stl), 2.0);
    for (const std::size_t size : {stl.size() - 1, stl.size() - 50, std::size_t{84}})
      expect_error("stl", stl.substr(0, size),
                   "file:1: binary STL: 4 facets are promised, which take 284 bytes");
    expect_error("stl", stl + " ",
                 "file:1: binary STL: 4 facets are promised, which take 284 bytes, the file has 285");
    std::string bad = stl;
    bad.replace(84 + 12, 4, raw(false, std::nanf("")));
    expect_error("stl", bad, "file:1: facet 1 has a vertex that is not finite");
  }
  expect_error("stl", "binary", "file:1: no STL file");
}

}  // namespace
}  // namespace cairn
