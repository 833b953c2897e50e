// A stage that relaxes: energy is taken out of the motion inside each pile, not out of its motion as a whole.
#pragma once

#include "sim/step.h"

namespace cairn {

/// Begins the relaxation that the stage asks for, or ends a former one: bodies that touch now, directly or
/// through others, are one pile until the stage ends. Wrenches have been evaluated.
void begin_relaxation(const Physics& physics, State& state, Scratch& scratch);

/// Rate (1/s) of the drag on a pile of that stiffness (N/m), mass (kg) and number of bodies: the scene's, or
/// twice the frequency at which such a pile swings as a whole, 2 sqrt(k_N / m) / n^(1/3), m the mean mass.
double relaxation_rate(const RelaxSpec& relax, double k_n, double mass, std::size_t bodies);

/// After a step: in each pile the velocities and spins less those of the rigid motion that carries its
/// momentum and angular momentum are multiplied by exp(-rate dt), in a periodic box less its translation.
/// Momenta stay as they are; what the kinetic energy loses is booked as ledger.relaxed.
void relax(const Physics& physics, State& state, Scratch& scratch);

/// Whether the motion inside the piles has died away: ten times 1 / rate have passed and its energy is below
/// `quiet` times the gravitational energy (without self-gravity: the elastic energy) at the start of the
/// stage. True only in steps at which this is looked at, about once in 1 / rate.
bool relaxed(const Physics& physics, const State& state, const Scratch& scratch);

}  // namespace cairn
