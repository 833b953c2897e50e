#include "io/verify.h"

#include <algorithm>

#include "core/error.h"
#include "io/checksum.h"
#include "io/hdf5.h"
#include "io/results.h"

namespace cairn {
namespace {

class Walk {
 public:
  explicit Walk(std::uint64_t limit) : limit_(limit) {}

  void group(hid_t group, const std::string& path) {
    std::vector<std::string> names;
    reading(path, [&] { names = h5::names(group); });
    std::ranges::sort(names);
    for (const std::string& name : names) {
      const std::string below = path + "/" + name;
      reading(below, [&] {
        h5::exists(group, name);  // in this file
        const h5::Object object(H5Oopen(group, name.c_str(), H5P_DEFAULT), "it cannot be opened");
        const H5I_type_t type = H5Iget_type(object);
        add(below);
        attributes(object);
        if (type == H5I_DATASET) dataset(group, name);
        if (type == H5I_GROUP) {
          if (below.size() > kLongestPath) throw h5::Error("groups within groups without an end");
          this->group(object, below);
        }
      });
    }
  }

  Verification result() && {
    found_.digest = sum_.digest();
    return std::move(found_);
  }

 private:
  static constexpr std::size_t kLongestPath = 1000;

  template <class Work>
  void reading(const std::string& path, Work&& work) {
    try {
      work();
    } catch (const h5::Error& error) {
      found_.damaged.push_back(path + ": " + error.what());
    }
  }

  void add(const std::string& text) { sum_.add(std::as_bytes(std::span(text.c_str(), text.size() + 1))); }
  void add(const Array& array) {
    add(name_of(array.type));
    sum_.add(std::as_bytes(std::span(array.shape)));
    sum_.add(array.bytes);
  }

  void attributes(hid_t object) {
    for (const std::string& name : h5::attribute_names(object)) {
      add(name);
      add(h5::read_attribute(object, name, limit_));
    }
  }

  void dataset(hid_t parent, const std::string& name) {
    const Array array = h5::read_array(parent, name, limit_);
    ++found_.datasets;
    found_.bytes += array.bytes.size();
    add(array);
  }

  std::uint64_t limit_;
  RunningChecksum sum_;
  Verification found_;
};

}  // namespace

Verification verify(const std::filesystem::path& path) {
  const bool scene_as_written =
      ResultFile::open(path).scene_is_as_written();  // and what else is checked there
  const FileDescriptor file = open_for_reading(path);
  h5::DiskLog log;
  try {
    const h5::File opened = h5::open_file(file.get(), h5::Mode::read, log);
    Walk walk(std::filesystem::file_size(path));
    walk.group(opened, "");
    Verification found = std::move(walk).result();
    if (!scene_as_written)
      found.damaged.insert(found.damaged.begin(), "attribute scene: not as it was written");
    return found;
  } catch (const h5::Error& error) {
    throw InputError("{}: {}", path.string(), log.error != 0 ? reason(log.error) : error.what());
  }
}

}  // namespace cairn
