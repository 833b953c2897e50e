// What mesh files hold, as it stands in them, and the readers of each format. A reader takes every word or
// byte of a file or throws InputError "NAME:LINE: what is wrong" ("NAME: ..." where a file has no lines).
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/math.h"

namespace cairn {

/// Vertices and facets of a file, polygons included.
struct FileSurface {
  std::vector<Vec3> vertices;          ///< in units of the file
  std::vector<std::uint32_t> corners;  ///< of all facets, one facet after the other
  std::vector<std::uint32_t> ends;     ///< of each facet, in `corners`
  std::vector<std::uint32_t> lines;    ///< of each facet; empty where a file has none
  double rounding = std::numeric_limits<double>::epsilon() / 2;  ///< of a coordinate, relative
  std::vector<std::string> notes = {};                           ///< what a user should know of the reading

  /// Ends a facet whose corners have been added.
  void end_facet(std::size_t line = 0) {
    ends.push_back(static_cast<std::uint32_t>(corners.size()));
    if (line > 0) lines.push_back(static_cast<std::uint32_t>(line));
  }
  /// "NAME:LINE" of a facet, or the name alone.
  std::string place(const std::string& name, std::size_t f) const {
    return lines.empty() ? name : name + ':' + std::to_string(lines[f]);
  }
  std::span<const std::uint32_t> facet(std::size_t f) const {
    const std::uint32_t begin = f == 0 ? 0 : ends[f - 1];
    return {corners.data() + begin, ends[f] - begin};
  }
};

/// Relative rounding of numbers of single precision.
inline constexpr double kSingleRounding = 6e-8;

/// Corners that a file counts from 1, or from 0 where a corner 0 leaves no other reading: looks at all of a
/// file, then makes them count from 0.
class CornerCount {
 public:
  void see(std::int64_t corner, std::size_t line) {
    if (corner == 0 && zero_line_ == 0) zero_line_ = line;
    if (corner <= greatest_) return;
    greatest_ = corner;
    greatest_line_ = line;
  }
  /// Corners must be counted from `base`.
  void require(std::int64_t base) { base_ = base; }
  void settle(FileSurface& surface, const std::string& name) const;

 private:
  std::int64_t greatest_ = -1, base_ = -1;
  std::size_t zero_line_ = 0, greatest_line_ = 0;
};

/// Wavefront OBJ: `v` and `f`; numbers of `v` beyond the third are not used, lines and points are left out,
/// curves and free-form surfaces are refused.
FileSurface read_obj(std::string_view bytes, const std::string& name);

/// PLY, ASCII or binary of either byte order.
FileSurface read_ply(std::string_view bytes, const std::string& name);

/// STL, ASCII or binary.
FileSurface read_stl(std::string_view bytes, const std::string& name);

/// OFF, with normals, colours and texture coordinates (NOFF, COFF, STOFF and so on), which are not used.
FileSurface read_off(std::string_view bytes, const std::string& name);

/// Tables of numbers: counts, vertices and facets (plate models of the PDS, those whose vertices are
/// latitude, longitude and radius among them, DAMIT's shape.txt, NAIF's plate-vertex tables and Rosetta's
/// .ver), Gaskell's grids on a cube (ICQ), latitude-longitude-radius grids.
FileSurface read_table(std::string_view bytes, const std::string& name);

/// One of the above, by the first word of the text: for files whose name does not tell.
FileSurface read_unnamed(std::string_view bytes, const std::string& name);

}  // namespace cairn
