#include "sim/make_walls.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace cairn {

namespace {

/// Meshes one after the other, as columns.
struct MeshColumns {
  std::vector<std::uint32_t> vertices, triangles;  // of each mesh
  std::vector<Vec3> position;
  std::vector<std::uint32_t> a, b, c;

  FieldTable table() {
    return {{"vertices", "", "number of vertices of each mesh", &vertices, "mesh"},
            {"triangles", "", "number of triangles of each mesh", &triangles, "mesh"},
            {"position", "m", "of the vertices at time 0", &position, "vertex"},
            {"a", "", "vertex of the mesh", &a, "triangle"},
            {"b", "", "vertex of the mesh", &b, "triangle"},
            {"c", "", "vertex of the mesh", &c, "triangle"}};
  }
};

std::size_t mesh_walls(const Scene& scene) {
  return static_cast<std::size_t>(std::count_if(scene.walls.begin(), scene.walls.end(),
                                                [](const WallSpec& w) { return w.kind == WallKind::mesh; }));
}

WallSurface surface(const WallSpec& wall) {
  const bool inside = wall.side == WallSide::inside;
  if (wall.kind == WallKind::sphere) return SphereSurface{wall.point, wall.radius, inside};
  if (wall.kind == WallKind::cylinder) return CylinderSurface{wall.point, wall.axis, wall.radius, inside};
  return PlaneSurface{wall.point, wall.normal};
}

}  // namespace

std::vector<TriangleMesh> load_wall_meshes(const Scene& scene) {
  std::vector<TriangleMesh> meshes;
  for (std::size_t k = 0; k < scene.walls.size(); ++k) {
    const WallSpec& wall = scene.walls[k];
    if (wall.kind != WallKind::mesh) continue;
    try {
      meshes.push_back(load_mesh(scene.directory / wall.file, wall.unit));
    } catch (const InputError& error) {
      throw scene.sources.error(fmt::format("wall[{}].file", k), error.what());
    }
    for (Vec3& x : meshes.back().vertices) x += wall.point;
  }
  return meshes;
}

std::vector<Wall> make_walls(const Scene& scene, std::vector<TriangleMesh> meshes) {
  std::vector<Wall> walls;
  std::size_t mesh = 0;
  for (const WallSpec& spec : scene.walls) {
    const WallMotion motion{.velocity = spec.velocity,
                            .amplitude = spec.oscillation_amplitude,
                            .frequency = spec.oscillation_frequency,
                            .phase = spec.oscillation_phase,
                            .spin = spec.angular_velocity,
                            .center = spec.rotation_point};
    if (spec.kind == WallKind::mesh)
      walls.push_back({std::make_shared<const MeshSurface>(std::move(meshes.at(mesh++))), motion});
    else
      walls.push_back({surface(spec), motion});
  }
  return walls;
}

void set_walls(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls,
               const std::vector<double>& stage_starts, Walls& acting) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(walls.size(), none);
  acting.walls.clear();
  acting.number.clear();
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    if (!has_wall(scene, stage, w)) continue;
    place[w] = static_cast<std::uint32_t>(acting.walls.size());
    acting.walls.push_back(walls[w]);
    acting.number.push_back(w);
    if (scene.walls[w].stages.empty()) continue;
    std::size_t first = stage;
    for (std::size_t k = 0; k < stage && first == stage; ++k)
      if (has_wall(scene, k, w)) first = k;
    acting.walls.back().motion.since = stage_starts.at(first);
  }
  std::erase_if(acting.contacts, [&](const WallContact& c) { return place[c.wall] == none; });
  for (WallContact& c : acting.contacts) c.wall = place[c.wall];
}

std::vector<Wall> walls_of_stage(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls) {
  std::vector<Wall> out;
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (has_wall(scene, stage, w)) out.push_back(walls[w]);
  return out;
}

void write_wall_meshes(ResultFile& file, const std::vector<TriangleMesh>& meshes) {
  if (meshes.empty()) return;
  MeshColumns columns;
  for (const TriangleMesh& mesh : meshes) {
    columns.vertices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    columns.triangles.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    columns.position.insert(columns.position.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& [a, b, c] : mesh.triangles) {
      columns.a.push_back(a);
      columns.b.push_back(b);
      columns.c.push_back(c);
    }
  }
  file.write_static("meshes", columns.table());
}

std::vector<TriangleMesh> read_wall_meshes(const ResultFile& file, const Scene& scene) {
  std::vector<TriangleMesh> meshes(mesh_walls(scene));
  if (meshes.empty()) return meshes;
  MeshColumns columns;
  file.read_static("meshes", columns.table());
  const auto check = [&](bool good) {
    if (!good) throw InputError("{}: meshes: not those of the scene's walls", file.path().string());
  };
  check(columns.vertices.size() == meshes.size());
  std::size_t vertex = 0, triangle = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::size_t vertices = columns.vertices[m], triangles = columns.triangles[m];
    check(triangles > 0 && vertex + vertices <= columns.position.size() &&
          triangle + triangles <= columns.a.size());
    for (std::size_t k = 0; k < vertices; ++k) meshes[m].vertices.push_back(columns.position[vertex++]);
    for (std::size_t k = 0; k < triangles; ++k, ++triangle) {
      const std::array<std::uint32_t, 3> t{columns.a[triangle], columns.b[triangle], columns.c[triangle]};
      check(*std::max_element(t.begin(), t.end()) < vertices);
      meshes[m].triangles.push_back(t);
    }
  }
  return meshes;
}

double drop_height(const Bodies& bodies, const std::vector<Wall>& walls, const Vec3& field) {
  const Vec3 up = -field.normalized();
  double low = std::numeric_limits<double>::max(), high = -low;
  for (const Vec3& x : bodies.position) {
    low = std::min(low, up.dot(x));
    high = std::max(high, up.dot(x));
  }
  for (const Wall& wall : walls) {
    if (const auto* plane = std::get_if<PlaneSurface>(&wall.surface)) {
      for (const Vec3& x : bodies.position)
        low = std::min(low, up.dot(x) - std::abs((x - plane->point).dot(plane->normal)));
    } else if (const auto* sphere = std::get_if<SphereSurface>(&wall.surface)) {
      low = std::min(low, up.dot(sphere->center) - sphere->radius);
    } else if (const auto* cylinder = std::get_if<CylinderSurface>(&wall.surface)) {
      const double rise = up.cross(cylinder->axis).norm();  // an upright one does not catch a body
      if (rise > 0.5) low = std::min(low, up.dot(cylinder->point) - cylinder->radius);
    } else {
      for (const Vec3& x : wall.mesh()->mesh().vertices) low = std::min(low, up.dot(x));
    }
  }
  return high - low;
}

double greatest_wall_speed(const Bodies& bodies, const std::vector<Wall>& walls) {
  double speed = 0.0;
  for (const Wall& wall : walls) {
    if (!wall.motion.moves()) continue;
    const Vec3& center = wall.motion.center;
    double reach = 0.0;  // greatest distance of a body's centre from the axis of rotation
    if (wall.motion.spin != Vec3::Zero())
      for (const Vec3& x : bodies.position)
        reach = std::max(reach, wall.motion.spin.normalized().cross(x - center).norm());
    if (const auto* sphere = std::get_if<SphereSurface>(&wall.surface))
      reach = std::max(reach, (sphere->center - center).norm() + sphere->radius);
    speed = std::max(speed, wall.motion.greatest_speed(reach));
  }
  return speed;
}

}  // namespace cairn
