#include "io/hdf5.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "io/checksum.h"

namespace cairn::h5 {
namespace {

/// Errors are thrown; HDF5 shall not print them as well. Nor shall a file make it load foreign code, nor
/// shall it, as the program ends, try once more to close a file whose closing has failed: its descriptor is
/// gone.
void prepare_library() {
  static const herr_t done = [] {
    H5dont_atexit();
    H5PLset_loading_state(0);
    return H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }();
  static_cast<void>(done);
}

// What HDF5 calls must not throw through it: it would leave its own state in disorder.

herr_t keep_innermost(unsigned, const H5E_error2_t* entry, void* text) noexcept {
  try {
    if (entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  } catch (const std::bad_alloc&) {  // the one before will do
  }
  return 0;
}

/// Names that HDF5 tells one by one.
struct Names {
  std::vector<std::string> list;
  bool complete = true;

  template <class Info>
  static herr_t add(hid_t, const char* name, const Info*, void* names) noexcept {
    auto* self = static_cast<Names*>(names);
    try {
      self->list.emplace_back(name);
    } catch (const std::bad_alloc&) {
      self->complete = false;
    }
    return self->complete ? 0 : -1;
  }
};

void check(herr_t status, const std::string& what) {
  if (status < 0) fail(what);
}

/// HDF5's type of one element; the same in the file and in memory on little-endian machines.
Type type_of(ElementType type, std::size_t text_length) {
  const hid_t plain[] = {H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_U64LE, H5T_STD_I64LE,
                         H5T_STD_U32LE,  H5T_STD_U16LE,  H5T_STD_U8LE};
  if (type != ElementType::text) return Type(H5Tcopy(plain[static_cast<std::size_t>(type)]), "type");
  Type text(H5Tcopy(H5T_C_S1), "type");
  H5Tset_size(text, text_length);
  H5Tset_strpad(text, H5T_STR_NULLPAD);
  H5Tset_cset(text, H5T_CSET_UTF8);
  return text;
}

Space space_of(const std::vector<std::uint64_t>& shape) {
  if (shape.empty()) return Space(H5Screate(H5S_SCALAR), "space");
  const std::vector<hsize_t> extent(shape.begin(), shape.end());
  return Space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), "space");
}

std::vector<std::uint64_t> shape_of(hid_t space, const std::string& what) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) fail(what);
  std::vector<hsize_t> extent(static_cast<std::size_t>(rank));
  if (rank > 0 && H5Sget_simple_extent_dims(space, extent.data(), nullptr) < 0) fail(what);
  return {extent.begin(), extent.end()};
}

/// An array of that type and space, without its bytes.
Array describe(const Type& type, const Space& space, const std::string& what) {
  Array array;
  array.shape = shape_of(space, what);
  for (const ElementType known : {ElementType::f64, ElementType::f32, ElementType::u64, ElementType::i64,
                                  ElementType::u32, ElementType::u16, ElementType::u8}) {
    array.type = known;
    if (H5Tequal(type, type_of(known, 0)) > 0) return array;
  }
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0)
    throw Error(what + ": its type is none that this program writes");
  array.type = ElementType::text;
  array.text_length = H5Tget_size(type);
  return array;
}

/// Room for the bytes, unless there are more than a sound file can hold.
void allocate(Array& array, std::uint64_t limit, const std::string& what) {
  std::uint64_t size = std::max<std::size_t>(array.element_size(), 1);
  const bool empty = std::ranges::count(array.shape, 0u) > 0;
  for (const std::uint64_t n : array.shape)
    if (!empty && (size > limit || __builtin_mul_overflow(size, n, &size))) size = limit + 1;
  if (size > limit) throw Error(what + ": damaged, it claims to be larger than the file");
  array.bytes.resize(empty ? 0 : size);
}

