#include <algorithm>
#include <cmath>
#include <utility>

#include "shape/mesh_file/number_table.h"

#include "core/elementary.h"

namespace cairn {
namespace {

constexpr double kSame = 1e-6;     // of a radius: two records of one point
constexpr double kRegular = 0.02;  // of a step of the grid: angles are rounded in print

/// The angles of a column without their repetitions, ascending.
std::vector<double> distinct(const NumberTable& table, std::size_t column) {
  std::vector<double> angles;
  for (std::size_t r = 0; r < table.rows(); ++r) angles.push_back(table.row(r)[column]);
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end()), angles.end());
  return angles;
}

class GridReader {
 public:
  explicit GridReader(const NumberTable& table) : table_(table) {}

  FileSurface read() {
    const std::size_t columns = table_.row(0).size();
    for (std::size_t r = 0; r < table_.rows(); ++r)
      if (table_.row(r).size() != columns)
        table_.fail(r, "expected {} numbers as in the lines before, found {}", columns, table_.row(r).size());
    find_columns();
    check_steps();
    read_radii();
    make_surface();
    if (columns > 3)
      surface_.notes.push_back(fmt::format("numbers after the third of {} are not used", columns));
    surface_.notes.push_back(
        "longitudes are taken to run west, as in the PDS's tables: where they run east, give them the other "
        "sign, or the body is its mirror image");
    return std::move(surface_);
  }

 private:
  /// Latitudes reach from pole to pole and no further, longitudes go round.
  void find_columns() {
    for (const std::size_t k : {1u, 0u}) {
      latitudes_ = distinct(table_, k);
      longitudes_ = distinct(table_, 1 - k);
      if (latitudes_.front() == -90.0 && latitudes_.back() == 90.0 && latitudes_.size() > 2 &&
          longitudes_.front() >= -360.0 && longitudes_.back() <= 360.0 &&
          longitudes_.back() - longitudes_.front() > 180.0) {
        latitude_ = k;
        return;
      }
    }
    table_.fail(
        table_.rows(),
        "expected counts, or a grid of latitudes from -90 to 90, longitudes round the body and radii; "
        "found columns from {} to {} and from {} to {}",
        latitudes_.front(), latitudes_.back(), longitudes_.front(), longitudes_.back());
  }

  void check_steps() {
    const auto regular = [&](const std::vector<double>& angles, double whole, std::string_view what) {
      const double step =
          whole /
          std::round(whole / ((angles.back() - angles.front()) / static_cast<double>(angles.size() - 1)));
      for (std::size_t k = 1; k < angles.size(); ++k)
        if (!(std::abs(angles[k] - angles[k - 1] - step) <= kRegular * step))
          table_.fail(table_.rows(), "expected {} at steps of {:.6g} degrees, found {} and {} as neighbours",
                      what, step, angles[k - 1], angles[k]);
      return step;
    };
    regular(latitudes_, 180.0, "latitudes");
    const double step = regular(longitudes_, 360.0, "longitudes");
    const double gap = longitudes_.front() + 360.0 - longitudes_.back();
    closed_ = std::abs(gap) <= kRegular * step;  // the first one again as the last
    if (!closed_ && std::abs(gap - step) > kRegular * step)
      table_.fail(table_.rows(), "expected longitudes all round, found none between {} and {}",
                  longitudes_.back(), longitudes_.front() + 360.0);
  }

  static std::size_t index(const std::vector<double>& angles, double angle) {
    return static_cast<std::size_t>(std::lower_bound(angles.begin(), angles.end(), angle) - angles.begin());
  }
  std::size_t round() const { return longitudes_.size() - (closed_ ? 1 : 0); }
  bool is_pole(std::size_t row) const { return row == 0 || row + 1 == latitudes_.size(); }
  double& radius(std::size_t row, std::size_t column) {
    return radii_[row * round() + (is_pole(row) ? 0 : column % round())];
  }

  void read_radii() {
    radii_.assign(latitudes_.size() * round(), 0.0);
    std::vector<char> seen(latitudes_.size() * longitudes_.size(), 0);
    for (std::size_t r = 0; r < table_.rows(); ++r) {
      const auto row = table_.row(r);
      const std::size_t i = index(latitudes_, row[latitude_]), j = index(longitudes_, row[1 - latitude_]);
      if (!(row[2] > 0.0)) table_.fail(r, "expected a positive radius, found {}", row[2]);
      if (std::exchange(seen[i * longitudes_.size() + j], 1))
        table_.fail(r, "latitude {}, longitude {} for a second time", row[latitude_], row[1 - latitude_]);
      double& known = radius(i, j);
      if (known == 0.0) known = row[2];
      if (!(std::abs(known - row[2]) <= kSame * known))
        table_.fail(r, "expected the radius {} as before at the same point, found {}", known, row[2]);
    }
    for (std::size_t i = 0; i < latitudes_.size(); ++i)
      for (std::size_t j = 0; j < round(); ++j)
        if (radius(i, j) == 0.0)
          table_.fail(table_.rows(), "no radius for latitude {}, longitude {}", latitudes_[i],
                      longitudes_[j]);
  }

  void make_surface() {
    const auto ring = static_cast<std::uint32_t>(round());
    const auto rows = static_cast<std::uint32_t>(latitudes_.size());
    for (std::uint32_t i = 0; i < rows; ++i)
      for (std::uint32_t j = 0; j < (is_pole(i) ? 1 : ring); ++j) {
        const double latitude = latitudes_[i] * kPi / 180.0, longitude = -longitudes_[j] * kPi / 180.0;
        const double across = is_pole(i) ? 0.0 : sine_and_cosine(latitude).cosine;
        surface_.vertices.push_back(radius(i, j) * Vec3(across * sine_and_cosine(longitude).cosine,
                                                        across * sine_and_cosine(longitude).sine,
                                                        sine_and_cosine(latitude).sine));
      }
    const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return 1 + (i - 1) * ring + j % ring; };
    const std::uint32_t last = 1 + (rows - 2) * ring;
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      for (const std::uint32_t corner : {a, b, c}) surface_.corners.push_back(corner);
      surface_.end_facet();
    };
    for (std::uint32_t j = 0; j < ring; ++j) triangle(0, vertex(1, j), vertex(1, j + 1));
    for (std::uint32_t i = 1; i + 2 < rows; ++i)
      for (std::uint32_t j = 0; j < ring; ++j)
        add_quadrilateral(surface_, vertex(i, j + 1), vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
    for (std::uint32_t j = 0; j < ring; ++j) triangle(last, vertex(rows - 2, j + 1), vertex(rows - 2, j));
  }

  const NumberTable& table_;
  FileSurface surface_;
  std::size_t latitude_ = 0;  // its column
  std::vector<double> latitudes_, longitudes_, radii_;
  bool closed_ = false;
};

}  // namespace

FileSurface read_radius_grid(const NumberTable& table) {
  return GridReader(table).read();
}

}  // namespace cairn
