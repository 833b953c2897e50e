#include "shape/mesh_file/ply_header.h"

#include <algorithm>
#include <utility>

#include "shape/mesh_file/text.h"

namespace cairn {
namespace {

constexpr std::pair<std::string_view, PlyType> kTypes[] = {
    {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64}};

constexpr std::pair<std::string_view, PlyFormat> kFormats[] = {
    {"ascii", PlyFormat::ascii},
    {"binary_little_endian", PlyFormat::little_endian},
    {"binary_big_endian", PlyFormat::big_endian}};

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : text_(bytes, name, {.comments = false}) {}

  PlyHeader read() {
    if (!text_.next_line() || text_.word() != "ply") text_.fail("expected 'ply' as the first line");
    text_.end_line();
    bool format = false;
    for (std::string_view word = next(); word != "end_header"; word = next()) {
      if (word == "comment" || word == "obj_info") {
        text_.rest();
      } else if (word == "format" && !format) {
        format = true;
        header_.format = one_of(kFormats, text_.word(), "ascii, binary_little_endian or binary_big_endian");
        if (const auto version = text_.word(); version != "1.0")
          text_.fail("expected version 1.0, found {}", in_quotes(version));
      } else if (word == "element") {
        element();
      } else if (word == "property" && !header_.elements.empty()) {
        property();
      } else {
        text_.fail("expected comment, element, property or end_header{}, found {}",
                   format ? "" : ", and format once before", in_quotes(word));
      }
      text_.end_line();
    }
    text_.end_line();
    if (!format) text_.fail("expected a line 'format ...' before the end of the header");
    header_.bytes = text_.next_offset();
    header_.lines = text_.line();
    return std::move(header_);
  }

 private:
  std::string_view next() {
    if (!text_.next_line()) text_.fail("the file ends before 'end_header'");
    return text_.word();
  }

  template <class T, std::size_t n>
  T one_of(const std::pair<std::string_view, T> (&list)[n], std::string_view word,
           std::string_view expected) {
    for (const auto& [name, value] : list)
      if (word == name) return value;
    text_.fail("expected {}, found {}", expected, in_quotes(word));
  }
  PlyType type(std::string_view word) {
    return one_of(kTypes, word, "a type (char, uchar, short, ushort, int, uint, float or double)");
  }

  std::string new_name(const auto& known) {
    std::string name(text_.word());
    if (name.empty()) text_.fail("expected a name, found the end of the line");
    for (const auto& other : known)
      if (other.name == name) text_.fail("{} for a second time", in_quotes(name));
    return name;
  }

  void element() {
    PlyElement element;
    element.name = new_name(header_.elements);
    element.count = text_.count("the number of elements");
    element.line = text_.line();
    header_.elements.push_back(std::move(element));
  }

  void property() {
    PlyProperty property;
    std::vector<PlyProperty>& all = header_.elements.back().properties;
    std::string_view word = text_.word();
    if (word == "list") {
      property.list = true;
      property.count_type = type(text_.word());
      if (!is_integer(property.count_type)) text_.fail("expected a length of a list in whole numbers");
      word = text_.word();
    }
    property.type = type(word);
    property.name = new_name(all);
    all.push_back(std::move(property));
  }

  Text text_;
  PlyHeader header_;
};

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

bool is_integer(PlyType type) {
  return type != PlyType::float32 && type != PlyType::float64;
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& name) {
  return HeaderReader(bytes, name).read();
}

}  // namespace cairn
