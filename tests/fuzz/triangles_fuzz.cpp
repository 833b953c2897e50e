// Triangles of any kind, as a file may hold them: what comes of them is a surface that a sphere can meet.
// The first byte is the number of vertices; three floats for each follow, then a byte for every corner.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>

#include "contact/wall/mesh_surface.h"
#include "core/error.h"
#include "shape/mesh_file/file_surface.h"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

/// Touches and distances of spheres in many places.
void meet(const cairn::MeshSurface& surface) {
  const cairn::TriangleMesh& mesh = surface.mesh();
  std::vector<std::uint32_t> all(mesh.triangles.size()), near;
  std::iota(all.begin(), all.end(), 0u);
  std::vector<cairn::WallTouch> touches;
  for (const cairn::Vec3& corner : mesh.vertices)
    for (const double radius : {1e-3, 1.0, 1e3}) {
      if (radius < 1e-10 * corner.cwiseAbs().maxCoeff()) continue;  // places are rounded by more than that
      const cairn::Vec3 y = corner + 0.7 * radius * cairn::Vec3(0.6, 0.0, 0.8);
      near.clear();
      surface.tree().find(y, radius, near);
      const double distance = surface.tree().distance(y);
      require(std::isfinite(distance) && (distance < radius) == !near.empty());
      touches.clear();
      surface.touch(y, radius, near, touches);
      const std::size_t few = touches.size();
      surface.touch(y, radius, all, touches);
      require(touches.size() == 2 * few && near.empty() == touches.empty());
      for (const cairn::WallTouch& t : touches) {
        require(t.feature < surface.features() && t.arm < radius && std::abs(t.n.norm() - 1.0) < 1e-6);
        const cairn::WallTouch same = surface.extend(t.feature, y);
        require(same.n.allFinite() && std::isfinite(same.arm));
      }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t count = std::min<std::size_t>(data[0], (size - 1) / 12);
  if (count == 0) return 0;
  std::vector<std::array<float, 3>> vertices(count);
  std::memcpy(vertices.data(), data + 1, 12 * count);
  cairn::FileSurface surface;
  for (const auto& [x, y, z] : vertices) surface.vertices.push_back({x, y, z});
  for (std::size_t at = 1 + 12 * count; at + 3 <= size && surface.ends.size() < 64; at += 3) {
    for (std::size_t k = 0; k < 3; ++k)
      surface.corners.push_back(static_cast<std::uint32_t>(data[at + k] % count));
    surface.end_facet();
  }
  try {
    meet(cairn::MeshSurface(cairn::make_mesh(surface, "fuzz", 1.0)));
  } catch (const cairn::InputError& error) {
    require(std::string(error.what()).find('\n') == std::string::npos);
  }
  return 0;
}
