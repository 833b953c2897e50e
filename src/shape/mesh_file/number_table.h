// Files of numbers without words.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "shape/mesh_file/file_surface.h"

namespace cairn {

/// The numbers of a text, row by row: the lines that hold any. Commas may stand between all numbers of a row.
struct NumberTable {
  std::string name;  ///< of the file
  std::vector<double> values;
  std::vector<std::size_t> ends;     ///< of the rows
  std::vector<std::uint32_t> lines;  ///< of the rows in the file

  std::size_t rows() const { return ends.size(); }
  std::span<const double> row(std::size_t r) const {
    const std::size_t begin = r == 0 ? 0 : ends[r - 1];
    return {values.data() + begin, ends[r] - begin};
  }
  template <class... Args>
  [[noreturn]] void fail(std::size_t row, fmt::format_string<Args...> words, Args&&... args) const {
    throw InputError("{}:{}: {}", name, lines[std::min(row, lines.size() - 1)],
                     fmt::format(words, std::forward<Args>(args)...));
  }
  /// Number k of a row as a whole number from 0 on.
  std::uint32_t whole(std::size_t row, std::size_t k, std::string_view what) const;
};

/// A grid on the faces of a cube: Q, then 6 (Q + 1)^2 vertices.
bool is_cube_grid(const NumberTable& table);
FileSurface read_cube_grid(const NumberTable& table);

/// Latitude and longitude (degrees; in either order), radius and perhaps more, at every point of a regular
/// grid. Longitudes run west, as in tables of the PDS.
FileSurface read_radius_grid(const NumberTable& table);

/// Adds a quadrilateral, cut along its shorter diagonal.
void add_quadrilateral(FileSurface& surface, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                       std::uint32_t d);

}  // namespace cairn
