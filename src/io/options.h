// Tables of keys. One line of a table declares a key of the input once: name, member that it fills, unit,
// bounds and help. Reading, every error, the defaults and the reference text all follow from these lines.
#pragma once

#include <fmt/format.h>

#include <concepts>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/math.h"
#include "io/interval.h"
#include "io/source.h"

namespace cairn {

/// The numbers x that a key accepts, or the lengths of a text; NaN and infinities never.
struct Bounds {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< low itself is refused

  bool hold(double x) const { return (above_low ? x > low : x >= low) && x <= high; }
  std::string text() const;         ///< "0 < x <= 1"
  std::string length_text() const;  ///< "1 to 64 bytes"
};
constexpr Bounds within(double low, double high) {
  return {low, high, false};
}
constexpr Bounds above(double low, double high) {
  return {low, high, true};
}
constexpr Bounds magnitude(double high) {
  return {-high, high, false};
}

/// What the reference and the errors say of a key.
struct KeyInfo {
  enum class Form { value, table, tables };

  std::string name{};
  std::string type{};
  std::string unit{};
  std::string bounds{};
  std::string fallback{};  ///< the default, from a default-constructed struct
  std::string help{};
  bool required = false;
  Form form = Form::value;
  std::vector<KeyInfo> nested{};  ///< keys of the table or of each of the tables
};

/// A value of the file on its way into a member.
struct Value;

/// One key of a table that fills a T.
template <class T>
struct Key {
  KeyInfo info;
  std::function<void(const Value&, T&)> read;

  /// The same key, whose absence is an error.
  Key required() && {
    info.required = true;
    return std::move(*this);
  }
};

/// All keys of a table that fills a T.
template <class T>
struct Keys {
  std::vector<KeyInfo> infos;
  std::vector<std::function<void(const Value&, T&)>> readers;

