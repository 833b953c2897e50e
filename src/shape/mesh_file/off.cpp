#include <algorithm>

#include "shape/mesh_file/file_surface.h"
#include "shape/mesh_file/text.h"

namespace cairn {
namespace {

class OffReader {
 public:
  OffReader(std::string_view bytes, const std::string& name) : text_(bytes, name, {}) {}

  FileSurface read() {
    read_header();
    const std::uint32_t vertices = text_.count("the number of vertices");
    const std::uint32_t facets = text_.count("the number of facets");
    if (facets == 0) text_.fail("expected a facet or more, found none");
    if (text_.more()) text_.count("the number of edges");
    text_.end_line();
    for (std::uint32_t v = 0; v < vertices; ++v) {
      next_record("vertices", v, vertices);
      vertex();
    }
    for (std::uint32_t f = 0; f < facets; ++f) {
      next_record("facets", f, facets);
      facet(vertices);
    }
    if (text_.next_line())
      text_.fail("expected the end of the file after {} vertices and {} facets, found {}", vertices, facets,
                 in_quotes(text_.word()));
    return std::move(surface_);
  }

 private:
  /// Letters before OFF tell what the vertices carry; the counts may stand on the same line.
  void read_header() {
    if (!text_.next_line()) text_.fail("expected OFF, found an empty file");
    std::string_view word = text_.word();
    const std::string found = in_quotes(word);
    const auto starts = [&](std::string_view letters) {
      const bool with = word.starts_with(letters);
      if (with) word.remove_prefix(letters.size());
      return with;
    };
    if (starts("ST")) further_ += 2;
    color_ = starts("C");
    if (starts("N")) further_ += 3;
    if (word != "OFF") text_.fail("expected OFF, COFF, NOFF, CNOFF, STOFF or STCNOFF, found {}", found);
    if (!text_.more() && !text_.next_line()) text_.fail("expected the numbers of vertices, facets and edges");
  }

  void next_record(std::string_view what, std::uint32_t read, std::uint32_t promised) {
    if (!text_.next_line()) text_.fail("{} {} are promised, the file ends after {}", promised, what, read);
  }

  void vertex() {
    Vec3 x;
    for (double& c : x) c = text_.number("a coordinate");
    surface_.vertices.push_back(x);
    std::size_t further = 0;
    for (; text_.more(); ++further) text_.unused_number("a number");
    const std::size_t color = further - std::min(further, further_);
    if (further < further_ || (color_ ? color != 3 && color != 4 : color != 0))
      text_.fail(
          "expected {} numbers for a vertex, found {}",
          color_ ? fmt::format("{} or {}", 6 + further_, 7 + further_) : fmt::format("{}", 3 + further_),
          3 + further);
  }

  /// n, n corners and a colour of no, one, three or four numbers.
  void facet(std::uint32_t vertices) {
    const std::uint32_t corners = text_.count("the number of corners");
    if (corners < 3) text_.fail("expected a facet of 3 corners or more, found {}", corners);
    for (std::uint32_t k = 0; k < corners; ++k) {
      const std::int64_t corner = text_.integer("a corner");
      if (corner < 0 || corner >= vertices)
        text_.fail("corner {}: expected one of the {} vertices, counted from 0", corner, vertices);
      surface_.corners.push_back(static_cast<std::uint32_t>(corner));
    }
    surface_.end_facet(text_.line());
    std::size_t color = 0;
    for (; text_.more(); ++color) text_.unused_number("a colour");
    if (color == 2 || color > 4)
      text_.fail("expected {} corners and a colour of 1, 3 or 4 numbers at most, found {} more", corners,
                 color);
  }

  Text text_;
  FileSurface surface_;
  std::size_t further_ = 0;  // numbers of a vertex, without its colour
  bool color_ = false;
};

}  // namespace

FileSurface read_off(std::string_view bytes, const std::string& name) {
  return OffReader(bytes, name).read();
}

}  // namespace cairn
