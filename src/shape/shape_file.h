// One shape file: TOML with `name`, optionally `description`, one [[sphere]] table a sphere, and for spheres
// that stand for a mesh the tables [mesh] (its mass properties), [error] (how well they do) and, optionally,
// [fit] (how to fit them again).
#pragma once

#include <string>
#include <string_view>

#include "shape/shape.h"

namespace cairn {

/// Reads a shape from TOML text; `file` is the name that messages give it.
/// @throws InputError "file:line:column: key 'x': what was expected".
Shape parse_shape(std::string_view text, const std::string& file);

/// The text of a shape file, which reads back as the same shape.
std::string shape_text(const Shape& shape);

}  // namespace cairn
