#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "shape/mesh_file/bytes.h"
#include "shape/mesh_file/file_surface.h"
#include "shape/mesh_file/ply_header.h"
#include "shape/mesh_file/text.h"

namespace cairn {
namespace {

/// Which properties of an element are of use: x, y, z of a vertex, the corners of a facet.
struct Use {
  std::array<std::size_t, 3> xyz{};
  std::size_t corners = 0;
  bool vertex = false, facet = false;
};

/// Values of an ASCII file: one element a line.
class AsciiValues {
 public:
  AsciiValues(std::string_view bytes, const std::string& name, std::size_t header_lines)
      : text_(bytes, name, {.comments = false}) {
    while (text_.line() < header_lines) text_.next_line();
  }

  void begin(const PlyElement& element, std::uint32_t number) {
    if (!text_.next_line())
      text_.fail("{} of '{}' are promised (line {}), the file ends after {}", element.count, element.name,
                 element.line, number);
  }
  void end() { text_.end_line(); }
  std::int64_t integer(PlyType) { return text_.integer("a whole number"); }
  double number(PlyType) { return text_.number("a coordinate"); }
  void skip(PlyType) { text_.unused_number("a number"); }
  void finish() {
    if (text_.next_line()) text_.fail("expected the end of the file, found {}", in_quotes(text_.word()));
  }
  std::size_t line() const { return text_.line(); }
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> words, Args&&... args) const {
    text_.fail(words, std::forward<Args>(args)...);
  }

 private:
  Text text_;
};

/// Values of a binary file. It has no lines: complaints name that of the element in the header.
class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, const std::string& name, bool swapped)
      : from_(bytes, swapped), name_(name) {}

  void begin(const PlyElement& element, std::uint32_t number) {
    element_ = &element;
    number_ = number;
  }
  void end() {}
  std::int64_t integer(PlyType type) {
    require(size_of(type));
    switch (type) {
      case PlyType::int8:
        return from_.take<std::int8_t>();
      case PlyType::uint8:
        return from_.take<std::uint8_t>();
      case PlyType::int16:
        return from_.take<std::int16_t>();
      case PlyType::uint16:
        return from_.take<std::uint16_t>();
      case PlyType::int32:
        return from_.take<std::int32_t>();
      default:
        return from_.take<std::uint32_t>();
    }
  }
  double number(PlyType type) {
    if (is_integer(type)) return static_cast<double>(integer(type));
    require(size_of(type));
    const double value = type == PlyType::float32 ? from_.take<float>() : from_.take<double>();
    if (!std::isfinite(value)) fail("a coordinate that is not finite");
    return value;
  }
  void skip(PlyType type) {
    require(size_of(type));
    from_.skip(size_of(type));
  }
  void finish() {
    if (from_.left() > 0)
      throw InputError("{}: expected the end of the file after its elements, found {} more bytes", name_,
                       from_.left());
  }
  std::size_t line() const { return 0; }
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> words, Args&&... args) const {
    throw InputError("{}:{}: '{}' {}: {}", name_, element_->line, element_->name, number_ + 1,
                     fmt::format(words, std::forward<Args>(args)...));
  }

 private:
  void require(std::size_t bytes) const {
    if (from_.left() < bytes)
      throw InputError("{}:{}: {} of '{}' are promised, the file ends after {}", name_, element_->line,
                       element_->count, element_->name, number_);
  }

  Bytes from_;
  const std::string& name_;
  const PlyElement* element_ = nullptr;
  std::uint32_t number_ = 0;
};

