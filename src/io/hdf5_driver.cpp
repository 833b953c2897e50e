#include "io/hdf5_driver.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>

#include "io/hdf5.h"

#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>
#endif

namespace cairn::h5 {
namespace {

struct Target {
  int fd;
  DiskLog* log;
  bool cut_off;
};

/// HDF5 keeps its own part of an open file first.
struct DriverFile {
  H5FD_t base;
  Target target;
  haddr_t allocated;  ///< bytes HDF5 has given out
  haddr_t end;        ///< bytes in the file
};
static_assert(std::is_standard_layout_v<DriverFile>);

constexpr haddr_t kLargestAddress = INT64_MAX;

DriverFile& self(const H5FD_t* file) {
  return *reinterpret_cast<DriverFile*>(const_cast<H5FD_t*>(file));
}

void remember(const DriverFile& file, int error) {
  if (file.target.log->error == 0) file.target.log->error = error;
}

/// Nothing may be thrown through HDF5: it would leave its own state in disorder, and break down later.
void remember_written(const DriverFile& file, haddr_t begin, haddr_t end) noexcept {
  try {
    file.target.log->changes.write(begin, end);
  } catch (const std::bad_alloc&) {
    remember(file, ENOMEM);
  }
}

H5FD_t* open_file(const char*, unsigned, hid_t access_list, haddr_t) {
  const auto* target = static_cast<const Target*>(H5Pget_driver_info(access_list));
  struct stat info {};
  if (target == nullptr || fstat(target->fd, &info) != 0) return nullptr;
  auto* file = new (std::nothrow) DriverFile{{}, *target, 0, static_cast<haddr_t>(info.st_size)};
  return file == nullptr ? nullptr : &file->base;
}

herr_t close_file(H5FD_t* file) {
  delete &self(file);
  return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE;
  return 0;
}

haddr_t get_allocated(const H5FD_t* file, H5FD_mem_t) {
  return self(file).allocated;
}

herr_t set_allocated(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  self(file).allocated = address;
  return 0;
}

haddr_t get_end(const H5FD_t* file, H5FD_mem_t) {
  return self(file).target.cut_off ? kLargestAddress : self(file).end;
}

herr_t read_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
  const DriverFile& file = self(base);
  auto* out = static_cast<std::byte*>(buffer);
  while (size > 0) {
    const ssize_t got = pread(file.target.fd, out, size, static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      remember(file, errno);
      return -1;
    }
    if (got == 0) {  // HDF5 counts on zeros where it has allocated but not yet written
      std::memset(out, 0, size);
      break;
    }
    out += got;
    size -= static_cast<std::size_t>(got);
    address += static_cast<haddr_t>(got);
  }
  return 0;
}

herr_t write_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
  DriverFile& file = self(base);
  const auto* in = static_cast<const std::byte*>(buffer);
  file.end = std::max(file.end, address + size);
  remember_written(file, address, address + size);
  while (size > 0 && file.target.log->error == 0) {
    const ssize_t put = pwrite(file.target.fd, in, size, static_cast<off_t>(address));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) {
      remember(file, put < 0 ? errno : ENOSPC);
      break;
    }
    in += put;
    size -= static_cast<std::size_t>(put);
    address += static_cast<haddr_t>(put);
  }
  return 0;
}

herr_t truncate_file(H5FD_t* base, hid_t, hbool_t) {
  DriverFile& file = self(base);
  if (file.end == file.allocated) return 0;
  file.target.log->changes.cut(file.allocated);
  if (file.target.log->error == 0 && ftruncate(file.target.fd, static_cast<off_t>(file.allocated)) != 0)
    remember(file, errno);
  file.end = file.allocated;
  return 0;
}

hid_t register_driver() {
  H5FD_class_t driver{};
#ifdef H5FD_CLASS_VERSION
  driver.version = H5FD_CLASS_VERSION;
  driver.value = 512;  // of the range HDF5 leaves to applications
#endif
  driver.name = "descriptor";
  driver.maxaddr = kLargestAddress;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(Target);
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query;
  driver.get_eoa = get_allocated;
  driver.set_eoa = set_allocated;
  driver.get_eof = get_end;
  driver.read = read_bytes;
  driver.write = write_bytes;
  driver.truncate = truncate_file;
  const H5FD_mem_t one_list[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(one_list), std::end(one_list), std::begin(driver.fl_map));
  return H5FDregister(&driver);
}

}  // namespace

void use_descriptor(hid_t access_list, int fd, DiskLog& log, bool cut_off) {
  static const hid_t driver = register_driver();
  const Target target{fd, &log, cut_off};
  if (H5Pset_driver(access_list, driver, &target) < 0) fail("file driver");
}

}  // namespace cairn::h5
