// Thousands of generated files: known solids in every format and many spellings come back exactly, and as the
// assimp library reads them where it knows the spelling.
#include <assimp/scene.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>

#include "core/random.h"
#include "shape/mesh_file/file_surface.h"

namespace cairn {
namespace {

using Facets = std::vector<std::vector<Vec3>>;  // corners of each

struct Solid {
  std::vector<Vec3> vertices;
  std::vector<std::vector<std::uint32_t>> facets;

  Facets corners() const {
    Facets all;
    for (const auto& facet : facets) {
      all.emplace_back();
      for (const std::uint32_t v : facet) all.back().push_back(vertices[v]);
    }
    return all;
  }
};

// A frustum on a polygon of 3 to 9 corners: two caps and sides; or its triangles.
Solid random_solid(Random& random, bool triangles, bool single) {
  const auto n = static_cast<std::uint32_t>(3 + random.uniform(0.0, 7.0));
  Solid solid;
  const Quat turn = random.rotation();
  const double scale = std::pow(10.0, random.uniform(-3.0, 4.0));
  const Vec3 by = scale * random.in_ball();
  std::vector<std::uint32_t> low, high;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double a = 2.0 * kPi * (k + random.uniform(0.0, 0.7)) / n;
    for (const double z : {0.0, 1.0}) {
      Vec3 x = turn * (scale * Vec3((1.0 - 0.4 * z) * std::cos(a), (1.0 - 0.4 * z) * std::sin(a), z)) + by;
      if (single) x = x.cast<float>().cast<double>();
      solid.vertices.push_back(x);
    }
    low.insert(low.begin(), 2 * k);
    high.push_back(2 * k + 1);
    const std::uint32_t next = 2 * ((k + 1) % n);
    solid.facets.push_back({2 * k, next, next + 1, 2 * k + 1});
  }
  solid.facets.push_back(low);
  solid.facets.push_back(high);
  if (!triangles) return solid;
  std::vector<std::vector<std::uint32_t>> cut;
  for (const auto& f : solid.facets)
    for (std::size_t k = 1; k + 1 < f.size(); ++k) cut.push_back({f[0], f[k], f[k + 1]});
  solid.facets = cut;
  return solid;
}

// Writes numbers and lines in one of many ways; plainly, as every program reads them, or not.
class Writer {
 public:
  Writer(Random& random, bool plain) : random_(random), plain_(plain) {
    end_ = pick({"\n", "\r\n"});
    style_ = plain ? 0 : choice(6);
  }

  std::size_t choice(std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(random_.uniform(0.0, 1.0) * static_cast<double>(n)));
  }
  std::string pick(std::initializer_list<const char*> of) {
    return plain_ ? *of.begin() : of.begin()[choice(of.size())];
  }

  std::string number(double x) {
    std::string text = style_ % 2 == 0 ? fmt::format("{:.17g}", x) : fmt::format("{:.16e}", x);
    if (style_ >= 2 && x >= 0.0) text = '+' + text;
    if (style_ >= 3)
      if (const auto zero = text.find("0."); zero <= 1 && (zero == 0 || text[0] == '-' || text[0] == '+'))
        text.erase(zero, 1);
    if (style_ == 5) std::replace(text.begin(), text.end(), 'e', choice(2) ? 'D' : 'd');
    return text;
  }
  std::string point(const Vec3& x) { return number(x.x()) + gap() + number(x.y()) + gap() + number(x.z()); }
  std::string gap() { return pick({" ", "  ", "\t", " \t "}); }
  std::string end() { return pick({"", " ", "\t"}) + end_; }
  std::string comment() { return pick({"", "# a comment", "#", "\t# f 1 2 3"}) + end_; }

 private:
  Random& random_;
  bool plain_;
  std::string end_;
  std::size_t style_;
};

