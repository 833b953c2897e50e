// The walls of a scene.
#pragma once

#include "contact/walls.h"
#include "io/results.h"
#include "io/scene.h"

namespace cairn {

/// The meshes of the scene's walls, one for each wall that is a mesh, at their places.
/// @throws InputError naming the wall's place in the scene when a file cannot be used.
std::vector<TriangleMesh> load_wall_meshes(const Scene& scene);

/// The walls of the scene; the material of each is its own in Physics::wall_materials.
std::vector<Wall> make_walls(const Scene& scene, std::vector<TriangleMesh> meshes);
inline std::vector<Wall> make_walls(const Scene& scene) {
  return make_walls(scene, load_wall_meshes(scene));
}

/// Those of them that are there in a stage, their motion as if it began at time 0.
std::vector<Wall> walls_of_stage(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls);

/// Makes the walls of the stage act; `stage_starts` holds when the stages until this one began (s). Contacts
/// of walls that are not there end.
void set_walls(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls,
               const std::vector<double>& stage_starts, Walls& acting);

/// Result files carry the meshes, so that a run can be resumed without the files they came from.
void write_wall_meshes(ResultFile& file, const std::vector<TriangleMesh>& meshes);
/// @throws InputError naming the file when it does not hold the meshes of this scene's walls.
std::vector<TriangleMesh> read_wall_meshes(const ResultFile& file, const Scene& scene);

/// Greatest height (m) that a body can fall under the field (m/s^2) on another or on a wall.
double drop_height(const Bodies& bodies, const std::vector<Wall>& walls, const Vec3& field);

/// Greatest speed (m/s) of a wall where bodies can touch it.
double greatest_wall_speed(const Bodies& bodies, const std::vector<Wall>& walls);

}  // namespace cairn
