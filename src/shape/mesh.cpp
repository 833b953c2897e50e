#include "shape/mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/error.h"
#include "shape/mesh_file/file_surface.h"
#include "shape/mesh_file/triangulate.h"

namespace cairn {
namespace {

constexpr double kWeld = 1e-6;                      // of the extent: a few steps of single precision
constexpr double kLargest = 1e15;                   // m
constexpr double kSpoilt = 1e-6, kLost = 1e-3;      // of the extent by rounding: is told, is refused
constexpr std::size_t kMostTriangles = 50'000'000;  // features of a mesh are numbered in 32 bits

using Triangle = std::array<std::uint32_t, 3>;

/// Spreads a number over the bits of a hash.
std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15ull;
  return hash ^ hash >> 32;
}

/// Numbers 0, 1, ... in chains of equal hashes, and of some others.
class Chains {
 public:
  static constexpr std::uint32_t kEnd = std::numeric_limits<std::uint32_t>::max();

  /// For up to `most` numbers.
  explicit Chains(std::size_t most) : heads_(std::bit_ceil(most + 1), kEnd) { next_.reserve(most); }

  std::uint32_t first(std::uint64_t hash) const { return heads_[hash & (heads_.size() - 1)]; }
  std::uint32_t next(std::uint32_t number) const { return next_[number]; }
  void add(std::uint64_t hash) {
    const auto number = static_cast<std::uint32_t>(next_.size());
    next_.push_back(std::exchange(heads_[hash & (heads_.size() - 1)], number));
  }

 private:
  std::vector<std::uint32_t> heads_, next_;
};

/// Finds earlier points within a tolerance, on a grid of cells some tolerances wide.
class Welder {
 public:
  Welder(double tolerance, std::size_t most)
      : tolerance_(tolerance),
        cell_(std::max(16.0 * tolerance, std::numeric_limits<double>::min())),
        cells_(most) {}

  /// Number of the point that `x` coincides with, a new one if there is none.
  std::uint32_t add(const Vec3& x) {
    const auto cell = [&](double shift) -> Eigen::Array3d { return ((x.array() + shift) / cell_).floor(); };
    const Eigen::Array3d low = cell(-tolerance_), high = cell(tolerance_);  // mostly the same
    for (int corner = 0; corner < 8; ++corner) {
      Eigen::Array3d at = low;
      bool seen = false;
      for (int axis = 0; axis < 3; ++axis) {
        if (!(corner >> axis & 1)) continue;
        seen = seen || !(high[axis] > low[axis]);
        at[axis] = high[axis];
      }
      if (seen) continue;
      for (std::uint32_t p = cells_.first(hash(at)); p != Chains::kEnd; p = cells_.next(p)) {
        const double distance = (points[p] - x).norm();
        if (!(distance <= tolerance_)) continue;
        farthest = std::max(farthest, distance);
        return p;
      }
    }
    const auto index = static_cast<std::uint32_t>(points.size());
    points.push_back(x);
    cells_.add(hash(cell(0.0)));
    return index;
  }

  std::vector<Vec3> points;
  double farthest = 0.0;  // between two that became one

 private:
  static std::uint64_t hash(const Eigen::Array3d& cell) {
    std::uint64_t h = 0;
    for (const double c : cell) h = mix(h, std::bit_cast<std::uint64_t>(c + 0.0));  // + 0.0: -0 is 0
    return h;
  }

  double tolerance_, cell_;
  Chains cells_;
};

/// Tells triangles that have the same vertices as one before.
class KnownTriangles {
 public:
  explicit KnownTriangles(std::size_t most) : chains_(most) { known_.reserve(most); }

  /// Whether the triangle is new.
  bool add(Triangle t) {
    std::sort(t.begin(), t.end());
    const std::uint64_t hash = mix(mix(mix(0, t[0]), t[1]), t[2]);
    for (std::uint32_t k = chains_.first(hash); k != Chains::kEnd; k = chains_.next(k))
      if (known_[k] == t) return false;
    chains_.add(hash);
    known_.push_back(t);
    return true;
  }

 private:
  Chains chains_;
  std::vector<Triangle> known_;
};

void check_vertices(const TriangleMesh& mesh, const FileSurface& surface, const Triangulation& cut,
                    const std::string& name) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& x = mesh.vertices[v];
    if ((x.array().abs() < kLargest).all()) continue;
    const auto user = std::find_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
      return std::find(t.begin(), t.end(), v) != t.end();
    });
    const bool used = user != mesh.triangles.end();
    const std::size_t facet = used ? cut.facet[static_cast<std::size_t>(user - mesh.triangles.begin())] : 0;
    throw InputError("{}: {} has a vertex at ({:.6g}, {:.6g}, {:.6g}) m, beyond {:g} m",
                     used ? surface.place(name, facet) : name,
                     used ? facet_of_file(facet) : "no facet, but the file,", x.x(), x.y(), x.z(), kLargest);
  }
}

