#include "io/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/suggest.h"
#include "io/toml_file.h"

namespace cairn {

struct Value {
  const toml::node& node;
  std::string key;  // its path; empty for the outermost table
  SourceMap& sources;

  Value(const toml::node& node_, std::string key_, SourceMap& sources_)
      : node(node_), key(std::move(key_)), sources(sources_) {
    if (!key.empty()) sources.add(key, position_of(node));
  }

  [[noreturn]] void fail(const std::string& what) const { throw sources.error(position_of(node), key, what); }
};

namespace {

std::string kind(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a floating-point number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

std::string in_unit(const std::string& unit) {
  return unit.empty() ? "" : " in " + unit;
}

[[noreturn]] void fail_kind(const Value& value, const std::string& expected) {
  value.fail(fmt::format("expected {}, found {}", expected, kind(value.node)));
}

std::string join(const std::string& table, std::string_view key) {
  return table.empty() ? std::string(key) : fmt::format("{}.{}", table, key);
}

// "cloud[1].shape" -> "cloud.shape", as the file writes the heading.
std::string without_indices(const std::string& key) {
  std::string result;
  bool index = false;
  for (const char c : key) {
    index = index || c == '[';
    if (!index) result += c;
    if (c == ']') index = false;
  }
  return result;
}

std::string unknown_key(std::string_view name, const std::vector<KeyInfo>& keys) {
  std::vector<std::string> names;
  for (const KeyInfo& key : keys) names.push_back(key.name);
  const std::string near = nearest_name(name, names);
  return near.empty() ? "unknown key; expected " + alternatives(names)
                      : fmt::format("unknown key; did you mean '{}'?", near);
}

std::string missing_key(const Value& table, const KeyInfo& key) {
  const std::string owner = table.key.empty() ? "the file"
                                              : fmt::format("table '{}' that starts on line {}", table.key,
                                                            position_of(table.node).line);
  const std::string wanted = key.form == KeyInfo::Form::tables  ? "at least one [[...]] table"
                             : key.form == KeyInfo::Form::table ? "a table"
                             : key.unit.empty()                 ? key.type
                                                                : key.type + " in " + key.unit;
  return fmt::format("missing key; {} requires it ({})", owner, wanted);
}

}  // namespace

double read_number(const Value& value, const std::string& unit, const Bounds& bounds) {
  if (!value.node.is_number()) fail_kind(value, "a number" + in_unit(unit));
  const double x = value.node.is_integer() ? static_cast<double>(value.node.as_integer()->get())
                                           : value.node.as_floating_point()->get();
  if (!std::isfinite(x)) value.fail(fmt::format("expected a finite number{}, found {}", in_unit(unit), x));
  if (!bounds.hold(x))
    value.fail(fmt::format("expected {}{}, found {}", bounds.text(), in_unit(unit), show(x)));
  return x;
}

std::int64_t read_integer(const Value& value, const Bounds& bounds) {
  if (!value.node.is_integer()) fail_kind(value, "an integer");
  const std::int64_t x = value.node.as_integer()->get();
  if (!bounds.hold(static_cast<double>(x)))
    value.fail(fmt::format("expected {}, found {}", bounds.text(), x));
  return x;
}

bool read_flag(const Value& value) {
  if (!value.node.is_boolean()) fail_kind(value, "true or false");
  return value.node.as_boolean()->get();
}

std::string read_text(const Value& value, const Bounds& length) {
  if (!value.node.is_string()) fail_kind(value, "a string");
  const std::string& text = value.node.as_string()->get();
  const auto bytes = static_cast<double>(text.size());
  if (!length.hold(bytes))
    value.fail(fmt::format("expected a string of {}, found {}", length.length_text(), text.size()));
  if (printable(text, text.size()) != text)
    value.fail(fmt::format("expected text without control characters, found '{}'", printable(text)));
  return text;
}

std::size_t read_choice(const Value& value, const std::vector<std::string>& names) {
  if (!value.node.is_string()) fail_kind(value, alternatives(names));
  const std::string& word = value.node.as_string()->get();
  const auto found = std::find(names.begin(), names.end(), word);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const std::string near = nearest_name(word, names);
  value.fail(fmt::format("expected {}, found '{}'{}", alternatives(names), printable(word),
                         near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
}

Interval read_interval(const Value& value, const Bounds& bounds) {
  constexpr const char* kExpected = "'auto', an integer number of steps, or seconds such as '5 s'";
  if (value.node.is_integer())
    return {Interval::Unit::steps, static_cast<double>(read_integer(value, bounds))};
  if (!value.node.is_string()) fail_kind(value, kExpected);
  const std::string& text = value.node.as_string()->get();
  if (text == "auto") return {};
  double seconds = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, seconds);
  if (error != std::errc() || std::string_view(rest, end) != " s")
    value.fail(fmt::format("expected {}, found '{}'", kExpected, printable(text)));
  if (!bounds.hold(seconds))
    value.fail(fmt::format("expected {} in s, found {}", bounds.text(), show(seconds)));
  return {Interval::Unit::seconds, seconds};
}

std::vector<double> read_numbers(const Value& value, std::size_t count, const std::string& unit,
                                 const Bounds& bounds) {
  const std::string expected = fmt::format("an array of {} numbers{}", count, in_unit(unit));
  const toml::array* array = value.node.as_array();
  if (!array) fail_kind(value, expected);
  if (array->size() != count)
    value.fail(fmt::format("expected {}, found an array of {}", expected, array->size()));
  std::vector<double> numbers;
  each_element(value, expected,
               [&](const Value& element) { numbers.push_back(read_number(element, unit, bounds)); });
  return numbers;
}

std::vector<std::vector<double>> read_rows(const Value& array, const std::vector<std::size_t>& widths,
                                           const std::string& unit, const Bounds& bounds) {
  std::vector<std::vector<double>> result;
  each_element(array, "an array of rows of numbers" + in_unit(unit), [&](const Value& row) {
    const toml::array* numbers = row.node.as_array();
    const std::size_t width = numbers ? numbers->size() : 0;
    const bool known = std::find(widths.begin(), widths.end(), width) != widths.end();
    if (!known || (!result.empty() && width != result.front().size()))
      row.fail(fmt::format("expected a row of {} numbers{}, found {}",
                           result.empty() ? fmt::format("{}", fmt::join(widths, " or "))
                                          : fmt::format("{}", result.front().size()),
                           in_unit(unit), numbers ? fmt::format("{}", width) : kind(row.node)));
    result.push_back(read_numbers(row, width, unit, bounds));
  });
  return result;
}

void each_element(const Value& array, const std::string& expected,
                  const std::function<void(const Value&)>& visit) {
  const toml::array* elements = array.node.as_array();
  if (!elements) fail_kind(array, expected);
  std::size_t index = 0;
  for (const toml::node& element : *elements)
    visit(Value(element, fmt::format("{}[{}]", array.key, index++), array.sources));
}

void each_table(const Value& array, const std::function<void(const Value&)>& visit) {
  each_element(array, fmt::format("tables [[{}]]", without_indices(array.key)), visit);
}

void each_key(const Value& table, const std::vector<KeyInfo>& keys,
              const std::function<void(std::size_t, const Value&)>& visit) {
  const toml::table* given = table.node.as_table();
  if (!given) fail_kind(table, fmt::format("a table [{}]", without_indices(table.key)));

  // The parser sorts keys by name; errors are reported in the order of the file.
  struct Entry {
    SourcePosition position;
    std::string_view name;
    const toml::node* node;
  };
  std::vector<Entry> entries;
  for (const auto& [key, node] : *given)
    entries.push_back({{key.source().begin.line, key.source().begin.column}, key.str(), &node});
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::pair(a.position.line, a.position.column) < std::pair(b.position.line, b.position.column);
  });

  for (const Entry& entry : entries) {
    const auto known =
        std::find_if(keys.begin(), keys.end(), [&](const KeyInfo& k) { return k.name == entry.name; });
    if (known == keys.end())
      throw table.sources.error(entry.position, join(table.key, entry.name), unknown_key(entry.name, keys));
    visit(static_cast<std::size_t>(known - keys.begin()),
          Value(*entry.node, join(table.key, entry.name), table.sources));
  }
  for (const KeyInfo& key : keys) {
    if (!key.required) continue;
    const toml::node* node = given->get(key.name);
    const bool empty = node && key.form == KeyInfo::Form::tables && node->as_array()->empty();
    if (!node || empty)
      throw table.sources.error(position_of(table.node), join(table.key, key.name), missing_key(table, key));
  }
}

SourceMap each_key_of_text(const std::string& text, SourceMap sources, const std::vector<KeyInfo>& keys,
                           const std::function<void(std::size_t, const Value&)>& visit) {
  const toml::table root = parse_toml(text, sources.file);
  each_key(Value(root, "", sources), keys, visit);
  return sources;
}

}  // namespace cairn