std::string obj_text(const Solid& solid, Writer& write) {
  std::string text = write.pick({"", "\xEF\xBB\xBF", "# a\n"});
  const std::string more = write.pick({"", " 1", " 0.5 0.25 1", " 0.1 0.2 0.3 0.4", " 0"});
  for (const Vec3& x : solid.vertices)
    text += write.pick({"v", "  v", "v "}) + " " + write.point(x) + more + write.end();
  text += write.comment() + write.pick({"", "vt 0 0\nvn 0 0 1\n", "g a b\ns off\n"});
  const bool extra = text.find("vt 0 0") != text.npos, back = !write.pick({"", "", "b"}).empty();
  for (const auto& facet : solid.facets) {
    text += "f";
    for (const std::uint32_t v : facet) {
      const auto number = back ? static_cast<long>(v) - static_cast<long>(solid.vertices.size()) : v + 1l;
      text += write.gap() + write.pick({"", "", "", "\\\n"}) + fmt::format("{}", number);
      if (extra) text += write.pick({"/1/1", "//1", "/1", "", "/", "//"});
    }
    text += write.end() + write.comment();
  }
  return text;
}

std::string off_text(const Solid& solid, Writer& write) {
  const std::string kind = write.pick({"OFF", "COFF", "NOFF", "STOFF"});
  std::string text = kind + write.pick({"\n", " "}) +
                     fmt::format("{} {}", solid.vertices.size(), solid.facets.size()) +
                     write.pick({" 0", "", " 12"}) + write.end() + write.comment();
  for (const Vec3& x : solid.vertices)
    text += write.point(x) +
            (kind == "COFF"    ? " 1 0 0 1"
             : kind == "NOFF"  ? " 0 0 1"
             : kind == "STOFF" ? " 0 1"
                               : "") +
            write.end();
  for (const auto& facet : solid.facets) {
    text += fmt::format("{}", facet.size());
    for (const std::uint32_t v : facet) text += write.gap() + fmt::format("{}", v);
    text += write.pick({"", " 3", " 0.1 0.2 0.3", " 1 2 3 4"}) + write.end() + write.comment();
  }
  return text;
}

template <class T>
void append(std::string& to, T value, bool swapped) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (swapped) std::reverse(bytes.begin(), bytes.end());
  to += bytes;
}

std::string ply_text(const Solid& solid, Writer& write, const std::string& format, bool single) {
  const std::string real = single ? "float" : "double";
  const bool color = !write.pick({"", "c"}).empty(), edge = !write.pick({"", "e"}).empty();
  std::string text = "ply\nformat " + format + " 1.0\ncomment a solid\n" +
                     fmt::format("element vertex {}\n", solid.vertices.size()) +
                     (color ? "property uchar red\n" : "") +
                     fmt::format("property {0} x\nproperty {0} y\nproperty {0} z\n", real) +
                     (edge ? "element edge 1\nproperty list uchar short ends\n" : "") +
                     fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                                 solid.facets.size());
  const bool ascii = format == "ascii", swapped = format == "binary_big_endian";
  for (const Vec3& x : solid.vertices) {
    if (ascii) {
      text += (color ? "255 " : "") + write.point(x) + write.end();
      continue;
    }
    if (color) append(text, std::uint8_t{255}, swapped);
    for (const double c : x) single ? append(text, static_cast<float>(c), swapped) : append(text, c, swapped);
  }
  if (edge && ascii) text += "2 0 1\n";
  if (edge && !ascii) {
    append(text, std::uint8_t{2}, swapped);
    append(text, std::int16_t{0}, swapped);
    append(text, std::int16_t{1}, swapped);
  }
  for (const auto& facet : solid.facets) {
    if (ascii)
      text += fmt::format("{}", facet.size());
    else
      append(text, static_cast<std::uint8_t>(facet.size()), swapped);
    for (const std::uint32_t v : facet)
      if (ascii)
        text += write.gap() + fmt::format("{}", v);
      else
        append(text, static_cast<std::int32_t>(v), swapped);
    if (ascii) text += write.end();
  }
  return text;
}

