#include "core/file_descriptor.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <system_error>

#include "core/error.h"

namespace cairn {

FileDescriptor::~FileDescriptor() {
  if (fd_ >= 0) close(fd_);
}

bool lock(const FileDescriptor& file) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return uninterrupted([&] { return fcntl(file.get(), F_OFD_SETLK, &whole); }) == 0;
}

bool is_named(const FileDescriptor& file, const std::filesystem::path& path) {
  struct stat open_one {
  }, named{};
  return fstat(file.get(), &open_one) == 0 && lstat(path.c_str(), &named) == 0 &&
         open_one.st_dev == named.st_dev && open_one.st_ino == named.st_ino;
}

std::string reason(int error) {
  return std::generic_category().message(error);
}

void fail(const std::filesystem::path& path, int error) {
  throw InputError("{}: {}", path.string(), reason(error));
}

}  // namespace cairn
