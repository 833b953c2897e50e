// Writes the meshes of this folder anew, or compares them with what it would write.
//   make_meshes FOLDER [--compare]
#include <fmt/core.h>

#include <string_view>

#include "core/error.h"
#include "core/safe_file.h"
#include "models.h"

namespace {

constexpr int kDigits = 7;

/// Largest distance between vertices of the same number, of the largest coordinate; infinite for different
/// triangles.
double difference(const cairn::TriangleMesh& a, const cairn::TriangleMesh& b) {
  if (a.triangles != b.triangles || a.vertices.size() != b.vertices.size()) return HUGE_VAL;
  double largest = 0.0, apart = 0.0;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    largest = std::max(largest, a.vertices[v].cwiseAbs().maxCoeff());
    apart = std::max(apart, (a.vertices[v] - b.vertices[v]).norm());
  }
  return apart / largest;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3 || (argc == 3 && std::string_view(argv[2]) != "--compare")) {
    fmt::print(stderr, "usage: make_meshes FOLDER [--compare]\n");
    return 2;
  }
  try {
    bool same = true;
    for (const auto& [file, mesh] : cairn::models::all()) {
      const std::filesystem::path path = std::filesystem::path(argv[1]) / file;
      if (argc == 2) {
        cairn::write_file(path, cairn::obj_text(mesh, 1.0, kDigits), true);
        continue;
      }
      // Neither order of triangles nor of vertices is lost by writing and reading: welding numbers vertices
      // by first use, so both sides are welded.
      const double apart = difference(cairn::weld(mesh, 0.0), cairn::load_mesh(path, 1.0));
      fmt::print("{}: {:.1e}\n", file, apart);
      same = same && apart < 1e-6;
    }
    return same ? 0 : 1;
  } catch (const cairn::InputError& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 2;
  }
}
