// Meshes from files of every format, and the one-line errors of bad ones.
#include "shape/mesh.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "folder.h"

namespace cairn {
namespace {

// A square of two triangles, three units wide.
const char* const kObj = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nf 1 2 3 4\n";
const char* const kOff = "OFF\n4 2 0\n0 0 0\n3 0 0\n3 3 0\n0 3 0\n3 0 1 2\n3 0 2 3\n";
const char* const kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n3 0 0\n3 3 0\n0 3 0\n3 0 1 2\n3 0 2 3\n";
const char* const kStl =
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 3 3 0\nendloop\nendfacet\n"
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 3 0\nvertex 0 3 0\nendloop\nendfacet\nendsolid "
    "s\n";

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

std::string binary_ply(bool swapped) {
  std::string bytes = std::string("ply\r\nformat binary_") + (swapped ? "big" : "little") +
                      "_endian 1.0\r\ncomment a square\r\nelement vertex 4\r\nproperty double x\r\n"
                      "property uchar red\r\nproperty float y\r\nproperty short z\r\nelement edge 1\r\n"
                      "property int from\r\nelement face 1\r\nproperty list ushort int8 weights\r\n"
                      "property list uint8 uint vertex_index\r\nend_header\n";
  for (const auto& [x, y] : {std::pair{0.0, 0.f}, {3.0, 0.f}, {3.0, 3.f}, {0.0, 3.f}})
    bytes += raw(swapped, x, std::uint8_t{9}, y, std::int16_t{0});
  bytes += raw(swapped, std::int32_t{7}, std::uint16_t{2}, std::int8_t{-1}, std::int8_t{1}, std::uint8_t{4});
  return bytes + raw(swapped, 0u, 1u, 2u, 3u);
}

std::string binary_stl() {
  std::string bytes = "solid, but binary";
  bytes.resize(80, ' ');
  bytes += raw(false, 2u);
  for (const float corner : {0.f, 3.f})  // of the square, on the diagonal's either side
    bytes +=
        raw(false, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 3.f, corner, 0.f, 3.f - corner, 3.f, 0.f, std::uint16_t{0});
  return bytes;
}

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5 * (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
  return sum;
}

TEST(Mesh, EveryFormatGivesTheSameWeldedTriangles) {
  const Folder folder;
  for (const auto& [name, text] :
       std::vector<std::pair<std::string, std::string>>{{"a.obj", kObj},
                                                        {"a.off", kOff},
                                                        {"a.ply", kPly},
                                                        {"little.ply", binary_ply(false)},
                                                        {"big.ply", binary_ply(true)},
                                                        {"a.STL", kStl},
                                                        {"binary.stl", binary_stl()}}) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh = load_mesh(folder.write(name, text), 0.001);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_NEAR(area(mesh), 9e-6, 1e-12);
  }
}

TEST(Mesh, FilesMayBeWrittenInManyWays) {
  for (const auto& [kind, text] : std::vector<std::pair<std::string, std::string>>{
           {".obj",
            "# c\r\nmtllib x.mtl\r\no s\r\nv 0 0 0 1\r\nv +3 0 0 .1 .2 .3\r\nvt 0 0\r\nvn 0 0 1\r\n"
            "v 3e0 3 0\r\nv 0 3 0\r\nusemtl m\r\nf 1/1/1 2//1 3/1\r\nf -4 \\\r\n -2 -1 # c\r\n"},
           {".off", "COFF # c\n\n4 1\n\n0 0 0 9 9 9\n3 0 0 9 9 9\n3 3 0\n# c\n0 3 0\n4 0 1 2 3 1 0 0"},
           {".ply",
            "ply\nformat ascii 1.0\nobj_info i\nelement face 1\nproperty list int int vertex_index\n"
            "element vertex 4\nproperty float z\nproperty float y\nproperty float x\nelement none 999\n"
            "end_header\n4 0 1 2 3\n0 0 0\n0 0 3\n0 3 3\n0 3 0\n"},
           {".stl",
            "  SOLID\nfacet normal nan nan nan\nOUTER LOOP\nVERTEX 0 0 0\nvertex 3 0 0\nvertex 3 3 0\n"
            "endloop\nendfacet\nendsolid\nsolid vertex\nfacet\nouter loop vertex 0 0 0 vertex 3 3 0\n"
            "vertex 0 3 0 endloop endfacet"}}) {
    SCOPED_TRACE(kind);
    const TriangleMesh mesh = parse_mesh(text, kind, "file", 1.0);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_NEAR(area(mesh), 9.0, 1e-12);
  }
}

TEST(Mesh, PolygonsThatAreNotConvexAreCutAlongTheirInside) {
  // A comb with three teeth, its spine along y, and the same in a tilted plane and the other way round.
  const std::vector<Vec3> comb = {{0, 0, 0}, {5, 0, 0}, {5, 1, 0}, {1, 1, 0}, {1, 2, 0}, {5, 2, 0},
                                  {5, 3, 0}, {1, 3, 0}, {1, 4, 0}, {5, 4, 0}, {5, 5, 0}, {0, 5, 0}};
  const Quat tilt(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  for (const Quat& turn : {Quat::Identity(), tilt})
    for (const bool backwards : {false, true}) {
      std::string text, face = "f";
      for (std::size_t k = 0; k < comb.size(); ++k) {
        const Vec3 x = turn * comb[k];
        text += fmt::format("v {} {} {}\n", x.x(), x.y(), x.z());
        face += fmt::format(" {}", backwards ? comb.size() - k : k + 1);
      }
      const TriangleMesh mesh = parse_mesh(text + face, ".obj", "file", 1.0);
      EXPECT_EQ(mesh.triangles.size(), comb.size() - 2);
      Vec3 sum = Vec3::Zero();  // of the areas with their signs: triangles that overlap would cancel
      for (const auto& [a, b, c] : mesh.triangles)
        sum += 0.5 * (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
      EXPECT_NEAR(area(mesh), 17.0, 1e-9);
      EXPECT_NEAR(sum.dot(turn * Vec3::UnitZ()), backwards ? -17.0 : 17.0, 1e-9);
    }
}

TEST(Mesh, WeldingJoinsNearbyVerticesAndDropsTrianglesWithoutArea) {
  TriangleMesh soup;
  soup.vertices = {{0, 0, 0}, {1, 0, 0},     {0, 1, 0}, {1 + 1e-9, 0, 0},
                   {1, 1, 0}, {-1e-9, 1, 0}, {9, 9, 9}, {0.5, 0, 0}};
  soup.triangles = {{0, 1, 2}, {3, 4, 5}, {1, 2, 0}, {0, 7, 1}, {1, 3, 4}};
  const TriangleMesh mesh = weld(soup, 1e-6);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_NEAR(area(mesh), 1.0, 1e-8);
  EXPECT_EQ(weld(soup, 0.0).vertices.size(), 6u);
}

TEST(Mesh, BadFilesAreRefusedInOneLine) {
  const Folder folder;
  const auto error_of = [&](const std::string& path) -> std::string {
    try {
      load_mesh(path, 1.0);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& what) {
    const std::string path = folder.write(name, text), error = error_of(path);
    EXPECT_TRUE(error.starts_with(path + ": ")) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  };
  const std::string missing = (folder / "none.stl").string();
  EXPECT_EQ(error_of(missing), missing + ": no such mesh file");
  refused("a.step", "ISO-10303-21;", "expected .obj, .stl, .ply or .off");
  refused("empty.obj", "", "holds no triangle");
  refused("words.ply", "not a mesh\nat all", "line 1: expected 'ply', found 'not'");
  refused("zero.off", "", "line 1: expected 'OFF', found the end of the file");
  refused("words.stl", "solid s\nfacet\n\x01 two", "line 3: expected 'facet', 'outer loop', 'vertex'");
  refused("word.obj", "v 0 0 0\nv 1 zero 0", "line 2: expected a number, found 'zero'");
  // Numbers of rows that a file does not hold, of corners that no polygon has, of vertices that are not
  // there.
  refused("short.off", "OFF\n4000000000 4000000000 0\n0 0 0\n", "line 4: expected a number");
  refused("minus.off", "OFF\n-1 1 0\n", "line 2: expected a whole number, found '-1'");
  refused("four.off", "4OFF\n1 1 0\n", "expected 'OFF'");
  refused("open.stl", "solid\nfacet\nouter loop\nvertex 0 0 0\n", "expected 'endloop'");
  refused("two.stl", "solid\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", "three vertices");
  refused("short.stl", binary_stl().substr(0, 150), "expected more bytes");
  refused("zero.obj", "v 0 0 0\nf 0 1 1\n", "line 2: expected the number of a vertex, found '0'");
  refused("before.obj", "v 0 0 0\nf 1 1 -2\n", "line 2: expected the number of a vertex, found '-2'");
  refused("beyond.obj", "v 0 0 0\nf 1 1 2\n", "polygon 0 has a vertex that does not exist");
  std::string many = "v 0 0 0\nf";
  for (int k = 0; k < 300; ++k) many += " 1";
  refused("many.obj", many, "expected at most 256 corners, found 300");
  const std::string ply = "ply\nformat ascii 1.0\n", vertex = "element vertex 1\nproperty float x\n",
                    list = "element face 1\nproperty list int int vertex_index\nend_header\n";
  refused("header.ply", ply, "line 3: expected 'element', 'property', 'comment' or 'end_header'");
  refused("format.ply", "ply\nformat binary\n", "line 2: expected 'ascii', 'binary_little_endian'");
  refused("type.ply", ply + "element a 1\nproperty real x\n", "line 4: expected a type, found 'real'");
  refused("rows.ply", ply + "element a 4000000000\nproperty float x\nend_header\n1\n", "expected a number");
  refused("minus.ply", ply + list + "-1 0\n", "expected a whole number that is not negative");
  refused("lists.ply", ply + "element vertex 1\nproperty list int int x\nend_header\n1 1\n", "without lists");
  refused("flat.ply", ply + vertex + list + "1\n1 0\n", "vertex 0 is not finite");
  refused("short.ply", binary_ply(true).substr(0, binary_ply(true).size() - 1), "expected more bytes");
  refused("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "holds no triangle");
  refused("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "holds no triangle with an area");
  refused("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", "vertex 1 is not finite");
  refused("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "vertex");
}

}  // namespace
}  // namespace cairn
