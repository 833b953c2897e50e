#include "shape/mesh_file/number_table.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/elementary.h"
#include "core/error.h"
#include "shape/mesh_file/text.h"

namespace cairn {
namespace {

NumberTable read_numbers(std::string_view bytes, const std::string& name) {
  NumberTable table;
  table.name = name;
  Text text(bytes, name, {.comments = true, .commas = true});
  while (text.next_line()) {
    const std::size_t before = table.values.size();
    while (text.more()) table.values.push_back(text.number("a number"));
    const std::size_t found = table.values.size() - before;
    if (text.commas() != 0 && text.commas() != found - 1)
      text.fail("expected commas between all numbers of a line or none, found {} numbers and {} commas",
                found, text.commas());
    table.ends.push_back(table.values.size());
    table.lines.push_back(static_cast<std::uint32_t>(text.line()));
  }
  if (table.rows() == 0) text.fail("expected numbers, found none");
  return table;
}

/// Counts, vertices and facets, the counts together or each before what it counts.
class PlateReader {
 public:
  explicit PlateReader(const NumberTable& table) : table_(table) {}

  FileSurface read() {
    const bool together = table_.row(0).size() == 2;
    vertices_ = table_.whole(0, 0, "the number of vertices");
    if (together) facets_ = table_.whole(0, 1, "the number of facets");
    row_ = 1;
    read_vertices();
    if (!together) {
      require_row("the number of facets");
      if (table_.row(row_).size() != 1)
        table_.fail(
            row_,
            "expected the number of facets after {0} vertices (or 6 x {1} x {1} vertices of a grid on "
            "a cube), found {2} numbers",
            vertices_, std::uint64_t{vertices_} + 1, table_.row(row_).size());
      facets_ = table_.whole(row_++, 0, "the number of facets");
    }
    read_facets();
    if (row_ < table_.rows())
      table_.fail(row_, "expected the end of the file after {} vertices and {} facets", vertices_, facets_);
    count_.settle(surface_, table_.name);
    if (latitude_) place_by_angles();
    return std::move(surface_);
  }

 private:
  void require_row(std::string_view what) {
    if (row_ >= table_.rows())
      table_.fail(row_, "{} vertices and {} are promised, the file ends after {} and {}: expected {}",
                  vertices_, facets_ == 0 ? "facets" : fmt::format("{} facets", facets_),
                  surface_.vertices.size(), surface_.ends.size(), what);
  }

  /// x y z, with their numbers before or without.
  void read_vertices() {
    for (std::uint32_t v = 0; v < vertices_; ++v, ++row_) {
      require_row("a vertex");
      const auto row = table_.row(row_);
      if (v == 0) {
        numbered_ = row.size() == 4;
        if (numbered_) base_ = first_number(row_);
      }
      if (row.size() != (numbered_ ? 4u : 3u))
        table_.fail(row_, "expected a vertex of {} numbers, found {}",
                    v > 0 ? numbered_ ? "4" : "3" : "3 or (with its own) 4", row.size());
      if (numbered_ && row[0] != base_ + v)
        table_.fail(row_, "expected vertex {}, found number {}", base_ + v, row[0]);
      const auto x = row.last(3);
      surface_.vertices.push_back({x[0], x[1], x[2]});
    }
    if (numbered_) count_.require(base_);
    latitude_ = latitude_column();
  }

  std::uint32_t first_number(std::size_t row) const {
    const std::uint32_t first = table_.whole(row, 0, "the number of the first one");
    if (first > 1) table_.fail(row, "expected numbers from 1 or 0 on, found {}", first);
    return first;
  }

  /// Some plate models of comets give latitude, longitude and radius of their vertices, in degrees.
  std::optional<int> latitude_column() const {
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (const Vec3& x : surface_.vertices) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    for (int latitude = 0; latitude < 2; ++latitude)
      if (low[latitude] == -90.0 && high[latitude] == 90.0 && low.z() > 0.0 &&
          high[1 - latitude] - low[1 - latitude] > 270.0 && low[1 - latitude] >= -360.0 &&
          high[1 - latitude] <= 360.0)
        return latitude;
    return {};
  }

  /// Files do not say which way their longitudes run. Their facets do, for they face outwards.
  void place_by_angles() {
    for (Vec3& x : surface_.vertices) {
      const double latitude = x[*latitude_] * kPi / 180.0, longitude = x[1 - *latitude_] * kPi / 180.0;
      const double across = std::abs(x[*latitude_]) == 90.0 ? 0.0 : sine_and_cosine(latitude).cosine;
      x = x.z() * Vec3(across * sine_and_cosine(longitude).cosine, across * sine_and_cosine(longitude).sine,
                       sine_and_cosine(latitude).sine);
    }
    double volume = 0.0;
    for (std::size_t f = 0; f < surface_.ends.size(); ++f) {
      const auto corner = surface_.facet(f);
      for (std::size_t k = 2; k < corner.size(); ++k)
        volume += surface_.vertices[corner[0]].dot(
            surface_.vertices[corner[k - 1]].cross(surface_.vertices[corner[k]]));
    }
    if (volume < 0.0)
      for (Vec3& x : surface_.vertices) x.y() = -x.y();
    surface_.notes.push_back(
        fmt::format("vertices are taken for latitude, longitude and radius, and longitudes to run {}, so "
                    "that facets face "
                    "outwards",
                    volume < 0.0 ? "west" : "east"));
  }

