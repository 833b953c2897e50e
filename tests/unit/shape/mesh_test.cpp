// Meshes from files of every format, and the one-line errors of bad ones.
#include "shape/mesh.h"

#include <gtest/gtest.h>

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

double area(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5 * (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
  return sum;
}

TEST(Mesh, EveryFormatGivesTheSameWeldedTriangles) {
  const Folder folder;
  for (const auto& [name, text] :
       {std::pair{"a.obj", kObj}, {"a.off", kOff}, {"a.ply", kPly}, {"a.STL", kStl}}) {
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
  refused("empty.obj", "", "not a valid mesh");
  refused("words.ply", "not a mesh at all", "not a valid mesh");
  refused("zero.off", "", "not a valid mesh");
  refused("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", "holds no triangle");
  refused("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "holds no triangle with an area");
  refused("far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n", "vertex");
}

}  // namespace
}  // namespace cairn
