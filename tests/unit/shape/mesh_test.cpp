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

TEST(Mesh, AFileThatHangsItsReaderIsRefused) {
  try {  // assimp 5.2 waits for the end of the header for ever
    parse_mesh("ply\nformat ascii 1.0\n", "ply", "half.ply", 1.0, 1);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "half.ply: cannot be read: it takes more than 1 s");
  }
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
  refused("empty.obj", "", "the file is empty");
  refused("words.ply", "not a mesh at all", "truncated or not a PLY file");
  refused("zero.off", "", "the file is empty");
  // A vertex list twice: the reader would write beyond its memory.
  refused("twice.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "element vertex 4000\nproperty float x\nend_header\n0 0 0\n" +
              std::string(8000, '1'),
          "");
  refused("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "holds no triangle");
  refused("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "holds no triangle with an area");
  refused("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n",
          "facet 1 of the file has a vertex at (1, 0, nan) m, not finite");
  refused("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "vertex at (1e+30, 0, 0) m");
  refused("unused.off", "OFF\n4 1 0\n0 0 0\n3 0 0\n3 3 0\nnan 0 0\n3 0 1 2\n",
          "no facet, but the file, has a vertex at (nan, 0, 0) m");
  const std::string off = kOff, stl = binary_stl(), ply = binary_ply(false);
  refused("short.off", off.substr(0, off.size() - 8), "truncated or not an OFF file");
  refused("huge.off", "OFF\n4000000000 2 0\n" + off.substr(10), "truncated or not an OFF file");
  refused("short.stl", stl.substr(0, stl.size() - 20), "holds no triangle, or is truncated");
  refused("cut.stl", std::string(80, 'x') + stl.substr(80, 100), "truncated or not an STL file");
  refused("short.ply", ply.substr(0, ply.size() - 20), "truncated or not a PLY file");
  const std::string huge =
      std::string(kPly).replace(std::string(kPly).find("vertex 4"), 8, "vertex 4000000000");
  refused("huge.ply", huge, "truncated or not a PLY file");
  const std::string folder_name = (folder / "folder.obj").string(), pipe = (folder / "pipe.obj").string();
  std::filesystem::create_directory(folder_name);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_of(folder_name), folder_name + ": expected a mesh file, found a directory");
  EXPECT_EQ(error_of(pipe), pipe + ": expected a mesh file, found a pipe");
  EXPECT_EQ(error_of("/dev/null"), "/dev/null: expected a mesh file, found a device");
}

TEST(Mesh, FarFromItsOriginItLosesDigits) {
  const Folder folder;
  const auto told = [&](double far, double unit) -> std::string {
    std::string text;
    for (const auto& [x, y] : {std::pair{0, 0}, {3, 0}, {3, 4}})
      text += fmt::format("v {} {} 0\n", x - far, static_cast<double>(y));
    Welding welding;
    try {
      load_mesh(folder.write("far.obj", text + "f 1 2 3\n"), unit, &welding);
    } catch (const InputError& error) {
      return std::string("refused: ") + error.what();
    }
    return welding.far_off;
  };
  EXPECT_EQ(told(80.0, 1.0), "");
  EXPECT_EQ(told(1000.0, 2.0),
            "lies up to 2e+03 m from its origin at an extent of 10 m, so that of single precision, in which "
            "meshes are read, 4 digits are left: move it to its centre");
  EXPECT_NE(told(80000.0, 1.0).find("3 digits are left"), std::string::npos);
  const std::string lost = told(1e7, 1.0);
  EXPECT_TRUE(lost.starts_with("refused: ")) << lost;
  EXPECT_NE(lost.find("far.obj: lies up to 1e+07 m from its origin"), std::string::npos) << lost;
  EXPECT_NE(told(1e12, 1.0).find("0 digits are left"), std::string::npos) << told(1e12, 1.0);
}

}  // namespace
}  // namespace cairn
