#include "shape/mesh.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <unordered_map>

#include "core/error.h"
#include "shape/mesh_file.h"

namespace cairn {
namespace {

constexpr double kWeld = 1e-6;                      // of the extent: a few steps of single precision
constexpr std::size_t kMostCorners = 256;           // of a polygon
constexpr double kFlat = 1e-9;                      // sine of the corners of a triangle without area
constexpr double kLargest = 1e15;                   // m
constexpr std::size_t kMostTriangles = 50'000'000;  // features of a mesh are numbered in 32 bits

using Triangle = std::array<std::uint32_t, 3>;

/// Finds earlier points within a tolerance, on a grid of cells as wide as the tolerance.
class Welder {
 public:
  explicit Welder(double tolerance) : tolerance_(tolerance) {}

  /// Number of the point that `x` coincides with, a new one if there is none.
  std::uint32_t add(const Vec3& x) {
    const double cell = tolerance_ > 0.0 ? tolerance_ : std::numeric_limits<double>::min();
    const Eigen::Array3d at = (x.array() / cell).floor();
    for (double i = -1; i <= 1; ++i)
      for (double j = -1; j <= 1; ++j)
        for (double k = -1; k <= 1; ++k) {
          const auto [first, last] = cells_.equal_range(hash(at + Eigen::Array3d(i, j, k)));
          for (auto it = first; it != last; ++it)
            if ((points[it->second] - x).norm() <= tolerance_) return it->second;
        }
    const auto index = static_cast<std::uint32_t>(points.size());
    points.push_back(x);
    cells_.emplace(hash(at), index);
    return index;
  }

  std::vector<Vec3> points;

 private:
  static std::size_t hash(const Eigen::Array3d& cell) {
    std::size_t h = 0;
    for (const double c : {cell.x(), cell.y(), cell.z()})
      h = (h ^ std::hash<double>{}(c + 0.0)) * 0x9E3779B97F4A7C15ull;  // + 0.0: -0 is 0
    return h;
  }

  double tolerance_;
  std::unordered_multimap<std::size_t, std::uint32_t> cells_;
};

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() > kFlat * longest;
}

/// Cuts a polygon with corners `p` into triangles: ears, corners that bend outwards and have no other corner
/// below them, are cut off until three corners are left.
void cut(const std::vector<Vec3>& x, std::vector<std::uint32_t> p, std::vector<Triangle>& triangles) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 0; k + 1 < p.size(); ++k) normal += (x[p[k]] - x[p[0]]).cross(x[p[k + 1]] - x[p[0]]);
  while (p.size() >= 3) {
    const auto corner = [&](std::size_t k) { return p[k % p.size()]; };
    const auto is_ear = [&](std::size_t k) {
      const Vec3 &a = x[corner(k)], &b = x[corner(k + 1)], &c = x[corner(k + 2)];
      const auto left_of = [&](const Vec3& from, const Vec3& to, const Vec3& q) {
        return normal.dot((to - from).cross(q - from)) > 0.0;
      };
      if (!left_of(a, b, c)) return false;
      for (std::size_t j = 3; j < p.size(); ++j) {
        const Vec3& q = x[corner(k + j)];
        if (left_of(a, b, q) && left_of(b, c, q) && left_of(c, a, q)) return false;
      }
      return true;
    };
    std::size_t ear = 0;
    while (ear < p.size() && !is_ear(ear)) ++ear;
    if (ear == p.size()) ear = 0;  // a polygon that crosses itself or has no area
    triangles.push_back({corner(ear), corner(ear + 1), corner(ear + 2)});
    p.erase(p.begin() + static_cast<std::ptrdiff_t>((ear + 1) % p.size()));
  }
}

}  // namespace

TriangleMesh weld(const TriangleMesh& mesh, double tolerance) {
  Welder welder(tolerance);
  std::vector<std::uint32_t> point(mesh.vertices.size());
  for (std::size_t v = 0; v < point.size(); ++v) point[v] = welder.add(mesh.vertices[v]);

  TriangleMesh out;
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(welder.points.size(), unused);
  std::set<Triangle> known;
  for (const Triangle& triangle : mesh.triangles) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = point[triangle[k]];
    if (!has_area(welder.points[t[0]], welder.points[t[1]], welder.points[t[2]])) continue;
    Triangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (!known.insert(sorted).second) continue;
    for (std::uint32_t& v : t) {
      if (number[v] == unused) {
        number[v] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(welder.points[v]);
      }
      v = number[v];
    }
    out.triangles.push_back(t);
  }
  return out;
}

TriangleMesh parse_mesh(std::string_view bytes, const std::string& kind, const std::string& name,
                        double unit) {
  const Polygons file = naming(name, [&] {
    if (kind == ".obj") return read_obj(bytes);
    if (kind == ".stl") return read_stl(bytes);
    if (kind == ".ply") return read_ply(bytes);
    if (kind == ".off") return read_off(bytes);
    throw InputError("not a mesh file that can be read; expected .obj, .stl, .ply or .off");
  });
  TriangleMesh mesh;
  for (const Vec3& x : file.vertices) {
    mesh.vertices.push_back(unit * x);
    if (!(mesh.vertices.back().array().abs() < kLargest).all())  // nor NaN
      throw InputError("{}: vertex {} is not finite or farther than {:g} m from the origin", name,
                       mesh.vertices.size() - 1, kLargest);
  }
  auto begin = file.corners.begin();
  for (std::size_t f = 0; f < file.ends.size(); ++f) {
    const auto end = file.corners.begin() + static_cast<std::ptrdiff_t>(file.ends[f]);
    const std::vector<std::uint32_t> corners(begin, end);
    begin = end;
    for (const std::uint32_t corner : corners)
      if (corner >= mesh.vertices.size())
        throw InputError("{}: polygon {} has a vertex that does not exist", name, f);
    if (corners.size() > kMostCorners)
      throw InputError("{}: polygon {}: expected at most {} corners, found {}", name, f, kMostCorners,
                       corners.size());
    cut(mesh.vertices, corners, mesh.triangles);
    if (mesh.triangles.size() > kMostTriangles)
      throw InputError("{}: expected at most {} triangles", name, kMostTriangles);
  }
  Vec3 low = Vec3::Constant(kLargest), high = -low;
  for (const Vec3& x : mesh.vertices) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const std::size_t given = mesh.triangles.size();
  if (given > 0) mesh = weld(mesh, kWeld * (high - low).norm());
  if (mesh.triangles.empty())
    throw InputError("{}: {}", name, given == 0 ? "holds no triangle" : "holds no triangle with an area");
  return mesh;
}

TriangleMesh load_mesh(const std::filesystem::path& path, double unit) {
  const std::string name = path.string();
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) throw InputError("{}: no such mesh file", name);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw InputError("{}: cannot be read", name);
  std::string kind = path.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return parse_mesh(bytes, kind, name, unit);
}

}  // namespace cairn
