// Choice of the normal stiffness and of the time step from what a scene asks of its contacts.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "body/bodies.h"
#include "contact/law/material.h"
#include "contact/law/memory.h"

namespace cairn {

/// What the contacts must bear.
struct ContactDemand {
  double max_overlap = 0.01;  ///< aimed at, of the smaller radius of a pair
  double impact_speed = 0.0;  ///< m/s
  double field = 0.0;         ///< m/s^2, magnitude of the uniform field
  bool self_gravity = false;
  double cohesion = 0.0;       ///< N/m^2, strongest pull of two bodies over R^2: c (2 beta)^2
  double wall_cohesion = 0.0;  ///< the same of a body and a wall
  bool walls = false;
  double wall_load = 0.0;  ///< N, greatest that moves a wall
  double wall_fall = 0.0;  ///< J, greatest that a load gives a wall before it touches
  double wall_mass = 0.0;  ///< kg, least of such a wall
};

/// What one contact bears of a load (N) on a wall, or takes up of the energy with which it falls, at most:
/// all of it, or where the bodies are many 8 times the mean of a layer of them, for force chains.
double load_of_a_contact(const Bodies& bodies, double load);

/// A body and what it meets: another one, or a wall, or one of its kind where it is alone.
struct Encounter {
  std::uint32_t body = 0;
  std::optional<std::uint32_t> other;  ///< none: a wall
};

/// The normal stiffness, and what asks for so much.
struct StiffnessChoice {
  enum class Cause { impact, wall_fall, load };
  double k_n = 0.0;           ///< N/m; 0: nothing loads the contacts
  Cause cause = Cause::load;  ///< a blow of bodies or of a wall under its load, or a load at rest
  std::uint32_t sphere = 0;   ///< whose radius bounds the overlap
  Encounter encounter;
};

/// Smallest normal stiffness that keeps overlaps near the aim, x = max_overlap times the smaller radius of a
/// pair, in every pair that can meet: k >= m (v / x)^2 for impacts, m the lighter body's mass (the effective
/// mass when neighbours, or a wall, hold the other one), and k >= F / x for the static load: pressure at the
/// centre of the pile, or at the foot of a column in the field, on the smaller body's area, 8 times for force
/// chains, and cohesion [Zhang et al. 2017, section 2.2]. A wall that falls under its load with the energy E
/// asks for k >= 2 E' / x^2, E' the part of E that a contact takes up.
StiffnessChoice choose_stiffness(const Bodies& bodies, const ContactDemand& demand);

/// Strongest pull of cohesion over the smaller radius of its pair (N/m), of all pairs that can meet.
double greatest_pull(const Bodies& bodies, const ContactDemand& demand);

/// Escape speed (m/s) from the surface of the pile the bodies would make at 60 % packing, or of a body where
/// that is faster.
double escape_speed(const Bodies& bodies);

/// Half the period of the fastest undamped contact mode, and whose it is.
struct ShortestContact {
  enum class Mode { normal, sliding, rolling };
  double time = 0.0;  ///< s
  Mode mode = Mode::normal;
  Encounter encounter;
};

/// The laws between bodies, and between bodies and walls, which give way when they have a mass.
struct ContactLaws {
  std::size_t materials = 1;
  std::span<const std::uint16_t> material;                         ///< of each body
  std::span<const PairLaw> bodies;                                 ///< materials x materials
  std::span<const PairLaw> walls;                                  ///< walls x materials
  bool rolling = false;                                            ///< rolling or twisting is resisted
  double lightest_wall = std::numeric_limits<double>::infinity();  ///< kg
};

/// That of any two of the bodies, or of a body and a wall, in the worst direction; held bodies are walls to
/// it. No mode of a contact is faster than its time over pi. Exact for two equal bodies in the worst
/// position, an upper bound on the frequency otherwise.
ShortestContact shortest_contact(const Bodies& bodies, const ContactLaws& laws);

/// A pile's coordination adds stiffnesses on one light body; steps longer than this part of the shortest
/// contact time are refused.
inline constexpr double kLongestSafeStep = 0.1;

}  // namespace cairn
