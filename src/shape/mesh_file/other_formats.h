// Formats that are read by the assimp library.
#pragma once

#include <filesystem>
#include <string>

#include "shape/mesh_file/file_surface.h"

namespace cairn {

/// Whether assimp reads files with this extension (lower case, without its dot) as surfaces.
bool is_other_format(const std::string& kind);

/// Reads glTF, FBX, COLLADA, 3MF and others, every part where the file's scene puts it, in another process.
/// Coordinates have single precision, and assimp does not tell of what it does not understand: a note says
/// so.
/// @throws InputError when it cannot read the file within a minute.
FileSurface read_other_format(const std::filesystem::path& path, const std::string& kind);

}  // namespace cairn
