// Tables of named quantities: one table drives what a snapshot, a checkpoint and a restart hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "core/math.h"

namespace cairn {

using Vec3f = Eigen::Vector3f;  ///< single precision, for display only

/// What the numbers of a field may be.
enum class Domain { finite, any };

enum class ElementType { f64, f32, u64, i64, u32, u16, u8, text };

/// A value as the file stores it. `text` elements have `text_length` bytes each, padded with NUL.
struct Array {
  ElementType type = ElementType::f64;
  std::vector<std::uint64_t> shape;  ///< empty: a single element
  std::size_t text_length = 0;
  std::vector<std::byte> bytes;

  std::uint64_t elements() const;
  std::size_t element_size() const;
};

/// One named quantity. Vectors of Vec3 are stored as N x 3, of Quat as N x 4 (w, x, y, z).
struct Field {
  std::string name;  ///< "position"; a '/' makes groups: "contacts/slide"
  std::string unit;  ///< "m/s"; empty: a pure number
  std::string help;  ///< one line
  std::variant<std::vector<double>*, std::vector<float>*, std::vector<Vec3>*, std::vector<Vec3f>*,
               std::vector<Quat>*, std::vector<std::uint32_t>*, std::vector<std::uint16_t>*,
               std::vector<std::uint8_t>*, std::vector<std::string>*, double*, std::uint64_t*, std::int64_t*,
               bool*, Vec3*, Quat*, std::string*, std::function<Array()>>
      data;               ///< a function makes what is written, when it is; it cannot be read
  std::string axis = {};  ///< what a row is, "sphere"; fields of one axis in one table have equally many rows
  Domain domain = Domain::finite;
};
using FieldTable = std::vector<Field>;

/// A copy of a field, independent of the vectors it came from.
struct StoredField {
  std::string name, unit, help, axis;
  Array value;
};

/// A stored field without its value.
struct DatasetInfo {
  std::string name;
  ElementType type;
  std::vector<std::uint64_t> shape;  ///< empty: a single value
  std::string axis;
};

/// Copies what the table points at. Throws std::logic_error when fields of one axis differ in their rows.
std::vector<StoredField> encode(const FieldTable& table);

/// Copies one field.
StoredField encode(const Field& field);

/// An array of that many rows of T (double, Vec3 or std::uint32_t), which `fill` sets.
template <class T>
Array make_rows(std::size_t rows, const std::function<void(T*)>& fill);

/// Sets what `field` points at; vectors are resized. Throws InputError ("position: ...") when type or shape
/// differ from the field's.
void decode(const Array& value, const Field& field);

/// The first number of the table that should be finite and is not: "velocity of body 17"; empty: none.
/// Functions are not called.
std::string not_finite(const FieldTable& table);

/// Throws InputError naming the first field whose rows differ from those of another field of its axis.
void require_equal_rows(const FieldTable& table);

/// "f64", or "text".
const char* name_of(ElementType type);

}  // namespace cairn
