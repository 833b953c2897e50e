// Constants of a pair and memory of a contact: what outlives a step.
#pragma once

#include "core/triple.h"

namespace cairn {

/// Constants of a pair of materials at the stiffness in force.
struct PairLaw {
  double k_n = 0.0;        ///< normal stiffness, N/m
  double k_s = 0.0;        ///< tangential stiffness, N/m
  double damping_n = 0.0;  ///< C_N / sqrt(k_N mu)
  double damping_s = 0.0;  ///< C_S / sqrt(k_S mu_t)
  double friction = 0.0;   ///< mu_S
  double rolling = 0.0;    ///< mu_R beta
  double twisting = 0.0;   ///< mu_T beta mu_S
  double beta = 0.0;
  double cohesion = 0.0;  ///< c (2 beta)^2, Pa
};

/// What a contact remembers from step to step.
template <class T>
struct ContactMemory {
  T c_n, c_s;             ///< dashpot constants, kg/s, from the effective masses at first touch
  Triple<T> slide, roll;  ///< spring lengths: m, rad
  T twist;                ///< rad
};

}  // namespace cairn