/// What is small goes into the dataset's header, the rest into chunks; both carry checksums. One chunk where
/// it is not too large, else equal ones, so that little is left over.
PropertyList checked_layout(const Array& array) {
  constexpr std::uint64_t largest_in_header = 4096, largest_chunk = 8u << 20;  // bytes
  PropertyList list(H5Pcreate(H5P_DATASET_CREATE), "layout");
  H5Pset_obj_track_times(list, false);  // equal content, equal bytes
  if (array.elements() == 0) return list;
  if (array.shape.empty() || array.bytes.size() <= largest_in_header) {
    if (array.bytes.size() <= largest_in_header) H5Pset_layout(list, H5D_COMPACT);
    return list;
  }
  const std::uint64_t rows = array.shape[0];
  const std::uint64_t chunks = array.elements() * array.element_size() / largest_chunk + 1;
  std::vector<hsize_t> chunk(array.shape.begin(), array.shape.end());
  chunk[0] = (rows + chunks - 1) / chunks;
  H5Pset_chunk(list, static_cast<int>(chunk.size()), chunk.data());
  H5Pset_fletcher32(list);
  return list;
}

/// Links stay in the group's header up to a good many, which is smaller than the trees HDF5 builds otherwise.
PropertyList ordered_group() {
  PropertyList list(H5Pcreate(H5P_GROUP_CREATE), "group");
  H5Pset_link_phase_change(list, 64, 48);
  H5Pset_link_creation_order(list, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_obj_track_times(list, false);
  return list;
}

/// Makes the groups on the way to `path` that are missing.
void create_groups_above(hid_t parent, const std::string& path) {
  for (std::size_t end = path.find('/'); end != std::string::npos; end = path.find('/', end + 1)) {
    const std::string group = path.substr(0, end);
    if (!exists(parent, group))
      Group(H5Gcreate2(parent, group.c_str(), H5P_DEFAULT, ordered_group(), H5P_DEFAULT), group);
  }
}

/// Whether a link called `name` leads to an object of this file.
void require_own(const H5L_info_t& link, const std::string& name) {
  if (link.type != H5L_TYPE_HARD)
    throw Error(name + ": a link to elsewhere; only what is in the file itself is read");
}

/// Throws unless the dataset's bytes are in the file, behind no other filters than HDF5's own.
void require_own_storage(hid_t dataset, const std::string& what) {
  const PropertyList list(H5Dget_create_plist(dataset), what);
  const H5D_layout_t layout = H5Pget_layout(list);
  if (layout == H5D_VIRTUAL || (layout == H5D_CONTIGUOUS && H5Pget_external_count(list) != 0))
    throw Error(what + ": its data are elsewhere; only what is in the file itself is read");
  const int filters = H5Pget_nfilters(list);
  for (int k = 0; k < filters; ++k) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(list, static_cast<unsigned>(k), &flags, &values, nullptr, 0, nullptr, &config);
    if (filter != H5Z_FILTER_FLETCHER32 && filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE)
      throw Error(what + ": behind a filter that this program does not use");
  }
}

/// How many rows a column has.
hsize_t rows_of(hid_t dataset, const std::string& what) {
  const std::vector<std::uint64_t> shape = shape_of(Space(H5Dget_space(dataset), what), what);
  if (shape.size() != 1) throw Error(what + ": not one-dimensional");
  return shape[0];
}

std::string text_of(const Array& array) {
  std::string text;
  decode(array, {"checksum", "", "", &text});
  return text;
}

void require_checksum(hid_t dataset, const std::string& found, const std::string& what) {
  if (!has_attribute(dataset, kChecksum) || text_of(read_attribute(dataset, kChecksum, 4096)) != found)
    throw Error(what + ": damaged, its checksum is another");
}

}  // namespace

void fail(const std::string& what) {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_innermost, &text);
  throw Error(what + ": " + (text.empty() ? "HDF5 failed" : text));
}

File open_file(int fd, Mode mode, DiskLog& log) {
  prepare_library();
  const PropertyList access(H5Pcreate(H5P_FILE_ACCESS), "access");
  use_descriptor(access, fd, log, mode == Mode::read_cut_off);
  // From version 1.10 of the format on, everything but raw data is checksummed.
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  // Blocks for later metadata would be lost at every closing.
  H5Pset_meta_block_size(access, 0);
  if (mode != Mode::create)
    return File(H5Fopen("file", mode == Mode::append ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access),
                "not a sound HDF5 file");
  const PropertyList creation(H5Pcreate(H5P_FILE_CREATE), "creation");
  H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_obj_track_times(creation, false);
  return File(H5Fcreate("file", H5F_ACC_TRUNC, creation, access), "file");
}

