// What the walls of an earlier run hand on to those of a scene that starts from its pile.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "io/scene.h"
#include "sim/former_stage.h"

namespace cairn {

inline constexpr std::uint32_t kNoWall = std::numeric_limits<std::uint32_t>::max();

/// Springs, and how far moving walls have come.
struct WallHeritage {
  std::vector<WallContact> contacts;  ///< by the walls' numbers in the scene, in the order of
                                      ///< Walls::contacts, as leave_stiffness leaves them
  std::vector<double> lead;           ///< s, of each wall of the scene, that it has moved before, see State
  DrivenWalls driven;                 ///< of each wall of the scene
  Walls ending;  ///< of the former run at its end, `number`: in the scene, kNoWall: not there
  std::vector<std::string> notes;     ///< what goes on, in a line each
  std::vector<std::string> warnings;  ///< what is lost, in a line each
};

/// The end of the run that a pile comes from.
struct FormerRun {
  std::string name;  ///< of its file
  const Scene& scene;
  const State& state;
  const FormerStage& last;            ///< that has taken time, or else its first one; without walls
  std::vector<WallContact> contacts;  ///< by the walls' numbers in its scene, as its checkpoint has them
};

/// Matches the walls of the first stage of `scene` with those of a former run; its bodies are `shift` away in
/// the scene. Walls are the same when they are equal in kind, geometry and place and of materials equal in
/// name or in values. A wall that moves is looked for first where the same motion has brought it, and then
/// goes on with it, unless the scene gives its motion_time; one under a load goes on from where it was.
/// @throws InputError when the contacts are not of the run's walls, or these cannot be made.
WallHeritage match_walls(const FormerRun& former, const Scene& scene, const std::vector<Wall>& walls,
                         const Frame& shift);

/// Whether two materials have equal values, whatever they are called.
bool same_values(const Material& a, const Material& b);

}  // namespace cairn
