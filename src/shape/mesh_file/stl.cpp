#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "shape/mesh_file/bytes.h"
#include "shape/mesh_file/file_surface.h"
#include "shape/mesh_file/text.h"

namespace cairn {
namespace {

constexpr std::size_t kHead = 80, kRecord = 50;  // bytes

void add_corner(FileSurface& surface, const Vec3& x) {
  surface.corners.push_back(static_cast<std::uint32_t>(surface.vertices.size()));
  surface.vertices.push_back(x);
}

FileSurface read_binary(std::string_view bytes, const std::string& name, std::size_t facets) {
  FileSurface surface;
  surface.rounding = kSingleRounding;
  surface.vertices.reserve(3 * facets);
  surface.corners.reserve(3 * facets);
  surface.ends.reserve(facets);
  Bytes from(bytes.substr(kHead + 4), false);
  for (std::size_t f = 0; f < facets; ++f) {
    from.skip(3 * sizeof(float));  // the normal
    for (int k = 0; k < 3; ++k) {
      Vec3 x;
      for (double& c : x) c = from.take<float>();
      if (!x.allFinite()) throw InputError("{}:1: facet {} has a vertex that is not finite", name, f + 1);
      add_corner(surface, x);
    }
    from.skip(2);  // attributes
    surface.end_facet();
  }
  return surface;
}

class AsciiStlReader {
 public:
  AsciiStlReader(std::string_view bytes, const std::string& name) : text_(bytes, name, {.comments = false}) {}

  FileSurface read() {
    std::string_view word = text_.word_across_lines();
    while (!word.empty()) {
      require("solid", word);
      text_.rest();  // its name
      for (word = text_.word_across_lines(); !is(word, "endsolid"); word = text_.word_across_lines()) {
        if (word.empty())
          text_.fail("the file ends before 'endsolid', after {} facets", surface_.ends.size());
        require("facet", word);
        facet();
      }
      text_.rest();
      word = text_.word_across_lines();
    }
    if (surface_.ends.empty()) text_.fail("expected a facet or more, found none");
    return std::move(surface_);
  }

 private:
  static bool is(std::string_view word, std::string_view expected) {
    return std::equal(word.begin(), word.end(), expected.begin(), expected.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
  }

  void require(std::string_view expected, std::string_view word) {
    if (is(word, expected)) return;
    if (word.empty())
      text_.fail("expected '{}', found the end of the file in facet {}", expected, surface_.ends.size() + 1);
    text_.fail("expected '{}', found {}", expected, in_quotes(word));
  }
  void require(std::string_view expected) { require(expected, text_.word_across_lines()); }

  void facet() {
    const std::size_t line = text_.line();
    require("normal");
    for (int k = 0; k < 3; ++k) text_.unused_number("a component of the normal");
    require("outer");
    require("loop");
    for (int k = 0; k < 3; ++k) {
      require("vertex");
      Vec3 x;
      for (double& c : x) c = text_.number("a coordinate");
      add_corner(surface_, x);
    }
    require("endloop");
    require("endfacet");
    surface_.end_facet(line);
  }

  Text text_;
  FileSurface surface_;
};

/// Whether a file whose size is not that of a binary one is text all the same.
bool is_text(std::string_view bytes) {
  const auto first = bytes.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  if (first == bytes.npos) return false;
  std::string start(bytes.substr(first, 5));
  std::transform(start.begin(), start.end(), start.begin(), [](unsigned char c) { return std::tolower(c); });
  return start == "solid" && bytes.substr(0, kHead + 4).find('\0') == bytes.npos;
}

}  // namespace

FileSurface read_stl(std::string_view bytes, const std::string& name) {
  const bool whole = bytes.size() >= kHead + 4;
  const std::uint64_t facets = whole ? Bytes(bytes.substr(kHead, 4), false).take<std::uint32_t>() : 0;
  const std::uint64_t size = kHead + 4 + kRecord * facets;
  if (whole && size == bytes.size()) {
    if (facets == 0) throw InputError("{}:1: binary STL: expected a facet or more, found none", name);
    return read_binary(bytes, name, facets);
  }
  if (is_text(bytes)) return AsciiStlReader(bytes, name).read();
  if (!whole) throw InputError("{}:1: no STL file: neither 'solid' nor 84 bytes", name);
  throw InputError("{}:1: binary STL: {} facets are promised, which take {} bytes, the file has {}", name,
                   facets, size, bytes.size());
}

}  // namespace cairn
