#include "shape/shape_file.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/suggest.h"
#include "core/toml_guard.h"

namespace cairn {
namespace {

constexpr std::size_t kMostSpheres = 100000;
constexpr std::size_t kLongestText = 1000;          // characters of a name or description
constexpr double kSmallest = 1e-6, kLargest = 1e6;  // radii and coordinates, in reference radii

// Text from a file, safe to print on one line.
std::string printable(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string line;
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    line += byte < 0x20 || byte == 0x7f ? '?' : c;
  }
  return text.size() > longest ? line + "..." : line;
}

class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  Shape read(const toml::table& root) const {
    check_keys(root, {"name", "description", "sphere"});
    Shape shape;
    shape.name = text(root, "name");
    if (shape.name.empty()) fail(*root.get("name"), "name", "expected a name, found an empty string");
    if (root.contains("description")) shape.description = text(root, "description");

    const toml::node& spheres = required(root, "sphere", "expected at least one [[sphere]] table");
    const toml::array* tables = spheres.as_array();
    if (!tables || tables->empty() || !tables->is_homogeneous<toml::table>())
      fail(spheres, "sphere", "expected one [[sphere]] table for each sphere");
    if (tables->size() > kMostSpheres)
      fail(spheres, "sphere",
           fmt::format("expected at most {} spheres, found {}", kMostSpheres, tables->size()));
    for (const toml::node& node : *tables) {
      const toml::table& sphere = *node.as_table();
      check_keys(sphere, {"center", "radius"});
      shape.centers.push_back(center(sphere));
      shape.radii.push_back(radius(sphere));
    }
    check_distinct(shape, *tables);
    return shape;
  }

 private:
  [[noreturn]] void fail(const toml::source_region& at, std::string_view key,
                         std::string_view expected) const {
    throw InputError("{}:{}:{}: key '{}': {}", file_, at.begin.line, at.begin.column, printable(key),
                     expected);
  }
  [[noreturn]] void fail(const toml::node& at, std::string_view key, std::string_view expected) const {
    fail(at.source(), key, expected);
  }

  void check_keys(const toml::table& table, const std::vector<std::string>& known) const {
    for (const auto& [key, value] : table) {
      if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
      const std::string nearest = nearest_name(key.str().substr(0, 100), known);
      fail(key.source(), key.str(),
           nearest.empty() ? fmt::format("unknown, expected {}", fmt::join(known, ", "))
                           : fmt::format("unknown, did you mean '{}'?", nearest));
    }
  }

  const toml::node& required(const toml::table& table, std::string_view key,
                             std::string_view expected) const {
    const toml::node* node = table.get(key);
    if (!node) fail(table, key, fmt::format("missing, {}", expected));
    return *node;
  }

  std::string text(const toml::table& table, std::string_view key) const {
    constexpr std::string_view expected = "expected one line of text in quotes";
    const toml::node& node = required(table, key, expected);
    const toml::value<std::string>* value = node.as_string();
    if (!value) fail(node, key, expected);
    const std::string& line = value->get();
    const bool control =
        std::any_of(line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
    if (control || line.size() > kLongestText)
      fail(node, key, fmt::format("{} of at most {} characters", expected, kLongestText));
    return line;
  }

  double number(const toml::node& node, std::string_view key, double least, double most,
                std::string_view expected) const {
    const bool is_number = node.is_floating_point() || node.is_integer();
    const double value = is_number ? *node.value<double>() : std::nan("");
    if (!(value >= least && value <= most)) fail(node, key, expected);
    return value;
  }

  Vec3 center(const toml::table& sphere) const {
    const std::string expected = fmt::format(
        "expected three numbers [x, y, z] between {} and {} (reference radii)", -kLargest, kLargest);
    const toml::node& node = required(sphere, "center", expected);
    const toml::array* array = node.as_array();
    if (!array || array->size() != 3) fail(node, "center", expected);
    Vec3 center;
    for (std::size_t i = 0; i < 3; ++i)
      center[static_cast<Eigen::Index>(i)] = number(*array->get(i), "center", -kLargest, kLargest, expected);
    return center;
  }

  double radius(const toml::table& sphere) const {
    const std::string expected =
        fmt::format("expected a number from {} to {} (reference radii)", kSmallest, kLargest);
    return number(required(sphere, "radius", expected), "radius", kSmallest, kLargest, expected);
  }

  void check_distinct(const Shape& shape, const toml::array& tables) const {
    std::vector<std::size_t> order(shape.radii.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) {
      const Vec3& c = shape.centers[i];
      return std::array{c.x(), c.y(), c.z(), shape.radii[i]};
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return key(i) < key(j); });
    for (std::size_t n = 1; n < order.size(); ++n)
      if (key(order[n - 1]) == key(order[n]))
        fail(*tables.get(order[n]), "sphere",
             fmt::format("expected distinct spheres, found a copy of the one on line {}",
                         tables.get(order[n - 1])->source().begin.line));
  }

  std::string file_;
};

}  // namespace

Shape parse_shape(std::string_view text, const std::string& file) {
  if (const auto complaint = check_toml(text, static_cast<int>(kMostSpheres) + 10))
    throw InputError("{}:{}:{}: {}", file, complaint->line, complaint->column, complaint->what);
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position& at = error.source().begin;
    constexpr std::size_t longest = 300;
    std::string what(error.description().substr(0, longest));
    std::replace_if(
        what.begin(), what.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    throw InputError("{}:{}:{}: not valid TOML: {}", file, at.line, at.column, what);
  }
  return Reader(file).read(root);
}

}  // namespace cairn