  /// i j k; with its number before; or with the number of its corners before, on the same line or on its own.
  void read_facets() {
    if (facets_ == 0) table_.fail(row_ - 1, "expected a facet or more, found none");
    enum class Form { plain, numbered, counted } form = Form::plain;
    std::uint32_t base = 0;
    for (std::uint32_t f = 0; f < facets_; ++f, ++row_) {
      require_row("a facet");
      auto row = table_.row(row_);
      if (f == 0 && row.size() != 3) {
        const bool counted = row[0] >= 3.0 && (row.size() == 1 || row.size() == row[0] + 1.0);
        form = counted ? Form::counted : Form::numbered;
        if (!counted && row.size() == 4) base = first_number(row_);
      }
      std::size_t corners = 3, first = form == Form::plain ? 0 : 1;
      if (form == Form::counted) {
        corners = table_.whole(row_, 0, "the number of corners");
        if (corners < 3) table_.fail(row_, "expected a facet of 3 corners or more, found {}", corners);
        if (row.size() == 1) {
          ++row_;
          require_row("the corners of a facet");
          row = table_.row(row_);
          first = 0;
        }
      }
      if (row.size() != first + corners)
        table_.fail(row_, "expected a facet of {} numbers, found {}", first + corners, row.size());
      if (form == Form::numbered && row[0] != base + f)
        table_.fail(row_, "expected facet {}, found number {}", base + f, row[0]);
      for (std::size_t k = 0; k < corners; ++k) {
        const std::uint32_t corner = table_.whole(row_, first + k, "a corner");
        count_.see(corner, table_.lines[row_]);
        surface_.corners.push_back(corner);
      }
      surface_.end_facet(table_.lines[row_]);
    }
  }

  const NumberTable& table_;
  FileSurface surface_;
  CornerCount count_;
  std::size_t row_ = 0;
  std::uint32_t vertices_ = 0, facets_ = 0, base_ = 0;
  bool numbered_ = false;        // vertices
  std::optional<int> latitude_;  // column of the vertices; none: they are x, y and z
};

}  // namespace

std::uint32_t NumberTable::whole(std::size_t r, std::size_t k, std::string_view what) const {
  const double value = row(r)[k];
  if (!(value >= 0.0 && value <= std::numeric_limits<std::uint32_t>::max()) || value != std::floor(value))
    fail(r, "expected {}, found {}", what, value);
  return static_cast<std::uint32_t>(value);
}

bool is_cube_grid(const NumberTable& table) {
  const double q = table.row(0)[0];
  return table.row(0).size() == 1 && q >= 1.0 && q < 1e4 && q == std::floor(q) &&
         static_cast<double>(table.rows()) == 1.0 + 6.0 * (q + 1.0) * (q + 1.0) &&
         table.values.size() == 1 + 3 * (table.rows() - 1) && table.row(table.rows() - 1).size() == 3;
}

FileSurface read_cube_grid(const NumberTable& table) {
  const std::uint32_t side = table.whole(0, 0, "the number of cells of a side") + 1;
  FileSurface surface;
  for (std::size_t r = 1; r < table.rows(); ++r) {
    const auto x = table.row(r);
    if (x.size() != 3) table.fail(r, "expected a vertex of 3 numbers, found {}", x.size());
    surface.vertices.push_back({x[0], x[1], x[2]});
  }
  for (std::uint32_t face = 0; face < 6; ++face)
    for (std::uint32_t j = 0; j + 1 < side; ++j)
      for (std::uint32_t i = 0; i + 1 < side; ++i) {
        const std::uint32_t a = (face * side + j) * side + i;
        add_quadrilateral(surface, a, a + 1, a + side + 1, a + side);
      }
  surface.notes.push_back(fmt::format("a grid of 6 x {0} x {0} cells on a cube", side - 1));
  return surface;
}

void add_quadrilateral(FileSurface& surface, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                       std::uint32_t d) {
  const auto length = [&](std::uint32_t p, std::uint32_t q) {
    return (surface.vertices[p] - surface.vertices[q]).squaredNorm();
  };
  const bool turned = length(b, d) < length(a, c);
  const std::array<std::uint32_t, 6> corners =
      turned ? std::array{a, b, d, b, c, d} : std::array{a, b, c, a, c, d};
  for (std::size_t k = 0; k < 6; ++k) {
    surface.corners.push_back(corners[k]);
    if (k % 3 == 2) surface.end_facet();
  }
}

FileSurface read_table(std::string_view bytes, const std::string& name) {
  const NumberTable table = read_numbers(bytes, name);
  if (is_cube_grid(table)) return read_cube_grid(table);
  const std::size_t first = table.row(0).size();
  if (first <= 2) return PlateReader(table).read();
  return read_radius_grid(table);
}

}  // namespace cairn
