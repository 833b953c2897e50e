// Words for options: bounds, defaults and the reference of all keys.
#include <algorithm>
#include <array>
#include <cmath>

#include "io/options.h"

namespace cairn {
namespace {

// The path of a table as a file writes it, "[a.b]" or "[[a.b]]".
std::string heading(const std::string& path, const KeyInfo& key) {
  return key.form == KeyInfo::Form::tables ? fmt::format("[[{}]]", path) : fmt::format("[{}]", path);
}

void add_rows(const std::vector<KeyInfo>& keys, std::string& out) {
  using Row = std::array<std::string, 6>;
  std::vector<Row> rows = {{"key", "type", "unit", "default", "bounds", "meaning"}};
  for (const KeyInfo& key : keys)
    if (key.form == KeyInfo::Form::value)
      rows.push_back(
          {key.name, key.type, key.unit, key.required ? "required" : key.fallback, key.bounds, key.help});
  if (rows.size() == 1) return;
  Row rule;
  std::array<std::size_t, 6> widths{};
  for (const Row& row : rows)
    for (std::size_t c = 0; c + 1 < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  for (std::size_t c = 0; c < rule.size(); ++c)
    rule[c] = std::string(std::max<std::size_t>(3, widths[c]), '-');
  rows.insert(rows.begin() + 1, rule);
  for (const Row& row : rows) {
    out += "|";
    for (std::size_t c = 0; c < row.size(); ++c) out += fmt::format(" {:<{}} |", row[c], widths[c]);
    out += "\n";
  }
}

void add_tables(const std::vector<KeyInfo>& keys, const std::string& path, std::string& out) {
  add_rows(keys, out);
  for (const KeyInfo& key : keys) {
    if (key.form == KeyInfo::Form::value) continue;
    const std::string inner = path.empty() ? key.name : fmt::format("{}.{}", path, key.name);
    out +=
        fmt::format("\n## {}\n\n{}{}\n\n", heading(inner, key), key.help, key.required ? " Required." : "");
    add_tables(key.nested, inner, out);
  }
}

}  // namespace

std::string Bounds::text() const {
  std::string result = "x";
  if (std::isfinite(low)) result = fmt::format("{} {} x", show(low), above_low ? "<" : "<=");
  if (std::isfinite(high)) result += " <= " + show(high);
  return result;
}

std::string Bounds::length_text() const {
  return fmt::format("{} to {} bytes", show(low), show(high));
}

// Written as people do: 0.01, 2500, 1e7, 1e-9.
std::string show(double value) {
  std::string text = fmt::format("{}", value);
  if (const std::size_t e = text.find('e'); e != text.npos)
    return fmt::format("{}e{}", text.substr(0, e), std::stoi(text.substr(e + 1)));
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  const std::size_t digits = text.find_last_not_of('0') + 1;
  constexpr std::size_t countable_zeros = 5;
  if (text.find('.') == text.npos && digits > 0 && text.size() > digits + countable_zeros)
    return fmt::format("{}e{}", text.substr(0, digits), text.size() - digits);
  return text;
}

std::string show(bool value) {
  return value ? "true" : "false";
}

std::string show(const std::string& value) {
  return fmt::format("'{}'", value);
}

std::string show(const std::vector<std::string>& value) {
  std::string text;
  for (const std::string& word : value) text += (text.empty() ? "" : ", ") + show(word);
  return "[" + text + "]";
}

std::string show(const Vec3& value) {
  return fmt::format("[{}, {}, {}]", show(value.x()), show(value.y()), show(value.z()));
}

std::string show(const Interval& value) {
  if (value.unit == Interval::Unit::automatic) return show(std::string("auto"));
  if (value.unit == Interval::Unit::steps) return fmt::format("{:.0f}", value.value);
  return show(fmt::format("{} s", value.value));
}

std::string show(const Quat& value) {
  return fmt::format("[{}, {}, {}, {}]", show(value.w()), show(value.x()), show(value.y()), show(value.z()));
}

std::string reference(const std::vector<KeyInfo>& keys) {
  std::string out;
  add_tables(keys, "", out);
  return out;
}

}  // namespace cairn
