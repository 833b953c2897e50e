// One shape file: TOML with `name`, optionally `description`, one [[sphere]] table a sphere, and for spheres
// that stand for a mesh the tables [mesh] (its mass properties), [error] (how well they do) and, optionally,
// [fit] (how to fit them again). Where the mass is not spread as the scene's mass model says, spheres have a
// `mass` (relative to each other), or the table [body] an `inertia` (per mass, about the centre of mass) and
// a `center_of_mass`.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shape/shape.h"

namespace cairn {

/// What files and the command line call them.
inline const std::vector<std::pair<std::string, FitStrategy>> kStrategyNames{{"best", FitStrategy::best},
                                                                             {"greedy", FitStrategy::greedy}};
inline const std::vector<std::pair<std::string, MassModel>> kMassModelNames{
    {"mesh", MassModel::mesh}, {"union", MassModel::union_volume}, {"spheres", MassModel::spheres}};

/// Reads a shape from TOML text; `file` is the name that messages give it.
/// @throws InputError "file:line:column: key 'x': what was expected".
Shape parse_shape(std::string_view text, const std::string& file);

/// The text of a shape file, which reads back as the same shape.
std::string shape_text(const Shape& shape);

}  // namespace cairn
