#include "sim/make_walls.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace cairn {

namespace {

WallSurface surface(const WallSpec& wall) {
  const bool inside = wall.side == WallSide::inside;
  if (wall.kind == WallKind::sphere) return SphereSurface{wall.point, wall.radius, inside};
  if (wall.kind == WallKind::cylinder) return CylinderSurface{wall.point, wall.axis, wall.radius, inside};
  return PlaneSurface{wall.point, wall.normal};
}

/// The mesh of wall `k` at its place.
WallMesh load_surface(const Scene& scene, std::size_t k) {
  const WallSpec& wall = scene.walls[k];
  return scene.sources.at(fmt::format("wall[{}].file", k), [&] {
    const std::filesystem::path path = scene.files.path_of(wall.file);
    Welding reading;
    TriangleMesh mesh =
        parse_mesh(scene.files.read(wall.file), mesh_kind(path), path.string(), wall.unit, &reading);
    for (const std::string& note : reading.notes) scene.files.note(path.string() + ": " + note);
    for (Vec3& x : mesh.vertices) x += wall.point;
    return std::make_shared<const MeshSurface>(std::move(mesh));
  });
}

}  // namespace

std::vector<Wall> make_walls(const Scene& scene) {
  std::vector<Wall> walls;
  for (std::size_t k = 0; k < scene.walls.size(); ++k) {
    const WallSpec& spec = scene.walls[k];
    const WallMotion motion{.velocity = spec.velocity,
                            .amplitude = spec.oscillation_amplitude,
                            .frequency = spec.oscillation_frequency,
                            .phase = spec.oscillation_phase,
                            .spin = spec.angular_velocity,
                            .center = spec.rotation_point,
                            .since = -spec.motion_time.value_or(0.0)};
    if (spec.kind == WallKind::mesh)
      walls.push_back({load_surface(scene, k), motion});
    else
      walls.push_back({surface(spec), motion});
    if (spec.load)
      walls.back().drive = WallDrive{spec.load_axis, *spec.load, spec.load_mass, spec.load_damping};
  }
  return walls;
}

void lead_walls(const std::vector<double>& lead, std::vector<Wall>& walls) {
  for (std::size_t w = 0; w < lead.size(); ++w) walls[w].motion.since -= lead[w];
}

void set_walls(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls,
               const std::vector<double>& stage_starts, Walls& acting) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(walls.size(), none);
  acting.walls.clear();
  acting.number.clear();
  acting.resize(walls.size());
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    if (!has_wall(scene, stage, w)) {
      acting.driven.speed[w] = 0.0;
      continue;
    }
    place[w] = static_cast<std::uint32_t>(acting.walls.size());
    acting.walls.push_back(walls[w]);
    acting.number.push_back(w);
    if (scene.walls[w].stages.empty()) continue;
    std::size_t first = stage;
    for (std::size_t k = 0; k < stage && first == stage; ++k)
      if (has_wall(scene, k, w)) first = k;
    acting.walls.back().motion.since += stage_starts.at(first);
  }
  std::erase_if(acting.contacts, [&](const WallContact& c) { return place[c.wall] == none; });
  for (WallContact& c : acting.contacts) c.wall = place[c.wall];
}

std::string set_of_walls(const std::vector<std::string>& names) {
  std::string set = ",";
  for (const std::string& name : names) set += name + ",";
  return set;
}

std::set<std::string> names_of_walls(const std::vector<std::string>& sets) {
  std::set<std::string> out;
  for (const std::string& set : sets)
    for (std::size_t begin = 1, end; (end = set.find(',', begin)) != set.npos; begin = end + 1)
      out.insert(set.substr(begin, end - begin));
  out.erase("");
  return out;
}

std::vector<std::vector<std::uint8_t>> touching_walls(const Scene& scene,
                                                      const std::vector<std::string>& sets) {
  std::vector<std::vector<std::uint8_t>> out;
  for (const std::string& set : sets) {
    out.emplace_back();
    for (std::size_t w = 0; w < scene.walls.size(); ++w)
      out.back().push_back(set.find(fmt::format(",{},", wall_name(scene, w))) != std::string::npos);
  }
  return out;
}

Walls walls_of_stage(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls,
                     const DrivenWalls& driven) {
  Walls out;
  out.driven = driven;
  out.resize(walls.size());
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    if (!has_wall(scene, stage, w)) continue;
    out.walls.push_back(walls[w]);
    out.number.push_back(w);
  }
  return out;
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
    if (!wall.moves()) continue;
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

double fall_of_wall(const Bodies& bodies, const Walls& walls, std::size_t wall) {
  const Wall& falling = walls.walls[wall];
  if (!falling.drive || falling.drive->load == 0.0) return 0.0;
  const Vec3 &axis = falling.drive->axis, way = std::copysign(1.0, falling.drive->load) * axis;
  const Vec3 shift = walls.driven.place[walls.scene_number(wall)] * axis;
  double slope = 1.0, foremost = 0.0;  // of a plane to its load; of a mesh along it
  if (const auto* plane = std::get_if<PlaneSurface>(&falling.surface)) slope = plane->normal.dot(way);
  constexpr double kLeast = 1e-9;
  if (slope < kLeast) return 0.0;
  if (const MeshSurface* mesh = falling.mesh()) {
    foremost = -std::numeric_limits<double>::infinity();
    for (const Vec3& x : mesh->mesh().vertices) foremost = std::max(foremost, way.dot(x));
  }
  double gap = std::numeric_limits<double>::infinity();
  const Spheres& spheres = bodies.spheres;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const Vec3 y = spheres.position[s] - shift;
    const double away = falling.mesh() ? way.dot(y) - foremost : falling.nearest(y).arm;
    gap = std::min(gap, (away - spheres.radius[s]) / slope);
  }
  return std::max(gap, 0.0);
}

}  // namespace cairn
