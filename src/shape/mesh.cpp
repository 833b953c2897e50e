#include "shape/mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/apart.h"
#include "core/error.h"

namespace cairn {
namespace {

constexpr double kWeld = 1e-6;                      // of the extent: a few steps of single precision
constexpr double kFlat = 1e-9;                      // sine of the corners of a triangle without area
constexpr double kLargest = 1e15;                   // m
constexpr double kRounding = 6e-8;                  // of a coordinate in single precision
constexpr double kSpoilt = 1e-6, kLost = 1e-3;      // of the extent by rounding: is told, is refused
constexpr std::size_t kMostTriangles = 50'000'000;  // features of a mesh are numbered in 32 bits

constexpr char kWhole = 'w', kCut = 'c';  // polygons: last byte of a packed mesh

constexpr const char* kKinds[] = {"obj", "stl", "ply", "off"};

constexpr unsigned kSeconds = 60;  // of computing in a reader

using Triangle = std::array<std::uint32_t, 3>;

struct TriangleHash {
  std::size_t operator()(const Triangle& t) const {
    std::size_t h = 0;
    for (const std::uint32_t v : t) h = (h ^ v) * 0x9E3779B97F4A7C15ull;
    return h ^ h >> 32;
  }
};

/// Finds earlier points within a tolerance, on a grid of cells some tolerances wide.
class Welder {
 public:
  explicit Welder(double tolerance)
      : tolerance_(tolerance), cell_(std::max(16.0 * tolerance, std::numeric_limits<double>::min())) {}

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
      const auto first = cells_.find(hash(at));
      for (std::uint32_t p = first == cells_.end() ? kNone : first->second; p != kNone; p = next_[p]) {
        const double distance = (points[p] - x).norm();
        if (!(distance <= tolerance_)) continue;
        farthest = std::max(farthest, distance);
        return p;
      }
    }
    const auto index = static_cast<std::uint32_t>(points.size());
    points.push_back(x);
    const auto [first, added] = cells_.try_emplace(hash(cell(0.0)), index);
    next_.push_back(added ? kNone : std::exchange(first->second, index));
    return index;
  }

  std::vector<Vec3> points;
  double farthest = 0.0;  // between two that became one

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  static std::size_t hash(const Eigen::Array3d& cell) {
    std::size_t h = 0;
    for (const double c : {cell.x(), cell.y(), cell.z()})
      h = (h ^ std::hash<double>{}(c + 0.0)) * 0x9E3779B97F4A7C15ull;  // + 0.0: -0 is 0
    return h;
  }

  double tolerance_, cell_;
  std::unordered_map<std::size_t, std::uint32_t> cells_;  // the newest point of each
  std::vector<std::uint32_t> next_;                       // older one in the same cell
};

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return (b - a).cross(c - a).norm() > kFlat * longest;
}

/// "an OFF file"
std::string a_file(std::string kind) {
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::toupper(c); });
  return fmt::format("{} {} file", kind == "PLY" ? "a" : "an", kind);
}

/// What is said of a file that assimp refuses: the first line of its message, safe to print, unless that
/// tells of its own insides only.
std::string complaint(std::string_view text, const std::string& kind) {
  const std::string what = "truncated or not " + a_file(kind);
  if (text.empty() || text.find("$$$") != text.npos || text.find("::") != text.npos) return what;
  std::string line(text.substr(0, std::min<std::size_t>(text.find('\n'), 200)));
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return fmt::format("{}: {}", what, line);
}

template <class T>
void pack(std::string& to, const std::vector<T>& values) {
  const std::uint64_t bytes = values.size() * sizeof(T);
  to.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
  to.append(reinterpret_cast<const char*>(values.data()), bytes);
}

template <class T>
std::vector<T> unpack(std::string_view& from) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, from.data(), sizeof bytes);
  std::vector<T> values(bytes / sizeof(T));
  if (bytes > 0) std::memcpy(values.data(), from.data() + sizeof bytes, bytes);
  from.remove_prefix(sizeof bytes + bytes);
  return values;
}

/// Fewest and most corners of a facet; the readers leave facets that a file ends before without any.
std::pair<unsigned, unsigned> corners(const aiScene& scene) {
  unsigned fewest = 3, most = 3;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m)
    for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; ++f) {
      fewest = std::min(fewest, scene.mMeshes[m]->mFaces[f].mNumIndices);
      most = std::max(most, scene.mMeshes[m]->mFaces[f].mNumIndices);
    }
  return {fewest, most};
}

/// Vertices and triangles of a file as assimp reads them, and whether polygons were cut, packed.
std::string import(std::string_view bytes, const std::string& kind) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, kind.c_str());
  if (!scene) throw InputError("{}", complaint(importer.GetErrorString(), kind));
  const auto [fewest, most] = corners(*scene);
  if (fewest == 0) throw InputError("{}", complaint("", kind));
  const bool cut = most > 3;
  if (cut) scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (!scene) throw InputError("{}", complaint(importer.GetErrorString(), kind));
  std::vector<std::array<float, 3>> vertices;
  std::vector<Triangle> triangles;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v)
      vertices.push_back({part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z});
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      Triangle t;
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= part.mNumVertices)
          throw InputError("{} has a vertex that does not exist", facet_of_file(triangles.size(), cut));
        t[k] = first + face.mIndices[k];
      }
      triangles.push_back(t);
    }
  }
  if (triangles.empty()) throw InputError("holds no triangle, or is truncated");
  if (triangles.size() > kMostTriangles)
    throw InputError("expected at most {} triangles, found {}", kMostTriangles, triangles.size());
  std::string out;
  pack(out, vertices);
  pack(out, triangles);
  return out + (cut ? kCut : kWhole);
}