  Keys(std::initializer_list<Key<T>> keys) {
    for (const Key<T>& key : keys) {
      infos.push_back(key.info);
      readers.push_back(key.read);
    }
  }
};

// How values are read; every function throws InputError at the value's place when it is not as expected.
double read_number(const Value& value, const std::string& unit, const Bounds& bounds);
std::int64_t read_integer(const Value& value, const Bounds& bounds);
bool read_flag(const Value& value);
std::string read_text(const Value& value, const Bounds& length);
std::size_t read_choice(const Value& value, const std::vector<std::string>& names);
/// "auto", a number of steps, or a time such as "5 s".
Interval read_interval(const Value& value, const Bounds& bounds);
std::vector<double> read_numbers(const Value& value, std::size_t count, const std::string& unit,
                                 const Bounds& bounds);
/// Rows of numbers, all of the same one of the lengths `widths`.
std::vector<std::vector<double>> read_rows(const Value& array, const std::vector<std::size_t>& widths,
                                           const std::string& unit, const Bounds& bounds);
/// Calls visit(element) for each element of an array, in order.
void each_element(const Value& array, const std::string& expected,
                  const std::function<void(const Value&)>& visit);
/// The same for an array of tables, [[name]].
void each_table(const Value& array, const std::function<void(const Value&)>& visit);
/// Calls visit(index into keys, value) for each key of a table in the order of the file.
/// @throws InputError also for a key that is unknown or required and missing.
void each_key(const Value& table, const std::vector<KeyInfo>& keys,
              const std::function<void(std::size_t, const Value&)>& visit);
/// The same for the outermost table of a TOML text; returns where each key stands.
/// `sources` knows the files.
SourceMap each_key_of_text(const std::string& text, SourceMap sources, const std::vector<KeyInfo>& keys,
                           const std::function<void(std::size_t, const Value&)>& visit);

/// Plain-text tables (Markdown) of all keys: name, type, unit, default, bounds, help.
std::string reference(const std::vector<KeyInfo>& keys);

// Values as a TOML file states them, for the defaults.
std::string show(double value);
std::string show(bool value);
std::string show(const std::string& value);
std::string show(const Vec3& value);
std::string show(const Quat& value);
std::string show(const Interval& value);
template <std::integral I>
std::string show(I value) {
  return fmt::format("{}", value);
}
std::string show(const std::vector<std::string>& value);
template <class V>
std::string show(const std::optional<V>& value) {
  return value ? show(*value) : "-";
}

/// A key made of its description and of a function that reads its value.
template <class T, class M, class Read>
Key<T> make_key(KeyInfo info, M T::*member, Read read) {
  return {std::move(info), [member, read](const Value& value, T& object) { object.*member = read(value); }};
}

template <class T, class M>
requires std::same_as<M, double> || std::same_as<M, std::optional<double>> Key<T> number(
    std::string name, M T::*member, std::string unit, Bounds bounds, std::string help) {
  KeyInfo info{.name = name, .type = "number", .unit = unit, .bounds = bounds.text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, [=](const Value& value) { return read_number(value, unit, bounds); });
}

template <class T, std::integral M>
Key<T> integer(std::string name, M T::*member, std::string unit, Bounds bounds, std::string help) {
  KeyInfo info{.name = name, .type = "integer", .unit = unit, .bounds = bounds.text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member,
                  [=](const Value& value) { return static_cast<M>(read_integer(value, bounds)); });
}

template <class T>
Key<T> flag(std::string name, bool T::*member, std::string help) {
  KeyInfo info{.name = name, .type = "boolean", .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, read_flag);
}

/// The same, absent unless given.
template <class T>
Key<T> flag(std::string name, std::optional<bool> T::*member, std::string help) {
  KeyInfo info{.name = name, .type = "boolean", .fallback = "-", .help = help};
  return make_key(info, member, read_flag);
}

/// `length` bounds the number of bytes of a text on one line.
template <class T>
Key<T> text(std::string name, std::string T::*member, Bounds length, std::string help) {
  KeyInfo info{.name = name, .type = "string", .bounds = length.length_text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, [=](const Value& value) { return read_text(value, length); });
}

/// Some texts.
template <class T>
Key<T> texts(std::string name, std::vector<std::string> T::*member, Bounds length, std::string help) {
  KeyInfo info{.name = name, .type = "[string, ...]", .bounds = length.length_text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, [=](const Value& array) {
    std::vector<std::string> found;
    each_element(array, "an array of strings",
                 [&](const Value& value) { found.push_back(read_text(value, length)); });
    return found;
  });
}

/// The same, absent unless given.
template <class T>
Key<T> texts(std::string name, std::optional<std::vector<std::string>> T::*member, Bounds length,
             std::string help) {
  KeyInfo info{.name = name, .type = "[string, ...]", .bounds = length.length_text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, [=](const Value& array) {
    std::vector<std::string> found;
    each_element(array, "an array of strings",
                 [&](const Value& value) { found.push_back(read_text(value, length)); });
    return found;
  });
}

/// Three numbers, each within `bounds`.
template <class T, class M>
requires std::same_as<M, Vec3> || std::same_as<M, std::optional<Vec3>> Key<T> vector(
    std::string name, M T::*member, std::string unit, Bounds bounds, std::string help) {
  KeyInfo info{.name = name, .type = "3 numbers", .unit = unit, .bounds = bounds.text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, [=](const Value& value) -> Vec3 {
    return Eigen::Map<const Vec3>(read_numbers(value, 3, unit, bounds).data());
  });
}

/// Four numbers w, x, y, z.
template <class T>
Key<T> quaternion(std::string name, Quat T::*member, Bounds bounds, std::string help) {
  KeyInfo info{.name = name, .type = "4 numbers", .bounds = bounds.text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, [=](const Value& value) {
    const std::vector<double> q = read_numbers(value, 4, "", bounds);
    return Quat(q[0], q[1], q[2], q[3]);
  });
}

/// One of a few words.
template <class T, class E>
Key<T> choice(std::string name, E T::*member, std::vector<std::pair<std::string, E>> words,
              std::string help) {
  std::vector<std::string> names;
  KeyInfo info{.name = name, .type = "string", .help = help};
  for (const auto& [word, meaning] : words) {
    names.push_back(word);
    if (meaning == T{}.*member) info.fallback = show(word);
  }
  info.bounds = alternatives(names);
  return make_key(info, member, [=](const Value& value) { return words[read_choice(value, names)].second; });
}

/// The same, absent unless given.
template <class T, class E>
Key<T> choice(std::string name, std::optional<E> T::*member, std::vector<std::pair<std::string, E>> words,
              std::string help) {
  std::vector<std::string> names;
  for (const auto& word : words) names.push_back(word.first);
  KeyInfo info{.name = name, .type = "string", .bounds = alternatives(names), .fallback = "-", .help = help};
  return make_key(info, member, [=](const Value& value) { return words[read_choice(value, names)].second; });
}

/// How often: by itself, in steps, or in seconds; both numbers within `bounds`.
template <class T>
Key<T> interval(std::string name, Interval T::*member, Bounds bounds, std::string help) {
  KeyInfo info{.name = name, .type = "\"auto\", steps or \"... s\"", .bounds = bounds.text(), .help = help};
  info.fallback = show(T{}.*member);
  return make_key(info, member, [=](const Value& value) { return read_interval(value, bounds); });
}

/// An array of pairs of numbers, [[a, b], ...].
template <class T, class R>
Key<T> pairs(std::string name, std::vector<R> T::*member, double R::*first, double R::*second,
             std::string unit, Bounds bounds, std::string help) {
  KeyInfo info{.name = name, .type = "[[a, b], ...]", .unit = unit, .bounds = bounds.text(), .help = help};
  info.fallback = "[]";
  return make_key(info, member, [=](const Value& array) {
    std::vector<R> rows;
    each_element(array, "an array of pairs of numbers in " + unit, [&](const Value& value) {
      const std::vector<double> pair = read_numbers(value, 2, unit, bounds);
      R& row = rows.emplace_back();
      row.*first = pair[0];
      row.*second = pair[1];
    });
    return rows;
  });
}

/// An array of rows of numbers, [[a, b, ...], ...]; every row has one of the lengths `widths`, the same.
template <class T>
Key<T> rows(std::string name, std::vector<std::vector<double>> T::*member, std::vector<std::size_t> widths,
            std::string unit, Bounds bounds, std::string help) {
  KeyInfo info{.name = name, .type = "[[a, ...], ...]", .unit = unit, .bounds = bounds.text(), .help = help};
  info.fallback = "[]";
  return make_key(info, member, [=](const Value& array) { return read_rows(array, widths, unit, bounds); });
}

/// Fills an object from a table of the file.
template <class U>
U read_table(const Value& table, const Keys<U>& keys) {
  U object{};
  each_key(table, keys.infos, [&](std::size_t key, const Value& value) { keys.readers[key](value, object); });
  return object;
}

/// A table [name] with keys of its own.
template <class T, class M, class U>
requires std::same_as<M, U> || std::same_as<M, std::optional<U>> Key<T> table(std::string name, M T::*member,
                                                                              const Keys<U>& keys,
                                                                              std::string help) {
  KeyInfo info{.name = name, .help = help, .form = KeyInfo::Form::table, .nested = keys.infos};
  return make_key(info, member, [keys](const Value& value) { return read_table(value, keys); });
}

/// Any number of tables [[name]] with the same keys.
template <class T, class U>
Key<T> tables(std::string name, std::vector<U> T::*member, const Keys<U>& keys, std::string help) {
  KeyInfo info{.name = name, .help = help, .form = KeyInfo::Form::tables, .nested = keys.infos};
  return make_key(info, member, [keys](const Value& array) {
    std::vector<U> objects;
    each_table(array, [&](const Value& element) { objects.push_back(read_table(element, keys)); });
    return objects;
  });
}

/// Fills `object` from a TOML text; keys not given keep the values they have. Returns where each key stands;
/// `sources` knows the files.
/// @throws InputError with one line: file, line, column, key, what was expected.
template <class T>
SourceMap read_options(const std::string& text, SourceMap sources, const Keys<T>& keys, T& object) {
  return each_key_of_text(text, std::move(sources), keys.infos,
                          [&](std::size_t key, const Value& value) { keys.readers[key](value, object); });
}

}  // namespace cairn