void close_file(File& file) {
  check(H5Fclose(file.release()), "closing");
}

bool exists(hid_t parent, const std::string& path) {
  // HDF5 asks that every group on the way is known to exist.
  for (std::size_t end = path.find('/');; end = path.find('/', end + 1)) {
    const std::string name = path.substr(0, end);
    if (H5Lexists(parent, name.c_str(), H5P_DEFAULT) <= 0) return false;
    H5L_info_t link;
    check(H5Lget_info(parent, name.c_str(), &link, H5P_DEFAULT), name);
    require_own(link, name);
    if (end == std::string::npos) return true;
  }
}

void remove(hid_t parent, const std::string& path) {
  if (exists(parent, path)) check(H5Ldelete(parent, path.c_str(), H5P_DEFAULT), path);
}

Group create_group(hid_t parent, const std::string& path) {
  create_groups_above(parent, path);
  return Group(H5Gcreate2(parent, path.c_str(), H5P_DEFAULT, ordered_group(), H5P_DEFAULT), path);
}

Group open_group(hid_t parent, const std::string& path) {
  if (!exists(parent, path)) throw Error(path + ": missing");
  return Group(H5Gopen2(parent, path.c_str(), H5P_DEFAULT), path);
}

std::vector<std::string> names(hid_t group) {
  Names found;
  const herr_t status =
      H5Literate(group, H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, Names::add<H5L_info_t>, &found);
  if (!found.complete) throw std::bad_alloc();
  check(status, "links");
  return std::move(found.list);
}

std::vector<DatasetInfo> datasets(hid_t group) {
  std::vector<DatasetInfo> list;
  for (const std::string& name : names(group)) {
    exists(group, name);  // in this file
    const Object object(H5Oopen(group, name.c_str(), H5P_DEFAULT), name);
    if (H5Iget_type(object) != H5I_DATASET) continue;
    const Array array = describe(Type(H5Dget_type(object), name), Space(H5Dget_space(object), name), name);
    list.push_back({name, array.type, array.shape, {}});
    if (has_attribute(object, "axis")) {
      const Array axis = read_attribute(object, "axis", 4096);
      decode(axis, {"axis", "", "", &list.back().axis});
    }
  }
  return list;
}

std::string write_field(hid_t parent, const StoredField& field) {
  const Array& value = field.value;
  const Type type = type_of(value.type, value.text_length);
  create_groups_above(parent, field.name);
  const Dataset dataset(H5Dcreate2(parent, field.name.c_str(), type, space_of(value.shape), H5P_DEFAULT,
                                   checked_layout(value), H5P_DEFAULT),
                        field.name);
  if (!value.bytes.empty())
    check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.bytes.data()), field.name);
  if (!field.unit.empty()) write_attribute(dataset, "unit", field.unit);
  if (!field.help.empty()) write_attribute(dataset, "help", field.help);
  if (!field.axis.empty()) write_attribute(dataset, "axis", field.axis);
  std::string digits = checksum(value.bytes);
  write_attribute(dataset, kChecksum, digits);
  return digits;
}

Array read_array(hid_t parent, const std::string& path, std::uint64_t limit) {
  if (!exists(parent, path)) throw Error(path + ": missing");
  const Object object(H5Oopen(parent, path.c_str(), H5P_DEFAULT), path);
  if (H5Iget_type(object) != H5I_DATASET) throw Error(path + ": not a dataset");
  require_own_storage(object, path);
  const Type type(H5Dget_type(object), path);
  Array array = describe(type, Space(H5Dget_space(object), path), path);
  allocate(array, limit, path);
  if (!array.bytes.empty())
    check(H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.bytes.data()), path);
  require_checksum(object, checksum(array.bytes), path);
  return array;
}

