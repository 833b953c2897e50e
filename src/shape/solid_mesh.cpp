#include "shape/solid_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/elementary.h"
#include "core/error.h"
#include "shape/mesh_file/triangulate.h"
#include "shape/self_crossing.h"

namespace cairn {
namespace {

using Index = std::uint32_t;
constexpr Index kNone = ~Index{0};
constexpr double kNoVolume = 1e-12;     // of the cube of the mesh's extent
constexpr std::size_t kMostParts = 64;  // nested in each other, which is looked at pair by pair

class Checker {
 public:
  Checker(TriangleMesh mesh, const Welding* read) : read_(read) { solid_.surface = std::move(mesh); }

  SolidMesh check() {
    check_numbers();
    find_neighbours();
    orient();
    check_fans();
    check_crossings();
    check_parts();
    solid_.facets = facets([](std::size_t) { return true; });
    return std::move(solid_);
  }

 private:
  const std::vector<Vec3>& vertices() const { return solid_.surface.vertices; }
  std::vector<std::array<Index, 3>>& triangles() { return solid_.surface.triangles; }

  /// "facet 12 of the file at (x, y, z)"
  std::string facet(std::size_t t) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : triangles()[t]) middle += vertices()[v] / 3.0;
    return fmt::format("{} at ({:.6g}, {:.6g}, {:.6g})", number(t), middle.x(), middle.y(), middle.z());
  }
  /// Complains of triangle t, with the line of its facet where the file has lines.
  template <class... Args>
  [[noreturn]] void fail(std::size_t t, fmt::format_string<Args...> words, Args&&... args) const {
    const std::string what = fmt::format(words, std::forward<Args>(args)...);
    if (read_ && !read_->lines.empty()) throw InputError("{}:{}: {}", read_->name, read_->lines[t], what);
    throw InputError("{}", what);
  }
  std::size_t index(std::size_t t) const { return read_ ? read_->kept[t] : t; }
  std::string number(std::size_t t) const {
    return read_ ? facet_of_file(index(t)) : fmt::format("facet {}", t + 1);
  }
  /// Facets of the file among triangles; those of one facet follow each other.
  template <class Condition>
  std::size_t facets(const Condition& condition) const {
    std::size_t count = 0, last = solid_.surface.triangles.size();
    for (std::size_t t = 0; t < solid_.surface.triangles.size(); ++t) {
      if (!condition(t)) continue;
      if (last == solid_.surface.triangles.size() || index(t) != index(last)) ++count;
      last = t;
    }
    return count;
  }

  void check_numbers() {
    if (triangles().empty()) throw InputError("expected a closed surface, found no triangle");
    for (std::size_t t = 0; t < triangles().size(); ++t) {
      const auto& [a, b, c] = triangles()[t];
      for (const Index v : triangles()[t]) {
        if (v >= vertices().size()) fail(t, "{} has a vertex that does not exist", number(t));
        if (!vertices()[v].allFinite()) fail(t, "{} has a vertex that is not finite", number(t));
      }
      if (a == b || b == c || c == a) fail(t, "{} has the same vertex twice", facet(t));
    }
  }

