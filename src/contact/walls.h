// Fixed planes, obeying the contact law with an infinite partner.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "contact/history.h"
#include "contact/kinematics.h"
#include "contact/sweep.h"

namespace cairn {

/// Half-space {x : (x - point).normal < 0} is solid.
struct Plane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the solid
  std::uint16_t material = 0;   ///< index into the plane materials
};

/// The walls of a scene with the histories of their contacts.
class Walls {
 public:
  std::vector<Plane> planes;

  /// Constants of every plane with every body material at normal stiffness k_n (N/m).
  void set_laws(const std::vector<Material>& materials, const std::vector<Material>& plane_materials,
                double k_n);
  /// Makes room for the contacts of `spheres` spheres; histories are cleared.
  void resize(std::size_t spheres);
  /// Adds wall forces and torques to the bodies' wrenches.
  SweepReport sweep(const std::vector<SphereMotion>& motions, const SweepSettings& settings, Bodies& bodies);
  /// Dashpot constants of a touching pair at the present pose.
  void set_damping(const Bodies& bodies, const SweepSettings& settings, std::size_t plane,
                   std::size_t sphere);

  std::size_t touching() const;
  double stored_energy(const Bodies& bodies, const SweepSettings& settings) const;
  /// Touching pairs: i the sphere, j the plane.
  std::vector<ContactRecord> records() const;
  void restore(const std::vector<ContactRecord>& records);

 private:
  const PairLaw& law(const Bodies& bodies, const SweepSettings& settings, std::size_t plane,
                     std::size_t sphere) const;

  std::vector<PairLaw> laws_;  ///< plane x material
  std::size_t materials_ = 0;
  std::vector<ContactMemory<double>> memory_;  ///< plane x sphere; c_n < 0: not touching
  std::size_t spheres_ = 0;
};

}  // namespace cairn
