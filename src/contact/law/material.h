// Contact parameters of a material and of a pair of materials.
#pragma once

#include <optional>
#include <string>

namespace cairn {

/// k_S / k_N at which both oscillate at one frequency for loose spheres, whose mu_t is this part of mu.
inline constexpr double kTangentialRatio = 2.0 / 7.0;

/// Surface properties of a body or wall [Zhang et al. 2017, 2021]. Defaults: the nominal rubble-pile
/// material.
struct Material {
  std::string name;
  double restitution_normal = 0.55;           ///< e_n, 0..1
  double restitution_tangential = 0.55;       ///< e_t, 0..1
  double friction = 1.0;                      ///< mu_S, Coulomb sliding coefficient
  double friction_rolling = 1.05;             ///< mu_R
  double friction_twisting = 1.3;             ///< mu_T
  double shape_factor = 0.5;                  ///< beta, radius of the contact area over the effective radius
  double cohesion = 0.0;                      ///< c, interparticle tensile strength, Pa
  std::optional<double> stiffness = {};       ///< k_N of two such surfaces, N/m; absent: that of the stage
  double stiffness_ratio = kTangentialRatio;  ///< k_S / k_N of two such surfaces

  bool operator==(const Material&) const = default;
};

/// The mixing rule: restitutions, frictions and cohesion of a pair are geometric means, beta the arithmetic
/// mean. Stiffnesses are mixed by make_pair_law.
Material mix(const Material& a, const Material& b);

}  // namespace cairn
