#include <algorithm>
#include <charconv>
#include <utility>

#include "shape/mesh_file/file_surface.h"
#include "shape/mesh_file/text.h"

namespace cairn {
namespace {

constexpr std::string_view kNames[] = {"g",        "o",      "s",          "usemtl",   "mtllib",
                                       "usemap",   "maplib", "mg",         "bevel",    "c_interp",
                                       "d_interp", "lod",    "shadow_obj", "trace_obj"};
constexpr std::string_view kFreeForm[] = {"vp",   "cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                          "parm", "trim",   "hole", "scrv", "sp",   "end",  "con"};

template <std::size_t n>
bool is_one_of(const std::string_view (&list)[n], std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& name)
      : text_(bytes, name, {.comments = true, .continued = true}) {}

  FileSurface read() {
    while (text_.next_line()) {
      const std::string_view word = text_.word();
      if (word == "v")
        vertex();
      else if (word == "f")
        facet();
      else if (word == "vn")
        unused("a component of a normal", 3, 3);
      else if (word == "vt")
        unused("a texture coordinate", 1, 3);
      else if (word == "l" || word == "p")
        element();
      else if (is_one_of(kFreeForm, word))
        text_.fail("'{}': curves and free-form surfaces are not read; expected facets", word);
      else if (!is_one_of(kNames, word))
        text_.fail("expected v, f or another word of OBJ files, found {}", in_quotes(word));
    }
    if (surface_.ends.empty()) text_.fail("expected facets, found none up to here, the end of the file");
    if (elements_ > 0)
      surface_.notes.push_back(fmt::format("left out {} lines and points, which are no surface", elements_));
    count_.settle(surface_, text_.name());
    return std::move(surface_);
  }

 private:
  /// x y z, then a weight or an intensity, then a colour: none of them of use here.
  void vertex() {
    Vec3 x;
    for (double& c : x) c = text_.number("a coordinate");
    surface_.vertices.push_back(x);
    std::size_t further = 0;
    for (; text_.more(); ++further) text_.unused_number("a number");
    if (further != 0 && further != 1 && further != 3 && further != 4)
      text_.fail("expected 3 coordinates, 4 with a weight, 6 or 7 with a colour, found {} numbers",
                 3 + further);
    // A blank within a number makes two of it: a line that has one number more than others is no colour's.
    const bool weight = further % 3 == 1;
    if (surface_.vertices.size() == 1) weight_ = weight;
    if (weight != weight_)
      text_.fail("expected {} numbers as in the vertices before, found {}", weight_ ? "4 or 7" : "3 or 6",
                 3 + further);
  }

  void facet() {
    for (; text_.more(); ++corners_) {
      const std::int64_t corner = resolve(reference(), surface_.vertices.size());
      count_.see(corner, text_.line());
      surface_.corners.push_back(static_cast<std::uint32_t>(corner));
    }
    if (std::exchange(corners_, 0) < 3) text_.fail("expected a facet of 3 corners or more");
    surface_.end_facet(text_.line());
  }

  /// The vertex of a corner: `5`, `5/2`, `5//3` or `5/2/3`.
  std::int64_t reference() {
    const std::string_view word = text_.word();
    const char* at = word.data();
    const char* const end = at + word.size();
    std::int64_t vertex = 0;
    const auto number = [&](std::int64_t& value) {
      const auto [last, error] = std::from_chars(at, end, value);
      at = last;
      return error == std::errc();
    };
    bool good = number(vertex);
    for (int part = 0; good && at != end && part < 2; ++part) {  // what is empty is absent
      std::int64_t other = 1;
      good = *at++ == '/';
      if (good && at != end && *at != '/') good = number(other) && other != 0;
    }
    if (!good || at != end)
      text_.fail("expected a corner like 5, 5/2, 5//3 or 5/2/3, found {}", in_quotes(word));
    return vertex;
  }

  /// Counted from 1 from the start of the file; negative ones go back from the last vertex so far.
  std::int64_t resolve(std::int64_t corner, std::size_t vertices) {
    if (corner < 0) {
      count_.require(1);
      const auto back = corner + static_cast<std::int64_t>(vertices) + 1;
      if (back < 1) text_.fail("corner {}: there are {} vertices before", corner, vertices);
      return back;
    }
    if (corner > std::numeric_limits<std::uint32_t>::max()) text_.fail("corner {}: no such vertex", corner);
    return corner;
  }

  void unused(std::string_view what, std::size_t fewest, std::size_t most) {
    std::size_t count = 0;
    for (; text_.more(); ++count) text_.unused_number(what);
    if (count < fewest || count > most)
      text_.fail("expected {}{} numbers, found {}", fewest == most ? "" : fmt::format("{} to ", fewest), most,
                 count);
  }

  void element() {
    if (!text_.more()) text_.fail("expected a vertex, found the end of the line");
    while (text_.more()) reference();
    ++elements_;
  }

  Text text_;
  FileSurface surface_;
  CornerCount count_;
  std::size_t corners_ = 0, elements_ = 0;
  bool weight_ = false;
};

}  // namespace

FileSurface read_obj(std::string_view bytes, const std::string& name) {
  return ObjReader(bytes, name).read();
}

}  // namespace cairn
