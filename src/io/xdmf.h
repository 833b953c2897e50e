// The sidecar by which ParaView opens a result file.
#pragma once

#include <filesystem>

#include "io/results.h"

namespace cairn {

/// Writes FILE.xdmf beside a result file: in time, the spheres of every snapshot that has the field
/// sphere_position (N x 3, m), each with the constants in /spheres and the snapshot's own fields whose axis
/// is "sphere". Replaces an older sidecar. Returns its name. Throws InputError.
std::filesystem::path write_xdmf(const ResultFile& result);

}  // namespace cairn
