#include "shape/mesh_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstring>
#include <limits>
#include <string>

#include "core/error.h"

namespace cairn {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The words of a text, line by line, and the raw values that may follow them.
class Words {
 public:
  explicit Words(std::string_view bytes) : bytes_(bytes) {}

  /// Passes over blanks, comments and, if told so, ends of lines. False if no word follows.
  bool more(bool on_next_lines) {
    for (; at_ < bytes_.size(); ++at_) {
      if (bytes_[at_] == '#') at_ = end_of_line();
      if (at_ == bytes_.size()) break;
      if (bytes_[at_] == '\\' && ends_line(at_ + 1)) {  // the line goes on below
        at_ = bytes_.find('\n', at_);
      } else if (bytes_[at_] == '\n' ? !on_next_lines : !blank(bytes_[at_])) {
        return bytes_[at_] != '\n';
      }
    }
    return false;
  }

  /// The next word, wherever it is; empty at the end of the text.
  std::string_view word() {
    const std::size_t first = more(true) ? at_ : bytes_.size();
    at_ = first;
    while (at_ < bytes_.size() && bytes_[at_] != '\n' && !blank(bytes_[at_])) ++at_;
    return bytes_.substr(first, at_ - first);
  }

  double number() {
    const std::string_view found = word();
    const std::string_view digits = found.starts_with('+') ? found.substr(1) : found;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size()) fail("a number", found);
    return value;
  }

