// One shape file: TOML with `name`, optionally `description`, and one [[sphere]] table a sphere.
#pragma once

#include <string>
#include <string_view>

#include "shape/shape.h"

namespace cairn {

/// Reads a shape from TOML text; `file` is the name that messages give it.
/// @throws InputError "file:line:column: key 'x': what was expected".
Shape parse_shape(std::string_view text, const std::string& file);

}  // namespace cairn
