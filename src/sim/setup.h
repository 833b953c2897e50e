// What a run starts from: bodies, and what their numbers refer to.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/former_stage.h"

namespace cairn {

struct Setup {
  Bodies bodies;
  Frame frame;  ///< of the bodies at the start
  Frame shift;  ///< the same from the zero of the scene
  Box box;
  HeldBodies held;
  std::vector<std::string> wall_sets;      ///< that Bodies::wall_set counts, see set_of_walls
  std::vector<std::string> shapes;         ///< name of each shape number
  std::vector<ContactRecord> contacts;     ///< of a pile read from a file, as leave_stiffness leaves them
  std::vector<WallContact> wall_contacts;  ///< the same, with the walls of the scene
  std::vector<double> wall_lead;           ///< s, see State; empty: 0
  DrivenWalls driven;                      ///< of the scene, as the pile's file has left them
  double region_volume = 0.0;              ///< m^3, see State
  double k_n = 0.0;                        ///< N/m, stiffness those contacts had; 0: none
  std::optional<FormerStage> former;       ///< whose contacts those were, if that is known
  std::vector<std::string> notes;          ///< on what is taken over from the file, in a line each
  std::vector<std::string> warnings;       ///< and on what is not
};

/// The state in which a run of this setup begins, before its first stage; it has no contacts yet.
inline State first_state(Setup setup) {
  State state;
  state.remnant.assign(setup.bodies.size(), 1);
  state.bodies = std::move(setup.bodies);
  state.frame = setup.frame;
  state.shift = setup.shift;
  state.box = setup.box;
  state.held = std::move(setup.held);
  state.k_n = setup.k_n;
  state.region_volume = setup.region_volume;
  state.walls.contacts = std::move(setup.wall_contacts);
  state.wall_lead = std::move(setup.wall_lead);
  state.walls.driven = std::move(setup.driven);
  return state;
}

}  // namespace cairn