/// What rounding takes from a mesh that lies far from its origin; nothing is said of others.
/// @throws InputError when too few digits are left.
std::string lost_digits(double farthest, double extent, double rounding, const std::string& name) {
  const double part = rounding * farthest / extent;
  if (!(part > kSpoilt)) return {};
  const std::string where = fmt::format(
      "lies up to {:.3g} m from its origin at an extent of {:.3g} m, so that of the {} precision of its "
      "coordinates {:.0f} digits are left: move it to its centre",
      farthest, extent, rounding < kSingleRounding ? "double" : "single",
      std::max(0.0, std::floor(-std::log10(part))));
  if (part > kLost) throw InputError("{}: {}", name, where);
  return where;
}

}  // namespace

TriangleMesh weld(const TriangleMesh& mesh, double tolerance, Welding* welding,
                  std::span<const std::uint32_t> facet) {
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<char> used(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = 1;
  Welder welder(tolerance, mesh.vertices.size());
  std::vector<std::uint32_t> point(mesh.vertices.size(), unused);
  for (std::size_t v = 0; v < point.size(); ++v)
    if (used[v]) point[v] = welder.add(mesh.vertices[v]);

  TriangleMesh out;
  std::vector<std::uint32_t> number(welder.points.size(), unused);
  Welding done;
  done.farthest = welder.farthest;
  std::uint32_t last_flat = unused, last_copy = unused;  // facets
  KnownTriangles known(mesh.triangles.size());
  done.kept.reserve(mesh.triangles.size());
  out.triangles.reserve(mesh.triangles.size());
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = point[mesh.triangles[n][k]];
    const auto number_of = facet.empty() ? static_cast<std::uint32_t>(n) : facet[n];
    if (!has_area(welder.points[t[0]], welder.points[t[1]], welder.points[t[2]])) {
      done.flat += std::exchange(last_flat, number_of) != number_of;
      continue;
    }
    if (!known.add(t)) {
      done.copies += std::exchange(last_copy, number_of) != number_of;
      continue;
    }
    done.kept.push_back(number_of);
    for (std::uint32_t& v : t) {
      if (number[v] == unused) {
        number[v] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(welder.points[v]);
      }
      v = number[v];
    }
    out.triangles.push_back(t);
  }
  if (welding) *welding = std::move(done);
  return out;
}

TriangleMesh make_mesh(const FileSurface& surface, const std::string& name, double unit, Welding* welding) {
  Triangulation cut = triangulate(surface, name);
  if (cut.triangles.empty()) throw InputError("{}: holds no facet", name);  // of a format without lines
  if (cut.triangles.size() > kMostTriangles)
    throw InputError("{}: expected at most {} triangles, found {}", name, kMostTriangles,
                     cut.triangles.size());
  TriangleMesh mesh;
  mesh.vertices.reserve(surface.vertices.size());
  for (const Vec3& x : surface.vertices) mesh.vertices.push_back(unit * x);
  mesh.triangles = std::move(cut.triangles);
  check_vertices(mesh, surface, cut, name);
  Vec3 low = Vec3::Constant(kLargest), high = -low;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      low = low.cwiseMin(mesh.vertices[v]);
      high = high.cwiseMax(mesh.vertices[v]);
    }
  const double extent = (high - low).norm();
  const std::string far_off = lost_digits(high.cwiseMax(-low).maxCoeff(), extent, surface.rounding, name);
  mesh = weld(mesh, kWeld * extent, welding, cut.facet);
  if (welding) {
    welding->name = name;
    if (!surface.lines.empty())
      for (const std::uint32_t f : welding->kept) welding->lines.push_back(surface.lines[f]);
    welding->notes = surface.notes;
    if (!far_off.empty()) welding->notes.push_back(far_off);
  }
  if (mesh.triangles.empty()) throw InputError("{}: holds no facet with an area", surface.place(name, 0));
  return mesh;
}

std::string obj_text(const TriangleMesh& mesh, double unit, int digits) {
  std::string text;
  auto out = std::back_inserter(text);
  for (const Vec3& x : mesh.vertices)
    fmt::format_to(out, "v {1:.{0}g} {2:.{0}g} {3:.{0}g}\n", digits, x.x() / unit, x.y() / unit,
                   x.z() / unit);
  for (const auto& [a, b, c] : mesh.triangles) fmt::format_to(out, "f {} {} {}\n", a + 1, b + 1, c + 1);
  return text;
}

}  // namespace cairn
