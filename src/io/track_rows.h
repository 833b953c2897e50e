// Tables of places of a perturber, as a scene or a text file gives them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace cairn {

/// Rows t, x, y, z (s, m), or with vx, vy, vz (m/s); all of one length.
using TrackRows = std::vector<std::vector<double>>;

/// Calls fail(row, what) when times do not increase, and fail(number of rows, what) when the rows are too few
/// for a cubic or do not cover a run of `duration` (s).
void check_track(const TrackRows& rows, double duration,
                 const std::function<void(std::size_t, const std::string&)>& fail);

/// Rows of the text of a file: numbers separated by blanks or commas, '#' begins a comment.
/// @throws InputError naming file and line.
TrackRows parse_track(std::string_view text, const std::string& file, double duration);

}  // namespace cairn
