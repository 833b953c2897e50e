// Longer scenes from shorter ones, as texts: what a result file carries stays what its run has done.
#pragma once

#include <string>

namespace cairn {

/// The text of a scene followed by that of more stages, which comes from `file` and may hold [[stage]] tables
/// only.
/// @throws InputError with the place in `file` of what is wrong with them, or when the scene does not name
/// its stages by [[stage]].
std::string add_stages(const std::string& scene, const std::string& stages, const std::string& file);

/// The text of a scene whose last stage has this extension (s).
std::string extend_last_stage(const std::string& scene, double extension);

}  // namespace cairn