std::string stl_text(const Solid& solid, Writer& write, bool binary) {
  if (binary) {
    std::string text = write.pick({"binary", "solid", "solid name"});
    text.resize(80, write.pick({"", "x"}).empty() ? '\0' : ' ');
    append(text, static_cast<std::uint32_t>(solid.facets.size()), false);
    for (const auto& facet : solid.facets) {
      for (int k = 0; k < 3; ++k) append(text, 0.f, false);
      for (const std::uint32_t v : facet)
        for (const double c : solid.vertices[v]) append(text, static_cast<float>(c), false);
      append(text, std::uint16_t{0}, false);
    }
    return text;
  }
  std::string text = "solid " + write.pick({"name", "", "a longer name"}) + "\n";
  for (const auto& facet : solid.facets) {
    text += write.pick({"", "  "}) + "facet normal 0 0 " + write.pick({"1", "-nan", "0.5e0"}) + write.end() +
            "outer loop" + write.end();
    for (const std::uint32_t v : facet)
      text += write.pick({"", "\t"}) + "vertex " + write.point(solid.vertices[v]) + write.end();
    text += "endloop" + write.end() + write.pick({"endfacet", "ENDFACET"}) + write.end();
  }
  return text + "endsolid" + write.pick({" name", "", " other"}) + "\n";
}

Facets corners_of(const FileSurface& surface) {
  Facets all;
  for (std::size_t f = 0; f < surface.ends.size(); ++f) {
    all.emplace_back();
    for (const std::uint32_t v : surface.facet(f)) all.back().push_back(surface.vertices.at(v));
  }
  return all;
}

Facets read_with_assimp(const std::string& text, const std::string& kind) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(text.data(), text.size(), 0, kind.c_str());
  Facets all;
  for (unsigned m = 0; scene && m < scene->mNumMeshes; ++m)
    for (unsigned f = 0; f < scene->mMeshes[m]->mNumFaces; ++f) {
      all.emplace_back();
      const aiFace& face = scene->mMeshes[m]->mFaces[f];
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        const aiVector3D& x = scene->mMeshes[m]->mVertices[face.mIndices[k]];
        all.back().push_back({x.x, x.y, x.z});
      }
    }
  return all;
}

void expect_near(const Facets& found, const Facets& known, double tolerance) {
  ASSERT_EQ(found.size(), known.size());
  for (std::size_t f = 0; f < known.size(); ++f) {
    ASSERT_EQ(found[f].size(), known[f].size()) << f;
    for (std::size_t k = 0; k < known[f].size(); ++k)
      EXPECT_LE((found[f][k] - known[f][k]).cwiseAbs().maxCoeff(), tolerance) << f;
  }
}

TEST(MeshSpelling, ComesBackExactlyAndAsAssimpReadsIt) {
  Random random(2026, 0);
  int compared = 0;
  for (int trial = 0; trial < 2400 && !testing::Test::HasFailure(); ++trial) {
    const int format = trial % 7;
    const bool plain = trial / 7 % 2 == 0, stl = format >= 5,
               single = format == 6 || (format >= 3 && trial % 3 == 0);
    const Solid solid = random_solid(random, stl, single);
    Writer write(random, plain);
    const char* const kinds[] = {"obj", "off", "ply", "ply", "ply", "stl", "stl"};
    const std::string text = format == 0   ? obj_text(solid, write)
                             : format == 1 ? off_text(solid, write)
                             : format == 2 ? ply_text(solid, write, "ascii", single)
                             : format == 3 ? ply_text(solid, write, "binary_little_endian", single)
                             : format == 4 ? ply_text(solid, write, "binary_big_endian", single)
                                           : stl_text(solid, write, format == 6);
    SCOPED_TRACE(fmt::format("trial {}, {}:\n{}", trial, kinds[format],
                             format == 0 || format == 1 || format == 2 || format == 5 ? text : ""));
    const FileSurface surface = format == 0   ? read_obj(text, "file")
                                : format == 1 ? read_off(text, "file")
                                : stl         ? read_stl(text, "file")
                                              : read_ply(text, "file");
    const Facets known = solid.corners();
    expect_near(corners_of(surface), known, 0.0);
    if (!plain) continue;
    double largest = 0.0;
    for (const Vec3& x : solid.vertices) largest = std::max(largest, x.cwiseAbs().maxCoeff());
    expect_near(read_with_assimp(text, kinds[format]), known, 5e-7 * largest);
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

}  // namespace
}  // namespace cairn
