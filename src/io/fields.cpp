#include "io/fields.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <type_traits>

#include "core/error.h"

namespace cairn {
namespace {

template <ElementType Type, std::size_t Width>
struct As {
  static constexpr ElementType type = Type;
  static constexpr std::size_t width = Width;
};

/// How one value of C++ type T is stored: `width` elements of one type.
template <class T>
struct Stored;
template <>
struct Stored<double> : As<ElementType::f64, 1> {};
template <>
struct Stored<float> : As<ElementType::f32, 1> {};
template <>
struct Stored<Vec3> : As<ElementType::f64, 3> {};
template <>
struct Stored<Vec3f> : As<ElementType::f32, 3> {};
template <>
struct Stored<Quat> : As<ElementType::f64, 4> {};
template <>
struct Stored<std::uint64_t> : As<ElementType::u64, 1> {};
template <>
struct Stored<std::int64_t> : As<ElementType::i64, 1> {};
template <>
struct Stored<std::uint32_t> : As<ElementType::u32, 1> {};
template <>
struct Stored<std::uint16_t> : As<ElementType::u16, 1> {};
template <>
struct Stored<std::uint8_t> : As<ElementType::u8, 1> {};
template <>
struct Stored<bool> : As<ElementType::u8, 1> {};
template <>
struct Stored<std::string> : As<ElementType::text, 1> {};

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

/// What a field's data points at; a function is what it is.
template <class T>
using Pointed = std::remove_cvref_t<std::remove_pointer_t<std::remove_cvref_t<T>>>;

std::size_t size_of(ElementType type) {
  switch (type) {
    case ElementType::f64:
    case ElementType::u64:
    case ElementType::i64:
      return 8;
    case ElementType::f32:
    case ElementType::u32:
      return 4;
    case ElementType::u16:
      return 2;
    case ElementType::u8:
    case ElementType::text:
      return 1;
  }
  return 1;
}

void store(const std::string* values, std::size_t count, Array& array) {
  array.text_length = 1;  // HDF5 has no strings of length 0
  for (std::size_t i = 0; i < count; ++i) array.text_length = std::max(array.text_length, values[i].size());
  array.bytes.assign(count * array.text_length, std::byte{0});
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(reinterpret_cast<const std::byte*>(values[i].data()), values[i].size(),
                array.bytes.data() + i * array.text_length);
}

void store(const Quat* values, std::size_t count, Array& array) {
  array.bytes.resize(count * 4 * sizeof(double));
  for (std::size_t i = 0; i < count; ++i) {
    const double q[4] = {values[i].w(), values[i].x(), values[i].y(), values[i].z()};
    std::memcpy(array.bytes.data() + i * sizeof q, q, sizeof q);
  }
}

template <class T>
void store(const T* values, std::size_t count, Array& array) {
  static_assert(sizeof(T) == 1 || sizeof(T) % Stored<T>::width == 0);
  array.bytes.resize(count * sizeof(T));
  if (count > 0) std::memcpy(array.bytes.data(), values, array.bytes.size());
}

void load(const Array& array, std::size_t count, std::string* values) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto* text = reinterpret_cast<const char*>(array.bytes.data()) + i * array.text_length;
    std::size_t length = array.text_length;
    while (length > 0 && text[length - 1] == '\0') --length;
    values[i].assign(text, length);
  }
}

void load(const Array& array, std::size_t count, Quat* values) {
  for (std::size_t i = 0; i < count; ++i) {
    double q[4];
    std::memcpy(q, array.bytes.data() + i * sizeof q, sizeof q);
    values[i].w() = q[0];
    values[i].x() = q[1];
    values[i].y() = q[2];
    values[i].z() = q[3];
  }
}

void load(const Array& array, std::size_t, bool* values) {
  *values = array.bytes[0] != std::byte{0};
}

template <class T>
void load(const Array& array, std::size_t count, T* values) {
  if (count > 0) std::memcpy(static_cast<void*>(values), array.bytes.data(), count * sizeof(T));
}

std::string describe(ElementType type, const std::vector<std::uint64_t>& shape) {
  if (shape.empty()) return fmt::format("one {}", name_of(type));
  std::string text;
  for (const std::uint64_t n : shape) text += fmt::format("{}{}", text.empty() ? "" : " x ", n);
  return fmt::format("{} {}", text, name_of(type));
}

/// Throws unless the array holds values of T: `vector` of any length, or one.
template <class T>
void require(const Array& array, bool vector, const std::string& name) {
  constexpr std::size_t width = Stored<T>::width;
  std::vector<std::uint64_t> expected;
  if (vector) expected.push_back(array.shape.empty() ? 0 : array.shape[0]);
  if (width > 1) expected.push_back(width);
  if (array.type == Stored<T>::type && array.shape == expected) return;
  const std::string wanted = fmt::format("{}{}{}",
                                         vector       ? "N "
                                         : width == 1 ? "one "
                                                      : "",
                                         width == 1 ? "" : fmt::format("{}{} ", vector ? "x " : "", width),
                                         name_of(Stored<T>::type));
  throw InputError("{}: expected {}, found {}", name, wanted, describe(array.type, array.shape));
}

