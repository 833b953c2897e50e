// Contact parameters of a material and of a pair of materials.
#pragma once

#include <string>

namespace cairn {

/// Surface properties of a body or wall [Zhang et al. 2017, 2021]. Defaults: the nominal rubble-pile
/// material.
struct Material {
  std::string name;
  double restitution_normal = 0.55;      ///< e_n, 0..1
  double restitution_tangential = 0.55;  ///< e_t, 0..1
  double friction = 1.0;                 ///< mu_S, Coulomb sliding coefficient
  double friction_rolling = 1.05;        ///< mu_R
  double friction_twisting = 1.3;        ///< mu_T
  double shape_factor = 0.5;             ///< beta, radius of the contact area over the effective radius
  double cohesion = 0.0;                 ///< c, interparticle tensile strength, Pa
};

/// The mixing rule: restitutions, frictions and cohesion of a pair are geometric means, beta the arithmetic
/// mean.
Material mix(const Material& a, const Material& b);

}  // namespace cairn
