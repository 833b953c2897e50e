// Walls of every kind, obeying the contact law with a partner of infinite radius and mass.
#pragma once

#include <tuple>
#include <vector>

#include "body/bodies.h"
#include "contact/kinematics.h"
#include "contact/sweep.h"
#include "contact/wall/loads.h"
#include "contact/wall/wall.h"
#include "contact/wall/wall_candidates.h"

namespace cairn {

/// One touching pair of a sphere and a feature of a wall.
struct WallContact {
  std::uint32_t sphere, wall, feature;
  ContactMemory<double> memory;
};

/// The order of Walls::contacts.
inline bool in_order(const WallContact& a, const WallContact& b) {
  return std::tuple(a.sphere, a.wall, a.feature) < std::tuple(b.sphere, b.wall, b.feature);
}

/// What a sweep over the walls reports.
struct WallReport {
  double dissipated = 0.0;     ///< J, lost in this step
  double power = 0.0;          ///< W, that the walls give the bodies and springs now
  double kicked = 0.0;         ///< J, given by the kicks of contacts that began or ended
  double overlap_ratio = 0.0;  ///< greatest overlap over the sphere's radius, and whose it is
  std::uint32_t sphere = 0, wall = 0;

  WallReport& operator+=(const WallReport& other);
};

/// The greatest overlap with a wall.
struct DeepestTouch {
  double ratio = 0.0;                  ///< over the sphere's radius; 0: none
  std::uint32_t sphere = 0, wall = 0;  ///< the wall's number in the scene
};

/// The walls of a scene with the histories of their contacts.
class Walls {
 public:
  std::vector<Wall> walls;
  std::vector<std::vector<std::uint8_t>> sets;  ///< of Bodies::wall_set, from 1: whether it touches each
                                                ///< wall of the scene
  DrivenWalls driven;
  std::vector<std::uint32_t> number;  ///< of each in the scene; empty: they are the scene's
  std::vector<WallContact> contacts;  ///< in the order of sphere, wall, feature; `wall` indexes `walls`
  WallLoads loads;                    ///< by the walls' numbers in the scene

  bool empty() const { return walls.empty(); }
  /// Makes room for what is kept of each wall of the scene.
  void resize(std::size_t count) {
    loads.resize(count);
    driven.resize(count);
  }
  /// Number in the scene of a wall.
  std::uint32_t scene_number(std::size_t wall) const {
    return number.empty() ? static_cast<std::uint32_t>(wall) : number[wall];
  }
  /// The contacts with their walls' numbers in the scene.
  std::vector<WallContact> numbered_contacts() const;
  /// Constants of every wall with every body material at normal stiffness k_n (N/m).
  void set_laws(const std::vector<Material>& materials, const std::vector<Material>& wall_materials,
                double k_n);
  /// Adds wall forces and torques at `time` (s) to the bodies' wrenches, and takes down the loads. What a
  /// sphere remembers of a part of a mesh passes to the part it has rolled or slid on to.
  WallReport sweep(const std::vector<SphereMotion>& motions, const SweepSettings& settings, double time,
                   WallCandidates& candidates, Bodies& bodies);
  /// Dashpot constants of all contacts as a stage begins at `time` (s). `before`, `settings_before`: the
  /// walls, with their laws, and the settings of the one that the contacts come from; null where bodies may
  /// have changed since.
  void renew_damping(const Bodies& bodies, const Walls* before, const SweepSettings* settings_before,
                     const SweepSettings& settings, double time);
  /// Energy (J) in the springs of the contacts.
  double stored_energy(const Bodies& bodies, const SweepSettings& settings, double time) const;
  /// Kinetic energy (J) of walls under a load.
  double kinetic_energy() const;
  /// The greatest overlap.
  DeepestTouch deepest(const Bodies& bodies, double time) const;
  /// @throws InputError when the contacts, read from a file, are not of these walls and spheres.
  void check_contacts(std::size_t spheres) const;

 private:
  class Sweeper;

  const PairLaw& law(const Bodies& bodies, const SweepSettings& settings, std::uint32_t wall,
                     std::uint32_t sphere) const {
    return laws_[wall * materials_ + settings.material[bodies.spheres.body[sphere]]];
  }
  std::vector<WallPose> poses(double time) const;
  EffectiveMass effective_mass(const Bodies& bodies, const WallPose& pose, const WallTouch& touch,
                               std::uint32_t wall, std::uint32_t sphere) const;
  /// Returns the effective mass along the normal (kg).
  double set_damping(const Bodies& bodies, const SweepSettings& settings, const WallPose& pose,
                     const WallTouch& touch, WallContact& contact) const;
  /// Adds to the pose that a wall's motion alone gives what its load has done, a time `ago` (s) within a
  /// step.
  void drive(std::size_t wall, double ago, WallPose& pose) const;
  std::vector<WallPose> poses_before(double time, double dt) const;
  std::vector<WallPose> mid_step(double time, double dt) const;
  WallFilter filter(const Bodies& bodies) const;
  void begin_step(double dt);
  void end_step(const std::vector<WallLoad>& now, double dt);

  std::vector<PairLaw> laws_;  // wall x material
  std::size_t materials_ = 0;
};

}  // namespace cairn