/// Name of the first field whose rows differ from an earlier one of its axis; empty: none.
std::string unequal_rows(const FieldTable& table) {
  std::map<std::string, std::size_t> rows_of_axis;
  for (const Field& field : table) {
    if (field.axis.empty()) continue;
    const bool agrees = std::visit(
        [&](const auto& value) {
          if constexpr (IsVector<Pointed<decltype(value)>>::value)
            return rows_of_axis.try_emplace(field.axis, value->size()).first->second == value->size();
          return true;
        },
        field.data);
    if (!agrees) return field.name;
  }
  return {};
}

bool is_finite(double x) {
  return std::isfinite(x);
}
bool is_finite(float x) {
  return std::isfinite(x);
}
bool is_finite(const Quat& q) {
  return q.coeffs().allFinite();
}
template <class Scalar>
bool is_finite(const Eigen::Vector3<Scalar>& v) {
  return v.allFinite();
}

template <class T>
concept Real = requires(const T& value) {
  is_finite(value);
}
&&!std::is_integral_v<T>;

}  // namespace

std::string not_finite(const FieldTable& table) {
  for (const Field& field : table) {
    if (field.domain == Domain::any) continue;
    std::string found;
    std::visit(
        [&](const auto& value) {
          using Value = Pointed<decltype(value)>;
          if constexpr (IsVector<Value>::value) {
            if constexpr (Real<typename Value::value_type>)
              for (std::size_t k = 0; k < value->size() && found.empty(); ++k)
                if (!is_finite((*value)[k]))
                  found =
                      fmt::format("{} of {} {}", field.name,
                                  field.axis.empty() || field.axis.ends_with('/') ? "row" : field.axis, k);
          } else if constexpr (Real<Value>) {
            if (!is_finite(*value)) found = field.name;
          }
        },
        field.data);
    if (!found.empty()) return found;
  }
  return {};
}

std::uint64_t Array::elements() const {
  std::uint64_t count = 1;
  for (const std::uint64_t n : shape) count *= n;
  return count;
}

std::size_t Array::element_size() const {
  return type == ElementType::text ? text_length : size_of(type);
}

StoredField encode(const Field& field) {
  StoredField stored{field.name, field.unit, field.help, field.axis, {}};
  std::visit(
      [&](const auto& value) {
        using Value = Pointed<decltype(value)>;
        Array& array = stored.value;
        const auto fill = [&]<class T>(const T* values, std::size_t count) {
          array.type = Stored<T>::type;
          if (Stored<T>::width > 1) array.shape.push_back(Stored<T>::width);
          store(values, count, array);
        };
        if constexpr (std::is_same_v<Value, std::function<Array()>>) {
          array = value();
        } else if constexpr (IsVector<Value>::value) {
          array.shape.push_back(value->size());
          fill(value->data(), value->size());
        } else {
          fill(value, 1);
        }
      },
      field.data);
  return stored;
}

template <class T>
Array make_rows(std::size_t rows, const std::function<void(T*)>& fill) {
  Array array{.type = Stored<T>::type, .shape = {rows}, .bytes = std::vector<std::byte>(rows * sizeof(T))};
  if (Stored<T>::width > 1) array.shape.push_back(Stored<T>::width);
  fill(reinterpret_cast<T*>(array.bytes.data()));
  return array;
}
template Array make_rows(std::size_t, const std::function<void(double*)>&);
template Array make_rows(std::size_t, const std::function<void(Vec3*)>&);
template Array make_rows(std::size_t, const std::function<void(std::uint32_t*)>&);

std::vector<StoredField> encode(const FieldTable& table) {
  if (const std::string name = unequal_rows(table); !name.empty())
    throw std::logic_error(fmt::format("field {} has not as many rows as its axis", name));
  std::vector<StoredField> stored;
  stored.reserve(table.size());
  for (const Field& field : table) stored.push_back(encode(field));
  return stored;
}

void decode(const Array& array, const Field& field) {
  std::visit(
      [&](const auto& value) {
        using Value = Pointed<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::function<Array()>>) {
          throw std::logic_error(fmt::format("field {} is only written", field.name));
        } else if constexpr (IsVector<Value>::value) {
          require<typename Value::value_type>(array, true, field.name);
          value->resize(array.shape[0]);
          load(array, value->size(), value->data());
        } else {
          require<Value>(array, false, field.name);
          load(array, 1, value);
        }
      },
      field.data);
}

void require_equal_rows(const FieldTable& table) {
  if (const std::string name = unequal_rows(table); !name.empty())
    throw InputError("{}: has not as many rows as the other fields of its kind", name);
}

const char* name_of(ElementType type) {
  static constexpr const char* names[] = {"f64", "f32", "u64", "i64", "u32", "u16", "u8", "text"};
  return names[static_cast<std::size_t>(type)];
}

}  // namespace cairn
