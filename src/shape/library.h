// The shape library: one TOML file per shape, in shapes_lib/ or anywhere the user likes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shape/shape.h"

namespace cairn {

/// Names of the shapes in the library, sorted.
std::vector<std::string> library_names();

/// Reads a shape by library name ("tetrahedron") or by path ("my/grain.toml", relative to `base`).
/// @throws InputError naming file, line, column and key when the file is missing or not a valid shape.
Shape load_shape(const std::string& name_or_path, const std::filesystem::path& base = ".");

/// Where load_shape finds a shape. @throws InputError for a name that is not in the library, and a mesh.
std::filesystem::path shape_path(const std::string& name_or_path, const std::filesystem::path& base);
/// Whether a shape is named by its path; otherwise it is one of the library.
bool is_shape_path(const std::string& name_or_path);

/// Writes a shape file; one that is there is replaced only with `overwrite`. @throws InputError, and leaves
/// what was there, when it cannot be written or its readers would not take it.
void save_shape(const Shape& shape, const std::filesystem::path& path, bool overwrite);

}  // namespace cairn
