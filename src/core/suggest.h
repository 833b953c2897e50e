// "Did you mean ...?"
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cairn {

/// The known name that `name` most probably stands for (fewest edits), or "" if none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace cairn
