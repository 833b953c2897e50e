#include "shape/mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include "core/error.h"

namespace cairn {
namespace {

constexpr double kWeld = 1e-6;                      // of the extent: a few steps of single precision
constexpr double kFlat = 1e-9;                      // sine of the corners of a triangle without area
constexpr double kLargest = 1e15;                   // m
constexpr std::size_t kMostTriangles = 50'000'000;  // features of a mesh are numbered in 32 bits

using Triangle = std::array<std::uint32_t, 3>;

/// The first line of a message of assimp, safe to print.
std::string first_line(std::string_view text) {
  std::string line(text.substr(0, std::min<std::size_t>(text.find('\n'), 200)));
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return line;
}

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

TriangleMesh load_mesh(const std::filesystem::path& path, double unit) {
  const std::string name = path.string();
  std::string kind = path.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  if (kind != ".obj" && kind != ".stl" && kind != ".ply" && kind != ".off")
    throw InputError("{}: not a mesh file that can be read; expected .obj, .stl, .ply or .off", name);
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) throw InputError("{}: no such mesh file", name);

  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
  if (!scene) throw InputError("{}: not a valid mesh: {}", name, first_line(importer.GetErrorString()));

  TriangleMesh mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& x = part.mVertices[v];
      mesh.vertices.push_back(unit * Vec3(x.x, x.y, x.z));
      if (!(mesh.vertices.back().cwiseAbs().maxCoeff() < kLargest))
        throw InputError("{}: vertex {} is not finite or farther than {:g} m from the origin", name,
                         mesh.vertices.size() - 1, kLargest);
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      Triangle t;
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= part.mNumVertices)
          throw InputError("{}: triangle {} has a vertex that does not exist", name, mesh.triangles.size());
        t[k] = first + face.mIndices[k];
      }
      mesh.triangles.push_back(t);
    }
  }
  if (mesh.triangles.size() > kMostTriangles)
    throw InputError("{}: expected at most {} triangles, found {}", name, kMostTriangles,
                     mesh.triangles.size());
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

}  // namespace cairn
