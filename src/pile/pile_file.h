// A pile made by an earlier run, as the start of another one.
#pragma once

#include <filesystem>
#include <vector>

#include "contact/law/material.h"
#include "sim/setup.h"

namespace cairn {

/// Bodies, motion, contacts and stiffness at the end of the finished run in `path`. Shape numbers index the
/// setup's names, material numbers index `materials`, where the file's are looked up by name.
/// @throws InputError for a file that is damaged, is not a result file or has not finished, and for a
/// material that is not among `materials`.
Setup read_pile(const std::filesystem::path& path, const std::vector<Material>& materials);

}  // namespace cairn