void write_attribute(hid_t object, const std::string& name, const Array& value) {
  const Type type = type_of(value.type, value.text_length);
  const Space space = space_of(value.shape);
  AttributeHandle attribute;
  if (has_attribute(object, name)) {
    attribute = AttributeHandle(H5Aopen(object, name.c_str(), H5P_DEFAULT), name);
    if (H5Tequal(Type(H5Aget_type(attribute), name), type) <= 0 ||
        H5Sextent_equal(Space(H5Aget_space(attribute), name), space) <= 0) {
      attribute = AttributeHandle();
      check(H5Adelete(object, name.c_str()), name);
    }
  }
  if (attribute < 0)
    attribute =
        AttributeHandle(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), name);
  check(H5Awrite(attribute, type, value.bytes.data()), name);
}

void write_attribute(hid_t object, const std::string& name, const std::string& text) {
  std::string copy = text;
  write_attribute(object, name, encode({name, "", "", &copy}).value);
}

Array read_attribute(hid_t object, const std::string& name, std::uint64_t limit) {
  const std::string label = attribute_label(object, name);
  if (!has_attribute(object, name)) throw Error(label + ": missing");
  const AttributeHandle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), label);
  const Type type(H5Aget_type(attribute), label);
  Array array = describe(type, Space(H5Aget_space(attribute), label), label);
  allocate(array, limit, label);
  if (!array.bytes.empty()) check(H5Aread(attribute, type, array.bytes.data()), label);
  return array;
}

std::string attribute_label(hid_t object, const std::string& name) {
  char path[256] = "";  // longer ones are cut
  H5Iget_name(object, path, sizeof path);
  return std::string(path) + ", attribute " + name;
}

bool has_attribute(hid_t object, const std::string& name) {
  return H5Aexists(object, name.c_str()) > 0;
}

std::vector<std::string> attribute_names(hid_t object) {
  Names found;
  const herr_t status =
      H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, Names::add<H5A_info_t>, &found);
  if (!found.complete) throw std::bad_alloc();
  check(status, "attributes");
  return std::move(found.list);
}

Dataset create_growing(hid_t parent, const std::string& name) {
  const hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = 1024;
  const PropertyList list(H5Pcreate(H5P_DATASET_CREATE), name);
  H5Pset_obj_track_times(list, false);
  H5Pset_chunk(list, 1, &chunk);
  H5Pset_fletcher32(list);
  const Space space(H5Screate_simple(1, &none, &unlimited), name);
  return Dataset(H5Dcreate2(parent, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT),
                 name);
}

void append(hid_t parent, const std::string& name, const std::vector<double>& values,
            const std::string& digits) {
  if (values.empty()) return;
  const Dataset dataset(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), name);
  const hsize_t start = rows_of(dataset, name), count = values.size(), total = start + count;
  check(H5Dset_extent(dataset, &total), name);
  const Space file(H5Dget_space(dataset), name), memory(H5Screate_simple(1, &count, nullptr), name);
  check(H5Sselect_hyperslab(file, H5S_SELECT_SET, &start, nullptr, &count, nullptr), name);
  check(H5Dwrite(dataset, H5T_IEEE_F64LE, memory, file, H5P_DEFAULT, values.data()), name);
  write_attribute(dataset, kChecksum, digits);
}

std::vector<double> read_tail(hid_t parent, const std::string& name, std::uint64_t count) {
  if (!exists(parent, name)) throw Error(name + ": missing");
  const Dataset dataset(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), name);
  const hsize_t rows = rows_of(dataset, name), size = std::min<hsize_t>(rows, count), start = rows - size;
  std::vector<double> values(size);
  const Space file(H5Dget_space(dataset), name), memory(H5Screate_simple(1, &size, nullptr), name);
  check(H5Sselect_hyperslab(file, H5S_SELECT_SET, &start, nullptr, &size, nullptr), name);
  if (size > 0) check(H5Dread(dataset, H5T_IEEE_F64LE, memory, file, H5P_DEFAULT, values.data()), name);
  return values;
}

}  // namespace cairn::h5
