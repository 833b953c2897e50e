// HDF5 objects that close themselves, and whole arrays in and out of them, with a checksum beside each. Only
// what is in the file itself is read: no links out of it, no external storage, no filters from elsewhere. One
// thread at a time.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/fields.h"
#include "io/hdf5_driver.h"

namespace cairn::h5 {

/// HDF5 refused; one line that starts with the object's name. Callers add the file's name.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws Error: "what: " and HDF5's innermost reason.
[[noreturn]] void fail(const std::string& what);

/// Owns an identifier.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  Handle() = default;
  /// Takes over `id`; throws Error about `what` when it is none.
  Handle(hid_t id, const std::string& what) : id_(id) {
    if (id < 0) fail(what);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) Close(id_);
  }
  operator hid_t() const { return id_; }
  hid_t release() { return std::exchange(id_, H5I_INVALID_HID); }

 private:
  hid_t id_ = H5I_INVALID_HID;
};
using File = Handle<H5Fclose>;
using Group = Handle<H5Gclose>;
using Dataset = Handle<H5Dclose>;
using Space = Handle<H5Sclose>;
using Type = Handle<H5Tclose>;
using AttributeHandle = Handle<H5Aclose>;
using PropertyList = Handle<H5Pclose>;
using Object = Handle<H5Oclose>;

enum class Mode { create, append, read, read_cut_off };

/// The HDF5 file in descriptor `fd`; `log` as in use_descriptor. Its metadata and data carry checksums. Equal
/// content written in equal sessions gives equal bytes.
File open_file(int fd, Mode mode, DiskLog& log);

/// Closes and reports failure (the destructor cannot).
void close_file(File& file);

/// Whether `path` ("a/b") leads to something below `parent`. Throws Error when it leads out of the file.
bool exists(hid_t parent, const std::string& path);

/// Removes `path` and all below it; nothing there is fine.
void remove(hid_t parent, const std::string& path);

/// Makes a group, and the groups above it.
Group create_group(hid_t parent, const std::string& path);
Group open_group(hid_t parent, const std::string& path);

/// Names below a group in the order in which they were made.
std::vector<std::string> names(hid_t group);

/// The datasets directly in a group, in the order of names().
std::vector<DatasetInfo> datasets(hid_t group);

/// The attribute with the checksum of a dataset's bytes.
inline constexpr const char* kChecksum = "xxh3_128";

/// Writes a field as a dataset with the attributes unit, help and axis (the empty ones left out) and its
/// checksum, which is returned.
std::string write_field(hid_t parent, const StoredField& field);

/// Reads a whole dataset and compares its checksum; `limit` (bytes) bounds what a damaged header can make us
/// allocate.
Array read_array(hid_t parent, const std::string& path, std::uint64_t limit);

/// Writes or replaces an attribute.
void write_attribute(hid_t object, const std::string& name, const Array& value);
void write_attribute(hid_t object, const std::string& name, const std::string& text);
Array read_attribute(hid_t object, const std::string& name, std::uint64_t limit);
/// How errors name an attribute: "/snapshots/000001, attribute time".
std::string attribute_label(hid_t object, const std::string& name);
bool has_attribute(hid_t object, const std::string& name);
std::vector<std::string> attribute_names(hid_t object);

/// Makes an empty one-dimensional dataset of doubles that can grow.
Dataset create_growing(hid_t parent, const std::string& name);

/// Adds values at the end of a dataset made by create_growing; `checksum` is that of all its values then.
void append(hid_t parent, const std::string& name, const std::vector<double>& values,
            const std::string& checksum);

/// The last `count` values of such a dataset, or all.
std::vector<double> read_tail(hid_t parent, const std::string& name, std::uint64_t count);

}  // namespace cairn::h5
