// Meshes from files of every format, and the one-line errors of bad ones.
#include "shape/mesh.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

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

std::string error_of(const std::string& path) {
  try {
    load_mesh(path, 1.0);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Mesh, BadFilesAreRefusedInOneLine) {
  const Folder folder;
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& what) {
    const std::string path = folder.write(name, text), error = error_of(path);
    EXPECT_TRUE(error.starts_with(path + ":")) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  };
  const std::string missing = (folder / "none.stl").string();
  EXPECT_EQ(error_of(missing), missing + ": no such mesh file");
  refused("a.step", "ISO-10303-21;", "a.step:1: expected a mesh");
  refused("a.h5", std::string("\x89HDF\r\n\0\0", 8), "a binary file of an unknown kind");
  refused("empty.obj", "", "the file is empty");
  refused("zero.off", "", "the file is empty");
  refused("blank.txt", "\n \n", "nothing but blanks");
  refused("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "points.obj:3: expected facets, found none");
  refused("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "flat.obj:4: holds no facet with an area");
  refused("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n",
          "far.obj:4: facet 1 of the file has a vertex at (1e+30, 0, 0) m, beyond 1e+15 m");
  refused("unused.off", "OFF\n4 1 0\n0 0 0\n3 0 0\n3 3 0\n1e300 0 0\n3 0 1 2\n",
          "no facet, but the file, has a vertex at (1e+300, 0, 0) m");
  const std::string folder_name = (folder / "folder.obj").string(), pipe = (folder / "pipe.obj").string();
  std::filesystem::create_directory(folder_name);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of(folder_name), folder_name + ": expected a mesh file, found a directory");
  EXPECT_EQ(error_of(pipe), pipe + ": expected a mesh file, found a pipe");
  EXPECT_EQ(error_of("/dev/null"), "/dev/null: expected a mesh file, found a device");
}

// An L-shaped prism with concave caps, moved by 10 along x, as AC3D.
const char* const kOtherFormat =
    "AC3Db\nMATERIAL \"\" rgb 1 1 1 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\nkids 1\n"
    "OBJECT poly\nloc 10 0 0\nnumvert 12\n0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n0 0 1\n2 0 1\n2 1 1\n"
    "1 1 1\n1 2 1\n0 2 1\nnumsurf 8\n"
    "SURF 0x0\nmat 0\nrefs 6\n0 0 0\n5 0 0\n4 0 0\n3 0 0\n2 0 0\n1 0 0\n"
    "SURF 0x0\nmat 0\nrefs 6\n6 0 0\n7 0 0\n8 0 0\n9 0 0\n10 0 0\n11 0 0\n"
    "SURF 0x0\nmat 0\nrefs 4\n0 0 0\n1 0 0\n7 0 0\n6 0 0\n"
    "SURF 0x0\nmat 0\nrefs 4\n1 0 0\n2 0 0\n8 0 0\n7 0 0\n"
    "SURF 0x0\nmat 0\nrefs 4\n2 0 0\n3 0 0\n9 0 0\n8 0 0\n"
    "SURF 0x0\nmat 0\nrefs 4\n3 0 0\n4 0 0\n10 0 0\n9 0 0\n"
    "SURF 0x0\nmat 0\nrefs 4\n4 0 0\n5 0 0\n11 0 0\n10 0 0\n"
    "SURF 0x0\nmat 0\nrefs 4\n5 0 0\n0 0 0\n6 0 0\n11 0 0\nkids 0\n";

TEST(Mesh, OtherFormatsAreReadByAssimpWithAWord) {
  const Folder folder;
  Welding welding;
  const TriangleMesh mesh = load_mesh(folder.write("l.ac", kOtherFormat), 2.0, &welding);
  EXPECT_NEAR(area(mesh), 4.0 * 14.0, 1e-5);
  double left = 1e9;
  for (const Vec3& x : mesh.vertices) left = std::min(left, x.x());
  EXPECT_NEAR(left, 20.0, 1e-6);
  ASSERT_EQ(welding.notes.size(), 1u);
  EXPECT_NE(welding.notes[0].find("assimp"), std::string::npos);
  const std::string bad = folder.write("bad.gltf", "{ no glTF");
  EXPECT_TRUE(error_of(bad).starts_with(bad + ": truncated or no .gltf file")) << error_of(bad);
}

// A triangle 3 wide and 4 high, `far` to the left of the origin.
std::string far_obj(double far) {
  return fmt::format("v {} 0 0\nv {} 0 0\nv {} 4 0\nf 1 2 3\n", -far, 3 - far, 3 - far);
}
std::string far_stl(float far) {
  return std::string(80, ' ') + raw(false, 1u, 0.f, 0.f, 1.f, -far, 0.f, 0.f, 3.f - far, 0.f, 0.f, 3.f - far,
                                    4.f, 0.f, std::uint16_t{0});
}

TEST(Mesh, DigitsFarFromTheOriginAreKeptWhereTheFileHasThem) {
  const Folder folder;
  const auto told = [&](const std::string& name, const std::string& text, double unit) -> std::string {
    Welding welding;
    try {
      const TriangleMesh mesh = load_mesh(folder.write(name, text), unit, &welding);
      EXPECT_NEAR(area(mesh), 6.0 * unit * unit, 1e-3 * unit * unit) << text;
    } catch (const InputError& error) {
      return std::string("refused: ") + error.what();
    }
    return welding.notes.empty() ? "" : welding.notes[0];
  };
  EXPECT_EQ(told("far.obj", far_obj(1e7), 1.0), "");
  EXPECT_NE(
      told("far.obj", far_obj(2e11), 1.0).find("the double precision of its coordinates 5 digits are left"),
      std::string::npos)
      << told("far.obj", far_obj(2e11), 1.0);
  EXPECT_TRUE(told("far.obj", far_obj(1e14), 1.0).starts_with("refused: "));
  EXPECT_EQ(told("far.stl", far_stl(80.f), 1.0), "");
  EXPECT_EQ(told("far.stl", far_stl(1000.f), 2.0),
            "lies up to 2e+03 m from its origin at an extent of 10 m, so that of the single precision of its "
            "coordinates 4 digits are left: move it to its centre");
  const std::string lost = told("far.stl", far_stl(1e7f), 1.0);
  EXPECT_TRUE(lost.starts_with("refused: ")) << lost;
  EXPECT_NE(lost.find("far.stl: lies up to 1e+07 m from its origin"), std::string::npos) << lost;
}

// Vertices of an OBJ with as many digits as a double has come back bit for bit.
TEST(Mesh, NumbersAreReadInDoublePrecision) {
  const Folder folder;
  const std::string path = folder.write(
      "pi.obj",
      "v 0.1 3.141592653589793 -2.718281828459045e-3\nv 1.0000000000000002 0 0\nv 0 1 0\nf 1 2 3\n");
  const TriangleMesh mesh = load_mesh(path, 1.0);
  EXPECT_EQ(mesh.vertices[0], Vec3(0.1, 3.141592653589793, -2.718281828459045e-3));
  EXPECT_EQ(mesh.vertices[1].x(), 1.0000000000000002);
}

}  // namespace
}  // namespace cairn
