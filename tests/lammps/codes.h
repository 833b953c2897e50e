// One collision as cairn, LAMMPS and the dissected code of dissect.h are given it, and what they make of it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lammps/dissect.h"
#include "physics/experiment.h"
#include "physics/scenes.h"

namespace cairn::lammps {

inline constexpr double kRestitution = 0.55;
inline constexpr double kDensity = 2000.0;  // kg/m^3

/// Two bodies; the second is moved along `from` until they nearly touch.
struct Case {
  std::string name, file;
  Put first, second;
  Vec3 from;
};

struct Surfaces {
  std::string letter, name;
  bool damped, frictional;
};

struct Setting {
  const Case& what;
  Surfaces surfaces;
  int refine = 1;  ///< default time step over the one used
  double stiffening = 1.0;
  const char* damping_mass = "spheres";
};

/// A setting made ready: cairn's bodies before the first step, and the numbers that the others are given.
struct Start {
  Experiment run;
  double dt;  ///< s
  std::uint64_t steps;
  Law law;  ///< with damping_mass = "bodies": c_n and c_s are C / sqrt(k mu)

  explicit Start(const Setting& s);

 private:
  Start(const Setting& s, const Put& second);
};

struct Body {
  Vec3 x, v, w, momentum, force;
};
using Moment = std::array<Body, 2>;
using Track = std::vector<Moment>;  ///< after each step

/// Advances `start`; the others leave it as it is.
Track run_cairn(Start& start);
Track run_dissected(const Start& start, const Conventions& use);
/// Runs `lmp` on in.collision in the present folder, with dashpots C_N = c_n, C_S = c_s in kg/s.
Track run_lammps(const Start& start, double c_n, double c_s);

}  // namespace cairn::lammps
