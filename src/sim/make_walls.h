// The walls of a scene.
#pragma once

#include <set>

#include "contact/walls.h"
#include "io/scene.h"

namespace cairn {

/// The walls of the scene; the material of each is its own in Physics::wall_materials.
/// @throws InputError naming the wall's place in the scene when the file of a mesh cannot be used.
std::vector<Wall> make_walls(const Scene& scene);

/// Lets walls begin as far into their motion as they are said to be (s each; none: not at all).
void lead_walls(const std::vector<double>& lead, std::vector<Wall>& walls);

/// Those of them that are there in a stage, their motion as if it began at time 0, and those under a load
/// where this has moved them.
Walls walls_of_stage(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls,
                     const DrivenWalls& driven);

/// Makes the walls of the stage act; `stage_starts` holds when the stages until this one began (s). Contacts
/// of walls that are not there end.
void set_walls(const Scene& scene, std::size_t stage, const std::vector<Wall>& walls,
               const std::vector<double>& stage_starts, Walls& acting);

/// Walls by their names, as Setup::wall_sets holds them: ",floor,lid,".
std::string set_of_walls(const std::vector<std::string>& names);
/// The names in such sets, each once.
std::set<std::string> names_of_walls(const std::vector<std::string>& sets);
/// For each of such sets and each wall of the scene whether it is among them, see Walls::sets.
std::vector<std::vector<std::uint8_t>> touching_walls(const Scene& scene,
                                                      const std::vector<std::string>& sets);

/// Greatest height (m) that a body can fall under the field (m/s^2) on another or on a wall.
double drop_height(const Bodies& bodies, const std::vector<Wall>& walls, const Vec3& field);

/// Greatest speed (m/s) of a wall where bodies can touch it, a load's part left out.
double greatest_wall_speed(const Bodies& bodies, const std::vector<Wall>& walls);

/// How far (m) its load moves a wall before it touches the first body, were all bodies at rest; 0: one
/// touches it, or the load leads away from them. Of a wall that is not a plane this is the distance from the
/// body, or of a mesh that of their extents along the load's axis.
double fall_of_wall(const Bodies& bodies, const Walls& walls, std::size_t wall);

}  // namespace cairn
