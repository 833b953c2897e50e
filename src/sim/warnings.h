// What looks wrong about a stage, though it can be run.
#pragma once

#include <string>
#include <vector>

#include "sim/physics.h"

namespace cairn {

/// What looks wrong whatever the bodies do: a perturber whose orbit leads inside its radius, a wall so light
/// that it shortens the time step, contacts that are cohesive and nearly elastic.
std::vector<std::string> lasting_warnings(const Physics& physics);

/// That, and what looks wrong about the motion of bodies and walls at the start of a stage: blows deeper than
/// the overlap limit, what could pass through each other unseen, turns or swings too far in one step, or is
/// too far away.
std::vector<std::string> warnings(const Physics& physics, const Bodies& bodies, const Walls& acting);

}  // namespace cairn