void check_vertices(const TriangleMesh& mesh, const std::string& name, bool cut) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& x = mesh.vertices[v];
    if ((x.array().abs() < kLargest).all()) continue;  // nor NaN
    const auto user = std::find_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
      return std::find(t.begin(), t.end(), v) != t.end();
    });
    const auto number = static_cast<std::size_t>(user - mesh.triangles.begin());
    throw InputError("{}: {} has a vertex at ({:.6g}, {:.6g}, {:.6g}) m, not finite or beyond {:g} m", name,
                     number < mesh.triangles.size() ? facet_of_file(number, cut) : "no facet, but the file,",
                     x.x(), x.y(), x.z(), kLargest);
  }
}

/// What single precision takes from a mesh that lies far from its origin; nothing is said of others.
/// @throws InputError when too few digits are left.
std::string lost_digits(double farthest, double extent, const std::string& name) {
  const double part = kRounding * farthest / extent;
  if (!(part > kSpoilt)) return {};
  const std::string where = fmt::format(
      "lies up to {:.3g} m from its origin at an extent of {:.3g} m, so that of single precision, in which "
      "meshes are read, {:.0f} digits are left: move it to its centre",
      farthest, extent, std::max(0.0, std::floor(-std::log10(part))));
  if (part > kLost) throw InputError("{}: {}", name, where);
  return where;
}

/// @throws InputError unless the path is that of a regular file: anything else might never end.
void check_regular(const std::filesystem::path& path) {
  using std::filesystem::file_type;
  std::error_code none;
  const file_type type = std::filesystem::status(path, none).type();
  if (type == file_type::regular) return;
  if (type == file_type::not_found || type == file_type::none)
    throw InputError("{}: no such mesh file", path.string());
  throw InputError("{}: expected a mesh file, found {}", path.string(),
                   type == file_type::directory ? "a directory"
                   : type == file_type::fifo    ? "a pipe"
                   : type == file_type::socket  ? "a socket"
                                                : "a device");
}

}  // namespace

std::string facet_of_file(std::size_t triangle, bool cut) {
  return fmt::format("facet {} of the file{}", triangle + 1, cut ? " cut into triangles" : "");
}

TriangleMesh weld(const TriangleMesh& mesh, double tolerance, Welding* welding) {
  Welder welder(tolerance);
  std::vector<std::uint32_t> point(mesh.vertices.size());
  for (std::size_t v = 0; v < point.size(); ++v) point[v] = welder.add(mesh.vertices[v]);

  TriangleMesh out;
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(welder.points.size(), unused);
  Welding done;
  done.farthest = welder.farthest;
  std::unordered_set<Triangle, TriangleHash> known;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = point[mesh.triangles[n][k]];
    if (!has_area(welder.points[t[0]], welder.points[t[1]], welder.points[t[2]])) {
      ++done.flat;
      continue;
    }
    Triangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (!known.insert(sorted).second) {
      ++done.copies;
      continue;
    }
    done.kept.push_back(static_cast<std::uint32_t>(n));
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

TriangleMesh make_mesh(const std::vector<std::array<float, 3>>& vertices, std::vector<Triangle> triangles,
                       const std::string& name, double unit, Welding* welding, bool cut) {
  TriangleMesh mesh;
  for (const auto& [x, y, z] : vertices) mesh.vertices.push_back(unit * Vec3(x, y, z));
  mesh.triangles = std::move(triangles);
  check_vertices(mesh, name, cut);
  Vec3 low = Vec3::Constant(kLargest), high = -low;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      low = low.cwiseMin(mesh.vertices[v]);
      high = high.cwiseMax(mesh.vertices[v]);
    }
  const std::size_t given = mesh.triangles.size();
  std::string far_off;
  if (given > 0) {
    const double extent = (high - low).norm();
    far_off = lost_digits(high.cwiseMax(-low).maxCoeff(), extent, name);
    mesh = weld(mesh, kWeld * extent, welding);
  }
  if (welding) {
    welding->cut = cut;
    welding->far_off = std::move(far_off);
  }
  if (mesh.triangles.empty())
    throw InputError("{}: {}", name, given == 0 ? "holds no triangle" : "holds no triangle with an area");
  return mesh;
}

std::string mesh_kind(const std::filesystem::path& path) {
  std::string name = path.extension().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const char* kind : kKinds)
    if (name == fmt::format(".{}", kind)) return kind;
  return {};
}

TriangleMesh parse_mesh(std::string_view bytes, const std::string& kind, const std::string& name, double unit,
                        double seconds, Welding* welding) {
  if (std::find(std::begin(kKinds), std::end(kKinds), kind) == std::end(kKinds))
    throw InputError("{}: not a mesh file that can be read; expected .obj, .stl, .ply or .off", name);
  // Broken files make assimp 5.2 write beyond its memory, hang, or ask for any amount of it.
  const std::string packed = naming(name, [&] {
    try {
      return run_apart([&] { return import(bytes, kind); }, seconds);
    } catch (const BrokeDown&) {
      throw InputError("{}", complaint("", kind));
    }
  });
  std::string_view rest = packed;
  const auto vertices = unpack<std::array<float, 3>>(rest);
  std::vector<Triangle> triangles = unpack<Triangle>(rest);
  return make_mesh(vertices, std::move(triangles), name, unit, welding, rest.front() == kCut);
}

TriangleMesh load_mesh(const std::filesystem::path& path, double unit, Welding* welding) {
  const std::string name = path.string();
  check_regular(path);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw InputError("{}: cannot be read", name);
  if (bytes.empty()) throw InputError("{}: the file is empty", name);
  return parse_mesh(bytes, mesh_kind(path), name, unit, kSeconds, welding);
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
