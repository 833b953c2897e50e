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
constexpr std::size_t kMostTriangles = 50'000'000;  // features of a mesh are numbered in 32 bits

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

/// The first line of a message of assimp, safe to print.
std::string first_line(std::string_view text) {
  std::string line(text.substr(0, std::min<std::size_t>(text.find('\n'), 200)));
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return line;
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

/// Vertices and triangles of a file as assimp reads them, packed.
std::string import(std::string_view bytes, const std::string& kind) {
  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate, kind.c_str());
  if (!scene) throw InputError("not a valid mesh: {}", first_line(importer.GetErrorString()));
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
          throw InputError("triangle {} has a vertex that does not exist", triangles.size());
        t[k] = first + face.mIndices[k];
      }
      triangles.push_back(t);
    }
  }
  if (triangles.size() > kMostTriangles)
    throw InputError("expected at most {} triangles, found {}", kMostTriangles, triangles.size());
  std::string out;
  pack(out, vertices);
  pack(out, triangles);
  return out;
}

}  // namespace

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
                       const std::string& name, double unit, Welding* welding) {
  TriangleMesh mesh;
  for (const auto& [x, y, z] : vertices) {
    mesh.vertices.push_back(unit * Vec3(x, y, z));
    if (!(mesh.vertices.back().array().abs() < kLargest).all())  // nor NaN
      throw InputError("{}: vertex {} is not finite or farther than {:g} m from the origin", name,
                       mesh.vertices.size() - 1, kLargest);
  }
  mesh.triangles = std::move(triangles);
  Vec3 low = Vec3::Constant(kLargest), high = -low;
  for (const Vec3& x : mesh.vertices) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const std::size_t given = mesh.triangles.size();
  if (given > 0) mesh = weld(mesh, kWeld * (high - low).norm(), welding);
  if (mesh.triangles.empty())
    throw InputError("{}: {}", name, given == 0 ? "holds no triangle" : "holds no triangle with an area");
  return mesh;
}

TriangleMesh parse_mesh(std::string_view bytes, const std::string& kind, const std::string& name, double unit,
                        double seconds, Welding* welding) {
  if (kind != "obj" && kind != "stl" && kind != "ply" && kind != "off")
    throw InputError("{}: not a mesh file that can be read; expected .obj, .stl, .ply or .off", name);
  // Broken files make assimp 5.2 write beyond its memory, hang, or ask for any amount of it.
  const std::string packed =
      naming(name, [&] { return run_apart([&] { return import(bytes, kind); }, seconds); });
  std::string_view rest = packed;
  const auto vertices = unpack<std::array<float, 3>>(rest);
  return make_mesh(vertices, unpack<Triangle>(rest), name, unit, welding);
}

TriangleMesh load_mesh(const std::filesystem::path& path, double unit, Welding* welding) {
  const std::string name = path.string();
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) throw InputError("{}: no such mesh file", name);
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw InputError("{}: cannot be read", name);
  if (bytes.empty()) throw InputError("{}: the file is empty", name);
  std::string kind = path.extension().string();
  if (!kind.empty()) kind.erase(0, 1);
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return parse_mesh(bytes, kind, name, unit, kSeconds, welding);
}

void write_obj(const TriangleMesh& mesh, const std::filesystem::path& path, double unit, int digits) {
  std::string text;
  auto out = std::back_inserter(text);
  for (const Vec3& x : mesh.vertices)
    fmt::format_to(out, "v {1:.{0}g} {2:.{0}g} {3:.{0}g}\n", digits, x.x() / unit, x.y() / unit,
                   x.z() / unit);
  for (const auto& [a, b, c] : mesh.triangles) fmt::format_to(out, "f {} {} {}\n", a + 1, b + 1, c + 1);
  std::ofstream file(path, std::ios::binary);
  if (!file || !file.write(text.data(), static_cast<std::streamsize>(text.size())) || !file.flush())
    throw InputError("{}: cannot be written", path.string());
}

}  // namespace cairn
