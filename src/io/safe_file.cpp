#include "io/safe_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <system_error>
#include <vector>

#include "core/error.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, int error) {
  throw InputError("{}: {}", path.string(), reason(error));
}

fs::path temporary_name(const fs::path& path) {
  return path.string() + ".part";
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// A lock of the open file, not of the process: released by the last close, and invisible to flock, so that
/// readers that lock with flock (HDF5 itself does) can look at a file that is being written.
bool lock(int fd) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return fcntl(fd, F_OFD_SETLK, &whole) == 0;
}

/// Whether the name still stands for the open file.
bool same_file(int fd, const fs::path& path) {
  struct stat open_one {
  }, named{};
  return fstat(fd, &open_one) == 0 && lstat(path.c_str(), &named) == 0 && open_one.st_dev == named.st_dev &&
         open_one.st_ino == named.st_ino;
}

void require_regular(int fd, const fs::path& path) {
  struct stat info {};
  if (fstat(fd, &info) != 0) fail(path, errno);
  if (S_ISDIR(info.st_mode)) throw InputError("{}: is a folder, not a file", path.string());
  if (!S_ISREG(info.st_mode)) throw InputError("{}: is not a regular file", path.string());
}

/// The opened and locked file, or no file if there is none.
FileDescriptor try_open_locked(const fs::path& path) {
  for (;;) {
    // Without O_NONBLOCK, opening a named pipe would wait for its other end.
    FileDescriptor file(open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    if (!file) {
      if (errno == ENOENT) return {};
      if (errno == ELOOP) throw InputError("{}: is a symbolic link; name the file itself", path.string());
      if (errno == EISDIR) throw InputError("{}: is a folder, not a file", path.string());
      fail(path, errno);
    }
    require_regular(file.get(), path);
    if (!lock(file.get())) {
      if (errno != EAGAIN && errno != EACCES) fail(path, errno);
      throw InputError("{}: is being written by another process", path.string());
    }
    // Between opening and locking, the holder of the lock may have put a new file in its place.
    if (same_file(file.get(), path)) return file;
  }
}

FileDescriptor create_temporary(const fs::path& path) {
  const fs::path name = temporary_name(path);
  // What a killed process has left is in nobody's hands; what is locked is being written now.
  if (const FileDescriptor left = try_open_locked(name)) unlink(name.c_str());
  FileDescriptor file(open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!file) fail(path, errno);
  if (!lock(file.get())) throw InputError("{}: is being written by another process", path.string());
  return file;
}

/// Copies the whole of `from` into the empty `to`; 0 or an error number.
int copy_all(int from, int to) {
  off_t in = 0, out = 0;
  for (;;) {  // within the kernel, and without moving data on file systems that share blocks
    const ssize_t moved = copy_file_range(from, &in, to, &out, std::size_t{1} << 30, 0);
    if (moved == 0) return 0;
    if (moved < 0 && errno == EINTR) continue;
    if (moved < 0 && (errno == ENOSYS || errno == EXDEV || errno == EINVAL || errno == EOPNOTSUPP)) break;
    if (moved < 0) return errno;
  }
  std::vector<char> buffer(std::size_t{1} << 20);
  for (;;) {
    const ssize_t got = pread(from, buffer.data(), buffer.size(), in);
    if (got == 0) return 0;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    for (ssize_t done = 0; done < got;) {
      const ssize_t put = pwrite(to, buffer.data() + done, static_cast<std::size_t>(got - done), in + done);
      if (put < 0 && errno == EINTR) continue;
      if (put <= 0) return put < 0 ? errno : ENOSPC;
      done += put;
    }
    in += got;
  }
}

}  // namespace

FileDescriptor::~FileDescriptor() {
  if (fd_ >= 0) close(fd_);
}

FileDescriptor open_for_reading(const fs::path& path) {
  FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!file) fail(path, errno);
  require_regular(file.get(), path);
  return file;
}

FileDescriptor open_locked(const fs::path& path) {
  FileDescriptor file = try_open_locked(path);
  if (!file) fail(path, ENOENT);
  return file;
}

FileDescriptor claim(const fs::path& path, bool overwrite) {
  if (path.empty() || !path.has_filename())
    throw InputError("\"{}\": is not the name of a file", path.string());
  if (!fs::is_directory(folder_of(path)))
    throw InputError("{}: there is no folder {}", path.string(), folder_of(path).string());
  FileDescriptor old = try_open_locked(path);
  if (old && !overwrite)
    throw InputError("{}: exists already; choose another file with -o, or --force", path.string());
  const FileDescriptor probe = create_temporary(path);
  unlink(temporary_name(path).c_str());
  return old;
}

Replacement::Replacement(const fs::path& path, const FileDescriptor& old)
    : path_(path), temporary_(temporary_name(path)), file_(create_temporary(path)) {
  if (!old) return;
  struct stat info {};
  int error = fstat(old.get(), &info) == 0 ? 0 : errno;
  if (error == 0) error = copy_all(old.get(), file_.get());
  if (error == 0 && fchmod(file_.get(), info.st_mode & 07777) != 0) error = errno;
  if (error == 0) return;
  unlink(temporary_.c_str());
  fail(path, error);
}

Replacement::~Replacement() {
  if (file_) unlink(temporary_.c_str());
}

FileDescriptor Replacement::install(bool overwrite) {
  if (fsync(file_.get()) != 0) fail(path_, errno);
  int error = 0;
  if (renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), overwrite ? 0 : RENAME_NOREPLACE) != 0)
    error = errno;
  if (!overwrite &&
      (error == EINVAL || error == ENOSYS)) {  // some file systems cannot check and rename at once
    error = fs::exists(fs::symlink_status(path_)) ? EEXIST : 0;
    if (error == 0 && rename(temporary_.c_str(), path_.c_str()) != 0) error = errno;
  }
  if (error != 0) fail(path_, error);
  return std::move(file_);
}

void sync_folder(const fs::path& path) {
  const FileDescriptor folder(open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder) fail(path, errno);
  // EINVAL: a file system without anything to bring to the disk.
  if (fsync(folder.get()) != 0 && errno != EINVAL) fail(path, errno);
}

void survive_file_size_limit() {
  struct sigaction now {};
  if (sigaction(SIGXFSZ, nullptr, &now) == 0 && (now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == SIG_DFL)
    std::signal(SIGXFSZ, SIG_IGN);
}

std::string reason(int error) {
  return std::generic_category().message(error);
}

}  // namespace cairn