Use use_of(const PlyElement& element, const std::string& name) {
  Use use;
  const auto find = [&](std::string_view property, bool list) -> std::optional<std::size_t> {
    for (std::size_t p = 0; p < element.properties.size(); ++p)
      if (element.properties[p].name == property && element.properties[p].list == list) return p;
    return {};
  };
  if (element.properties.empty() && element.count > 0)
    throw InputError("{}:{}: '{}' has no property", name, element.line, element.name);
  if (element.name == "vertex") {
    use.vertex = true;
    constexpr const char* names[] = {"x", "y", "z"};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = find(names[k], false);
      if (!found) throw InputError("{}:{}: expected a property {} of 'vertex'", name, element.line, names[k]);
      use.xyz[k] = *found;
    }
  }
  if (element.name == "face") {
    use.facet = true;
    auto found = find("vertex_indices", true);
    if (!found) found = find("vertex_index", true);
    if (!found || !is_integer(element.properties[*found].type))
      throw InputError("{}:{}: expected a list vertex_indices of whole numbers in 'face'", name,
                       element.line);
    use.corners = *found;
  }
  if (use.facet && element.count == 0)
    throw InputError("{}:{}: expected a facet or more, found none", name, element.line);
  if (element.name == "tristrips")
    throw InputError("{}:{}: strips of triangles are not read; expected an element 'face'", name,
                     element.line);
  return use;
}

template <class Values>
void read_element(const PlyElement& element, const Use& use, std::uint32_t vertices, Values& values,
                  FileSurface& surface) {
  for (std::uint32_t n = 0; n < element.count; ++n) {
    values.begin(element, n);
    Vec3 x = Vec3::Zero();
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const auto axis = std::find(use.xyz.begin(), use.xyz.end(), p);
      if (use.vertex && axis != use.xyz.end()) {
        x[axis - use.xyz.begin()] = values.number(property.type);
        continue;
      }
      if (!property.list) {
        values.skip(property.type);
        continue;
      }
      const bool corners = use.facet && p == use.corners;
      const std::int64_t length = values.integer(property.count_type);
      if (length < 0 || (corners && length < 3))
        values.fail("expected a list of {} or more, found {}", corners ? "3 corners" : "no number", length);
      for (std::int64_t k = 0; k < length; ++k) {
        if (!corners) {
          values.skip(property.type);
          continue;
        }
        const std::int64_t corner = values.integer(property.type);
        if (corner < 0 || corner >= vertices)
          values.fail("corner {}: expected one of the {} vertices, counted from 0", corner, vertices);
        surface.corners.push_back(static_cast<std::uint32_t>(corner));
      }
    }
    values.end();
    if (use.vertex) surface.vertices.push_back(x);
    if (use.facet) surface.end_facet(values.line());
  }
}

template <class Values>
FileSurface read_elements(const PlyHeader& header, const std::string& name, Values values) {
  const auto element = [&](std::string_view what) {
    return std::find_if(header.elements.begin(), header.elements.end(),
                        [&](const PlyElement& e) { return e.name == what; });
  };
  for (const char* needed : {"vertex", "face"})
    if (element(needed) == header.elements.end() && element("tristrips") == header.elements.end())
      throw InputError("{}:{}: expected an element '{}' in the header", name, header.lines, needed);
  FileSurface surface;
  const auto vertex = element("vertex");
  const std::uint32_t vertices = vertex == header.elements.end() ? 0 : vertex->count;
  for (const PlyElement& e : header.elements) {
    const Use use = use_of(e, name);
    if (use.vertex && header.format != PlyFormat::ascii &&
        std::any_of(use.xyz.begin(), use.xyz.end(),
                    [&](std::size_t p) { return e.properties[p].type == PlyType::float32; }))
      surface.rounding = kSingleRounding;
    read_element(e, use, vertices, values, surface);
  }
  values.finish();
  return surface;
}

}  // namespace

FileSurface read_ply(std::string_view bytes, const std::string& name) {
  const PlyHeader header = read_ply_header(bytes, name);
  if (header.format == PlyFormat::ascii)
    return read_elements(header, name, AsciiValues(bytes, name, header.lines));
  const bool swapped =
      (header.format == PlyFormat::big_endian) == (std::endian::native == std::endian::little);
  return read_elements(header, name, BinaryValues(bytes.substr(header.bytes), name, swapped));
}

}  // namespace cairn