  void find_neighbours() {
    struct Side {
      std::uint64_t edge;  // its smaller vertex in the high half
      Index triangle, corner;
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles().size());
    for (Index t = 0; t < triangles().size(); ++t)
      for (Index k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(triangles()[t][k], triangles()[t][(k + 1) % 3]);
        sides.push_back({std::uint64_t{a} << 32 | b, t, k});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
      return x.edge != y.edge ? x.edge < y.edge : x.triangle < y.triangle;
    });
    solid_.neighbours.resize(triangles().size());
    Index open = kNone, shared = kNone;  // first facets of either kind
    std::size_t open_edges = 0;
    for (std::size_t s = 0, end = 0; s < sides.size(); s = end) {
      for (end = s; end < sides.size() && sides[end].edge == sides[s].edge;) ++end;
      if (end - s == 1) {
        ++open_edges;
        open = std::min(open, sides[s].triangle);
      } else if (end - s > 2) {
        shared = std::min(shared, sides[s].triangle);
      } else {
        solid_.neighbours[sides[s].triangle][sides[s].corner] = sides[s + 1].triangle;
        solid_.neighbours[sides[s + 1].triangle][sides[s + 1].corner] = sides[s].triangle;
      }
    }
    if (open != kNone)
      fail(open, "not closed: an edge of {} has no other facet ({} such edges)", facet(open), open_edges);
    if (shared != kNone)
      fail(shared, "not a manifold: an edge of {} belongs to more than two facets", facet(shared));
  }

  /// Whether triangle t runs along the edge from a to b in that direction.
  bool runs(Index t, Index a, Index b) {
    for (Index k = 0; k < 3; ++k)
      if (triangles()[t][k] == a && triangles()[t][(k + 1) % 3] == b) return true;
    return false;
  }

  void turn(Index t) {
    std::swap(triangles()[t][1], triangles()[t][2]);
    std::swap(solid_.neighbours[t][0], solid_.neighbours[t][2]);
  }

  /// Makes each part turn one way, outwards if it stood alone, and finds the parts.
  void orient() {
    const std::size_t count = triangles().size();
    part_.assign(count, kNone);
    std::vector<char> turned(count, 0);
    std::vector<Index> front;
    const Vec3 origin = vertices()[triangles()[0][0]];
    for (Index seed = 0; seed < count; ++seed) {
      if (part_[seed] != kNone) continue;
      const auto part = static_cast<Index>(first_.size());
      first_.push_back(seed);
      front = {seed};
      part_[seed] = part;
      std::vector<Index> members;
      while (!front.empty()) {
        const Index t = front.back();
        front.pop_back();
        members.push_back(t);
        for (Index k = 0; k < 3; ++k) {
          const Index other = solid_.neighbours[t][k];
          const bool against = runs(other, triangles()[t][k], triangles()[t][(k + 1) % 3]);
          if (part_[other] == kNone) {
            part_[other] = part;
            turned[other] = against;
            if (against) turn(other);
            front.push_back(other);
          } else if (against) {
            fail(other, "one-sided: {} cannot be turned to agree with its neighbours", facet(other));
          }
        }
      }
      double volume = 0.0;
      for (const Index t : members) {
        const auto& [a, b, c] = triangles()[t];
        volume += (vertices()[a] - origin).dot((vertices()[b] - origin).cross(vertices()[c] - origin)) / 6.0;
      }
      if (volume < 0.0)
        for (const Index t : members) {
          turn(t);
          turned[t] ^= 1;
        }
      volumes_.push_back(std::abs(volume));
    }
    turned_ = std::move(turned);
  }

  void check_fans() {
    std::vector<char> seen(3 * triangles().size(), 0);
    std::vector<char> has_fan(vertices().size(), 0);
    for (Index t = 0; t < triangles().size(); ++t)
      for (Index k = 0; k < 3; ++k) {
        if (seen[3 * t + k]) continue;
        const Index vertex = triangles()[t][k];
        if (std::exchange(has_fan[vertex], 1))
          fail(t, "not a manifold: {} touches others at a single vertex", facet(t));
        for (Index at = t, corner = k; !seen[3 * at + corner];) {
          seen[3 * at + corner] = 1;
          at = solid_.neighbours[at][corner];
          corner = 0;
          while (triangles()[at][corner] != vertex) ++corner;
        }
      }
  }

  void check_crossings() {
    const auto crossing = find_crossing(solid_.surface, solid_.neighbours);
    if (!crossing) return;
    fail(crossing->first, "crosses itself: {} and {}", facet(crossing->first), number(crossing->second));
  }

  /// How often a part winds around a point that is not on it [van Oosterom & Strackee 1983, IEEE Trans.
  /// Biomed. Eng. 30, 125].
  double winding(Index part, const Vec3& x) {
    double angle = 0.0;
    for (std::size_t t = 0; t < triangles().size(); ++t) {
      if (part_[t] != part) continue;
      const Vec3 a = vertices()[triangles()[t][0]] - x, b = vertices()[triangles()[t][1]] - x,
                 c = vertices()[triangles()[t][2]] - x;
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      angle += arc_tangent(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return angle / (2.0 * kPi);
  }

  /// One part holds all others, which are cavities.
  void check_parts() {
    const auto outer =
        static_cast<Index>(std::max_element(volumes_.begin(), volumes_.end()) - volumes_.begin());
    Eigen::AlignedBox3d box;
    for (const Index v : triangles()[first_[outer]]) box.extend(vertices()[v]);
    for (std::size_t t = 0; t < triangles().size(); ++t)
      if (part_[t] == outer)
        for (const Index v : triangles()[t]) box.extend(vertices()[v]);
    if (!(volumes_[outer] > kNoVolume * cubed(box.diagonal().norm())))
      fail(first_[outer], "encloses no volume: {}", facet(first_[outer]));
    const std::size_t parts = first_.size();
    if (parts > kMostParts)
      fail(first_[1], "expected one solid, found {} separate parts; the second begins with {}", parts,
           facet(first_[1]));
    const auto inside = [&](Index part, Index of) {
      return winding(of, vertices()[triangles()[first_[part]][0]]) > 0.5;
    };
    for (Index p = 0; p < parts; ++p) {
      if (p == outer) continue;
      for (Index q = 0; q < parts; ++q)
        if (q != p && inside(p, q) != (q == outer))
          fail(first_[p], "expected one solid, found separate parts; one of them begins with {}",
               facet(first_[p]));
    }
    for (Index t = 0; t < triangles().size(); ++t)
      if (part_[t] != outer) {
        turn(t);
        turned_[t] ^= 1;
      }
    solid_.cavities = parts - 1;
    tell_turned(true, outer, "turned {} facets that faced inwards, the first is {}");
    tell_turned(
        false, outer,
        "took shells inside another as cavities: turned {} facets that faced out of them, the first is {}");
  }

  /// Of the outer part or of all others.
  void tell_turned(bool of_outer, Index outer, fmt::format_string<std::size_t&, std::string> words) {
    const auto told = [&](std::size_t t) { return turned_[t] && (part_[t] == outer) == of_outer; };
    std::size_t count = facets(told), first = 0;
    while (count > 0 && !told(first)) ++first;
    if (count > 0) solid_.repairs.push_back(fmt::format(words, count, facet(first)));
  }

  SolidMesh solid_;
  const Welding* read_;
  std::vector<Index> part_;      // of each triangle
  std::vector<Index> first_;     // triangle of each part
  std::vector<double> volumes_;  // of each part
  std::vector<char> turned_;     // triangles
};

}  // namespace

