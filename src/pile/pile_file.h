// A pile made by an earlier run, as the start of another one.
#pragma once

#include <filesystem>

#include "contact/wall/wall.h"
#include "io/scene.h"
#include "sim/setup.h"

namespace cairn {

/// Bodies, motion, contacts with their law, and stiffness at the end of the finished run in `path`. Shape
/// numbers index the setup's names; materials and walls are those of `scene`, for `walls` see match_walls.
/// Time, ledgers, held gravity and control are not of the pile. What goes on and what is lost is told in the
/// setup's notes and warnings.
/// @throws InputError for a file that is damaged, is not a result file or has not finished, and for a
/// material of a body that is not in the scene.
Setup read_pile(const std::filesystem::path& path, const Scene& scene, const std::vector<Wall>& walls);

}  // namespace cairn
