#include "shape/shape_file.h"

#include <toml++/toml.h>

#include <Eigen/Cholesky>
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

constexpr double kSmallestUnit = 1e-12, kLargestUnit = 1e12;  // m
constexpr double kFarthest = 1e15;                            // m

constexpr std::pair<const char*, double FitError::*> kErrors[] = {
    {"rms", &FitError::rms},
    {"rms_from_mesh", &FitError::rms_from_mesh},
    {"rms_from_spheres", &FitError::rms_from_spheres},
    {"greatest_from_mesh", &FitError::greatest_from_mesh},
    {"greatest_from_spheres", &FitError::greatest_from_spheres},
    {"volume", &FitError::volume},
    {"centroid", &FitError::centroid},
    {"inertia", &FitError::inertia},
    {"inertia_of_spheres", &FitError::inertia_of_spheres},
};

template <class Names, class Value>
std::string name_of(const Names& names, Value value) {
  for (const auto& [name, of] : names)
    if (of == value) return name;
  return {};
}

// A number that reads back as the same one, and as a number with a fraction.
std::string exact(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return text;
}

std::string exact(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", exact(v.x()), exact(v.y()), exact(v.z()));
}

// A symmetric tensor as xx, yy, zz, xy, xz, yz.
std::string exact(const Mat3& m) {
  return fmt::format("[{}, {}, {}, {}, {}, {}]", exact(m(0, 0)), exact(m(1, 1)), exact(m(2, 2)),
                     exact(m(0, 1)), exact(m(0, 2)), exact(m(1, 2)));
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\u{:04X}", byte);
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

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
    check_keys(root, {"name", "description", "body", "mesh", "error", "fit", "sphere"});
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
      check_keys(sphere, {"center", "radius", "mass"});
      shape.centers.push_back(center(sphere));
      shape.radii.push_back(radius(sphere));
      if (tables->get(0)->as_table()->contains("mass"))
        shape.own.of_spheres.push_back(mass(sphere));
      else if (sphere.contains("mass"))
        fail(*sphere.get("mass"), "mass", "expected masses of all spheres or of none; the first has none");
    }
    check_distinct(shape, *tables);
    if (root.contains("body")) {
      const toml::table& body = table(root, "body");
      read_body(body, shape.own);
      if (const auto complaint = check_own_mass(shape))
        fail(*body.get(complaint->key), complaint->key, complaint->what);
    }
    if (root.contains("mesh")) shape.source = source(table(root, "mesh"));
    if (root.contains("error")) {
      if (!shape.source) fail(*root.get("error"), "error", "expected a [mesh] table beside it");
      shape.source->error = error(table(root, "error"));
    }
    if (root.contains("fit")) {
      if (!shape.source) fail(*root.get("fit"), "fit", "expected a [mesh] table beside it");
      shape.source->fit = fit(table(root, "fit"));
    }
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

  const toml::table& table(const toml::table& root, std::string_view key) const {
    const toml::table* found = root.get(key)->as_table();
    if (!found) fail(*root.get(key), key, fmt::format("expected a table [{}]", key));
    return *found;
  }

  template <std::size_t count>
  std::array<double, count> numbers(const toml::table& from, std::string_view key, double most) const {
    const std::string expected = fmt::format("expected {} numbers between {:g} and {:g}", count, -most, most);
    const toml::node& node = required(from, key, expected);
    const toml::array* array = node.as_array();
    if (!array || array->size() != count) fail(node, key, expected);
    std::array<double, count> out;
    for (std::size_t i = 0; i < count; ++i) out[i] = number(*array->get(i), key, -most, most, expected);
    return out;
  }

  double positive(const toml::table& from, std::string_view key, double least, double most) const {
    const std::string expected = fmt::format("expected a number from {:g} to {:g}", least, most);
    return number(required(from, key, expected), key, least, most, expected);
  }

  /// Mass properties of the body's own.
  void read_body(const toml::table& from, OwnMass& own) const {
    check_keys(from, {"center_of_mass", "inertia"});
    if (from.contains("center_of_mass"))
      own.center = Vec3(numbers<3>(from, "center_of_mass", kLargest).data());
    if (!from.contains("inertia")) return;
    const toml::node& node = *from.get("inertia");
    const double most = kLargest * kLargest;
    Mat3 inertia = Mat3::Zero();
    if (node.is_array() && node.as_array()->size() == 3) {
      inertia.diagonal() = Vec3(numbers<3>(from, "inertia", most).data());
    } else if (node.is_array() && node.as_array()->size() == 6) {
      const auto [xx, yy, zz, xy, xz, yz] = numbers<6>(from, "inertia", most);
      inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    } else {
      fail(node, "inertia",
           "expected [xx, yy, zz] or [xx, yy, zz, xy, xz, yz], per mass, in reference radii^2");
    }
    own.inertia = inertia;
  }

  SourceMesh source(const toml::table& from) const {
    check_keys(from, {"file", "unit", "size", "origin", "volume", "centroid", "inertia"});
    SourceMesh mesh;
    mesh.file = text(from, "file");
    mesh.unit = positive(from, "unit", kSmallestUnit, kLargestUnit);
    mesh.size = positive(from, "size", kSmallestUnit, kLargestUnit);
    mesh.origin = Vec3(numbers<3>(from, "origin", kFarthest).data());
    mesh.mass.volume = positive(from, "volume", cubed(kSmallest), cubed(kLargest));
    mesh.mass.centroid = Vec3(numbers<3>(from, "centroid", kLargest).data());
    const auto [xx, yy, zz, xy, xz, yz] = numbers<6>(from, "inertia", cubed(kLargest) * squared(kLargest));
    mesh.mass.inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    // A body of positive density has positive second moments.
    const Mat3 second = 0.5 * mesh.mass.inertia.trace() * Mat3::Identity() - mesh.mass.inertia;
    if (Eigen::LLT<Mat3>(second).info() != Eigen::Success)
      fail(*from.get("inertia"), "inertia",
           "expected [xx, yy, zz, xy, xz, yz] of a solid, no principal moment above the sum of the others");
    return mesh;
  }

  FitError error(const toml::table& from) const {
    std::vector<std::string> known;
    for (const auto& [key, value] : kErrors) known.emplace_back(key);
    check_keys(from, known);
    FitError error;
    for (const auto& [key, value] : kErrors) {
      const std::string_view expected = "expected a finite number";
      error.*value = number(required(from, key, expected), key, -kFarthest, kFarthest, expected);
    }
    return error;
  }

  template <class Names>
  auto choice(const toml::table& from, std::string_view key, const Names& names) const {
    std::vector<std::string> words;
    for (const auto& [name, value] : names) words.push_back(fmt::format("'{}'", name));
    const std::string expected = fmt::format("expected one of {}", fmt::join(words, ", "));
    const toml::node& node = required(from, key, expected);
    for (const auto& [name, value] : names)
      if (node.value<std::string_view>() == name) return value;
    fail(node, key, expected);
  }

  FitRecord fit(const toml::table& from) const {
    check_keys(from, {"strategy", "mass", "seed"});
    constexpr std::string_view expected = "expected an integer from 0 on";
    FitRecord record{choice(from, "strategy", kStrategyNames), choice(from, "mass", kMassModelNames)};
    const toml::node& seed = required(from, "seed", expected);
    if (!seed.is_integer() || *seed.value<std::int64_t>() < 0) fail(seed, "seed", expected);
    record.seed = static_cast<std::uint64_t>(*seed.value<std::int64_t>());
    return record;
  }

  double radius(const toml::table& sphere) const {
    const std::string expected =
        fmt::format("expected a number from {} to {} (reference radii)", kSmallest, kLargest);
    return number(required(sphere, "radius", expected), "radius", kSmallest, kLargest, expected);
  }

  double mass(const toml::table& sphere) const {
    constexpr double least = 1e-30, most = 1e30;
    const std::string expected =
        fmt::format("expected a number from {:g} to {:g}, relative to the other spheres'", least, most);
    return number(required(sphere, "mass", expected), "mass", least, most, expected);
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

std::string shape_text(const Shape& shape) {
  std::string out =
      fmt::format("name = {}\ndescription = {}\n", quoted(shape.name), quoted(shape.description));
  if (shape.own.center || shape.own.inertia) {
    out += "\n[body]\n";
    if (shape.own.center) out += fmt::format("center_of_mass = {}\n", exact(*shape.own.center));
    if (shape.own.inertia)
      out += fmt::format("inertia = {}  # xx, yy, zz, xy, xz, yz; per mass, about the centre of mass\n",
                         exact(*shape.own.inertia));
  }
  if (shape.source) {
    const SourceMesh& mesh = *shape.source;
    out += fmt::format(
        "\n[mesh]  # that the spheres stand for; mass properties at unit density, in reference radii\nfile = "
        "{}\n"
        "unit = {}  # m, of that file\nsize = {}  # m, reference radius at which the body is as large as the "
        "mesh\n"
        "origin = {}  # m, of the frame used here in the mesh's\nvolume = {}\ncentroid = {}\n"
        "inertia = {}  # xx, yy, zz, xy, xz, yz\n",
        quoted(mesh.file), exact(mesh.unit), exact(mesh.size), exact(mesh.origin), exact(mesh.mass.volume),
        exact(mesh.mass.centroid), exact(mesh.mass.inertia));
    out +=
        "\n[error]  # of the spheres: distances between the surfaces, the others of the volume they cover\n";
    for (const auto& [key, value] : kErrors) out += fmt::format("{} = {}\n", key, exact(mesh.error.*value));
    if (mesh.fit)
      out += fmt::format(
          "\n[fit]  # options with which `cairn shape fit` gives these spheres again\nstrategy = "
          "\"{}\"\nmass = \"{}\"\nseed = {}\n",
          name_of(kStrategyNames, mesh.fit->strategy), name_of(kMassModelNames, mesh.fit->mass),
          mesh.fit->seed);
  }
  for (std::size_t s = 0; s < shape.radii.size(); ++s) {
    out += fmt::format("\n[[sphere]]\ncenter = {}\nradius = {}\n", exact(shape.centers[s]),
                       exact(shape.radii[s]));
    if (!shape.own.of_spheres.empty()) out += fmt::format("mass = {}\n", exact(shape.own.of_spheres[s]));
  }
  return out;
}

}  // namespace cairn