SolidMesh make_solid(TriangleMesh mesh, const Welding* read) {
  return Checker(std::move(mesh), read).check();
}

namespace {

/// The solid of a mesh read from a file.
SolidMesh solid_of(TriangleMesh mesh, Welding welding) {
  SolidMesh solid = make_solid(std::move(mesh), &welding);
  solid.notes = std::move(welding.notes);
  std::vector<std::string>& repairs = solid.repairs;
  if (welding.farthest > 0.0)
    repairs.push_back(fmt::format("joined vertices up to {:.3g} m apart", welding.farthest));
  if (welding.flat > 0) repairs.push_back(fmt::format("left out {} facets without area", welding.flat));
  if (welding.copies > 0) repairs.push_back(fmt::format("left out {} copies of facets", welding.copies));
  return solid;
}

}  // namespace

SolidMesh load_solid(const std::filesystem::path& path, double unit) {
  return naming(path.string(), [&] {
    Welding welding;
    TriangleMesh mesh = load_mesh(path, unit, &welding);
    return solid_of(std::move(mesh), std::move(welding));
  });
}

SolidMesh parse_solid(std::string_view bytes, const std::filesystem::path& path, double unit) {
  return naming(path.string(), [&] {
    Welding welding;
    TriangleMesh mesh = parse_mesh(bytes, mesh_kind(path), path.string(), unit, &welding);
    return solid_of(std::move(mesh), std::move(welding));
  });
}

}  // namespace cairn