  template <std::unsigned_integral T = std::uint32_t>
  T count() {
    const std::string_view found = word();
    T value = 0;
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error != std::errc() || end != found.data() + found.size()) fail("a whole number", found);
    return value;
  }

  Vec3 vector() {
    Vec3 x;
    for (double& component : x) component = number();
    return x;
  }

  void expect(std::string_view what) {
    const std::string_view found = word();
    if (found != what) fail(fmt::format("'{}'", what), found);
  }

  /// Goes to the beginning of the next line.
  void skip_line() { at_ = std::min(end_of_line() + 1, bytes_.size()); }

  /// The next bytes as a value of type `T`, those of highest weight first if `swapped`.
  template <class T>
  T raw(bool swapped = false) {
    if (bytes_.size() - at_ < sizeof(T)) throw InputError("expected more bytes, found the end of the file");
    char bytes[sizeof(T)];
    bytes_.copy(bytes, sizeof(T), at_);
    at_ += sizeof(T);
    if (swapped) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  [[noreturn]] void fail(std::string_view expected, std::string_view found) const {
    std::string word(found.substr(0, 40));
    std::replace_if(
        word.begin(), word.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    const auto here = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
    throw InputError("line {}: expected {}, found {}", 1 + std::count(bytes_.begin(), here, '\n'), expected,
                     at_ == bytes_.size() && found.empty() ? "the end of the file" : "'" + word + "'");
  }

 private:
  static bool blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r' && c != '\n'); }
  bool ends_line(std::size_t at) const {
    return bytes_.substr(at, 2) == "\r\n" || bytes_.substr(at, 1) == "\n";
  }
  std::size_t end_of_line() const { return std::min(bytes_.find('\n', at_), bytes_.size()); }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

// ---- PLY: a header says which elements with which properties follow

struct Type {
  std::string_view name, other_name;
  double (*raw)(Words&, bool swapped);
};

template <class T>
double raw_as_double(Words& words, bool swapped) {
  return words.raw<T>(swapped);
}

constexpr Type kTypes[] = {
    {"char", "int8", raw_as_double<std::int8_t>},    {"uchar", "uint8", raw_as_double<std::uint8_t>},
    {"short", "int16", raw_as_double<std::int16_t>}, {"ushort", "uint16", raw_as_double<std::uint16_t>},
    {"int", "int32", raw_as_double<std::int32_t>},   {"uint", "uint32", raw_as_double<std::uint32_t>},
    {"float", "float32", raw_as_double<float>},      {"double", "float64", raw_as_double<double>},
};

struct Property {
  std::string_view name;
  const Type* type;
  const Type* count = nullptr;  // of a list
};

struct Element {
  std::string_view name;
  std::uint64_t count;
  std::vector<Property> properties;
};

class Ply {
 public:
  explicit Ply(std::string_view bytes) : words_(bytes) {}

  Polygons read() {
    read_header();
    for (const Element& element : elements_)
      // Every row takes a byte or more of the file unless it is empty.
      for (std::uint64_t row = 0; row < element.count && !element.properties.empty(); ++row)
        if (element.name == "vertex") {
          read_vertex(element);
        } else {
          read_row(element);
        }
    return std::move(polygons_);
  }

 private:
  void read_header() {
    words_.expect("ply");
    words_.expect("format");
    const std::string_view format = words_.word();
    text_ = format == "ascii";
    swapped_ = format == "binary_big_endian";
    if (!text_ && !swapped_ && format != "binary_little_endian")
      words_.fail("'ascii', 'binary_little_endian' or 'binary_big_endian'", format);
    for (;;) {
      words_.skip_line();
      const std::string_view word = words_.word();
      if (word == "end_header") break;
      if (word == "element") {
        const std::string_view name = words_.word();
        elements_.push_back({name, words_.count<std::uint64_t>(), {}});
      } else if (word == "property" && !elements_.empty()) {
        elements_.back().properties.push_back(read_property());
      } else if (word != "comment" && word != "obj_info") {
        words_.fail("'element', 'property', 'comment' or 'end_header'", word);
      }
    }
    words_.skip_line();
  }

  Property read_property() {
    Property property{};
    std::string_view word = words_.word();
    if (word == "list") {
      property.count = find_type(words_.word());
      word = words_.word();
    }
    property.type = find_type(word);
    property.name = words_.word();
    return property;
  }

  const Type* find_type(std::string_view name) const {
    for (const Type& type : kTypes)
      if (name == type.name || name == type.other_name) return &type;
    words_.fail("a type", name);
  }

  double value(const Type& type) { return text_ ? words_.number() : type.raw(words_, swapped_); }

  std::uint32_t index(const Type& type) {
    const double x = value(type);
    if (!(x >= 0.0 && x <= std::numeric_limits<std::uint32_t>::max() && x == std::floor(x)))
      throw InputError("expected a whole number that is not negative in a list, found {:g}", x);
    return static_cast<std::uint32_t>(x);
  }

  void read_vertex(const Element& element) {
    Vec3 x = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    for (const Property& property : element.properties) {
      if (property.count) throw InputError("expected vertices without lists");
      const double found = value(*property.type);
      if (property.name.size() == 1 && property.name >= "x" && property.name <= "z")
        x[property.name[0] - 'x'] = found;
    }
    polygons_.vertices.push_back(x);
  }

  void read_row(const Element& element) {
    for (const Property& property : element.properties) {
      const bool corners = element.name == "face" && property.count &&
                           (property.name == "vertex_indices" || property.name == "vertex_index");
      const std::uint32_t count = property.count ? index(*property.count) : 1;
      for (std::uint32_t k = 0; k < count; ++k)
        if (corners) {
          polygons_.corners.push_back(index(*property.type));
        } else {
          value(*property.type);
        }
      if (corners) polygons_.ends.push_back(polygons_.corners.size());
    }
  }

  Words words_;
  bool text_ = false, swapped_ = false;
  std::vector<Element> elements_;
  Polygons polygons_;
};

Polygons read_binary_stl(std::string_view bytes) {
  Polygons polygons;
  Words words(bytes.substr(80));
  const auto count = words.raw<std::uint32_t>();
  for (std::uint32_t t = 0; t < count; ++t) {
    words.raw<std::array<float, 3>>();  // normal
    for (int k = 0; k < 3; ++k) {
      const auto [x, y, z] = words.raw<std::array<float, 3>>();
      polygons.corners.push_back(static_cast<std::uint32_t>(polygons.vertices.size()));
      polygons.vertices.emplace_back(x, y, z);
    }
    polygons.ends.push_back(polygons.corners.size());
    words.raw<std::uint16_t>();  // colour
  }
  return polygons;
}

std::string lower(std::string_view text) {
  std::string word(text);
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word;
}

Polygons read_text_stl(std::string_view bytes) {
  Polygons polygons;
  Words words(bytes);
  while (words.more(true)) {
    const std::string word = lower(words.word());
    if (word == "vertex") {
      polygons.corners.push_back(static_cast<std::uint32_t>(polygons.vertices.size()));
      polygons.vertices.push_back(words.vector());
    } else if (word == "endloop") {
      polygons.ends.push_back(polygons.corners.size());
      if (polygons.corners.size() != 3 * polygons.ends.size())
        words.fail("three vertices in every loop", word);
    } else if (word == "solid" || word == "facet" || word == "endsolid") {
      words.skip_line();  // a name or a normal
    } else if (word != "outer" && word != "loop" && word != "endfacet") {
      words.fail("'facet', 'outer loop', 'vertex', 'endloop', 'endfacet' or 'endsolid'", word);
    }
  }
  if (polygons.corners.size() != 3 * polygons.ends.size()) words.fail("'endloop'", "");
  return polygons;
}

}  // namespace

Polygons read_obj(std::string_view bytes) {
  Polygons polygons;
  for (Words words(bytes); words.more(true); words.skip_line()) {
    const std::string_view statement = words.word();
    if (statement == "v") {
      polygons.vertices.push_back(words.vector());
    } else if (statement == "f") {
      while (words.more(false)) {
        const std::string_view corner = words.word();  // vertex/texture/normal
        const char* const end = corner.data() + std::min(corner.find('/'), corner.size());
        std::int64_t number = 0;  // from 1, or from -1 backwards
        const auto [read, error] = std::from_chars(corner.data(), end, number);
        if (number < 0) number += static_cast<std::int64_t>(polygons.vertices.size()) + 1;
        if (error != std::errc() || read != end || number < 1 ||
            number > std::numeric_limits<std::uint32_t>::max())
          words.fail("the number of a vertex", corner);
        polygons.corners.push_back(static_cast<std::uint32_t>(number - 1));
      }
      polygons.ends.push_back(polygons.corners.size());
    }
  }
  return polygons;
}

Polygons read_off(std::string_view bytes) {
  Polygons polygons;
  Words words(bytes);
  const std::string_view kind = words.word();
  if (!kind.ends_with("OFF") || kind.find_first_of("4n") != kind.npos) words.fail("'OFF'", kind);
  const auto vertices = words.count(), faces = words.count();
  words.skip_line();  // number of edges
  for (std::uint32_t v = 0; v < vertices; ++v) {
    polygons.vertices.push_back(words.vector());
    words.skip_line();
  }
  for (std::uint32_t f = 0; f < faces; ++f) {
    const auto corners = words.count();
    for (std::uint32_t k = 0; k < corners; ++k) polygons.corners.push_back(words.count());
    polygons.ends.push_back(polygons.corners.size());
    words.skip_line();
  }
  return polygons;
}

Polygons read_stl(std::string_view bytes) {
  if (bytes.size() < 84) return read_text_stl(bytes);
  // A binary file may begin with "solid", too, but then its length is what its number of triangles says.
  const std::size_t length = 84 + std::size_t{50} * Words(bytes.substr(80)).raw<std::uint32_t>();
  return bytes.size() != length && lower(Words(bytes).word()) == "solid" ? read_text_stl(bytes)
                                                                         : read_binary_stl(bytes);
}

Polygons read_ply(std::string_view bytes) {
  return Ply(bytes).read();
}

}  // namespace cairn
