#include "core/safe_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <limits>
#include <optional>

#include "core/error.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void require_regular(const fs::path& path, mode_t mode) {
  if (S_ISLNK(mode)) throw InputError("{}: is a symbolic link; name the file itself", path.string());
  if (S_ISDIR(mode)) throw InputError("{}: is a folder, not a file", path.string());
  if (!S_ISREG(mode)) throw InputError("{}: is not a regular file", path.string());
}

void require_regular(const fs::path& path, const FileDescriptor& file) {
  struct stat info {};
  if (fstat(file.get(), &info) != 0) fail(path, errno);
  require_regular(path, info.st_mode);
}

/// Those of the regular file of this name; none: there is no such file.
std::optional<mode_t> permissions(const fs::path& path) {
  struct stat info {};
  if (lstat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return info.st_mode & 0777;
}

/// Throws InputError unless nothing is at `path` or, with `overwrite`, a regular file that may be written.
void require_target(const fs::path& path, bool overwrite) {
  if (path.empty() || !path.has_filename())
    throw InputError("\"{}\": is not the name of a file", path.string());
  struct stat info {};
  if (stat(folder_of(path).c_str(), &info) != 0 || !S_ISDIR(info.st_mode))
    throw InputError("{}: there is no folder {}", path.string(), folder_of(path).string());
  if (lstat(path.c_str(), &info) != 0) {
    if (errno == ENOENT) return;
    fail(path, errno);
  }
  require_regular(path, info.st_mode);
  if (!overwrite)
    throw InputError("{}: exists already; choose another file with -o, or --force", path.string());
  if (faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) fail(path, errno);
}

/// The opened and locked file, or no file if there is none.
FileDescriptor try_open_locked(const fs::path& path) {
  for (;;) {
    // Without O_NONBLOCK, opening a named pipe would wait for its other end.
    FileDescriptor file(
        uninterrupted([&] { return open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK); }));
    if (!file) {
      if (errno == ENOENT) return {};
      if (errno == ELOOP) require_regular(path, S_IFLNK);
      if (errno == EISDIR) require_regular(path, S_IFDIR);
      fail(path, errno);
    }
    require_regular(path, file);
    if (!lock(file)) {
      if (errno != EAGAIN && errno != EACCES) fail(path, errno);
      throw InputError("{}: is being written by another process", path.string());
    }
    // Between opening and locking, the holder of the lock may have put a new file in its place.
    if (is_named(file, path)) return file;
  }
}

/// Writes all of it at an offset; 0 or an error number.
int write_all(int fd, const char* data, std::size_t size, off_t at) {
  while (size > 0) {
    const ssize_t put = uninterrupted([&] { return pwrite(fd, data, size, at); });
    if (put <= 0) return put < 0 ? errno : ENOSPC;
    data += put;
    size -= static_cast<std::size_t>(put);
    at += put;
  }
  return 0;
}

/// Copies bytes [begin, end) of `from`, or up to its end, to the same place in `to`; 0 or an error number.
int copy_bytes(int from, int to, off_t begin, off_t end) {
  off_t in = begin, out = begin;
  const auto left = [&](std::size_t most) { return std::min(static_cast<std::size_t>(end - in), most); };
  while (in < end) {  // within the kernel, and without moving data on file systems that share blocks
    const ssize_t moved =
        uninterrupted([&] { return copy_file_range(from, &in, to, &out, left(std::size_t{1} << 30), 0); });
    if (moved == 0) return 0;
    if (moved < 0 && (errno == ENOSYS || errno == EXDEV || errno == EINVAL || errno == EOPNOTSUPP)) break;
    if (moved < 0) return errno;
  }
  std::array<char, 1 << 16> buffer;
  while (in < end) {
    const ssize_t got = uninterrupted([&] { return pread(from, buffer.data(), left(buffer.size()), in); });
    if (got == 0) return 0;
    if (got < 0) return errno;
    if (const int error = write_all(to, buffer.data(), static_cast<std::size_t>(got), in)) return error;
    in += got;
  }
  return 0;
}

/// Whether nobody else has the file open, so that it may be written in place: a program that looks at an old
/// version shall see it as it was.
bool is_ours_alone(int fd) {
  // On other machines' file systems only locks are seen.
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) return false;
  flock(fd, LOCK_UN);
  // Should somebody open it at this very moment, the kernel sends a signal, which must be one that is
  // ignored.
  fcntl(fd, F_SETSIG, SIGURG);
  if (fcntl(fd, F_SETLEASE, F_WRLCK) != 0) return false;
  fcntl(fd, F_SETLEASE, F_UNLCK);
  return true;
}

/// Gives `spare` the bytes of `present`; whether that went well.
bool catch_up(const Spare& spare, int present) {
  const int fd = spare.version.file.get();
  struct stat info {
  }, now{};
  if (!is_ours_alone(fd) || fstat(fd, &info) != 0 || fstat(present, &now) != 0) return false;
  if (spare.behind.shortest() < static_cast<std::uint64_t>(info.st_size) &&
      ftruncate(fd, static_cast<off_t>(spare.behind.shortest())) != 0)
    return false;
  for (const auto& [begin, end] : spare.behind.written())
    if (copy_bytes(present, fd, static_cast<off_t>(begin), static_cast<off_t>(end)) != 0) return false;
  return ftruncate(fd, now.st_size) == 0 && fchmod(fd, now.st_mode & 07777) == 0;
}

}  // namespace

FileDescriptor open_for_reading(const fs::path& path) {
  FileDescriptor file(uninterrupted([&] { return open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK); }));
  if (!file) fail(path, errno);
  require_regular(path, file);
  return file;
}

FileDescriptor open_locked(const fs::path& path) {
  FileDescriptor file = try_open_locked(path);
  if (!file) fail(path, ENOENT);
  remove_leftovers(path);
  return file;
}

void require_writable(const fs::path& path, bool overwrite) {
  require_target(path, overwrite);
  TemporaryFile::create(path, 0600).remove();
}

FileDescriptor claim(const fs::path& path, bool overwrite) {
  require_writable(path, overwrite);
  FileDescriptor old = try_open_locked(path);
  remove_leftovers(path);
  return old;
}

Replacement Replacement::of(const fs::path& path, const FileDescriptor& old, Spare spare) {
  const TemporaryFile& version = spare.version;
  if (old && version.file && is_named(version.file, version.name) && catch_up(spare, old.get()))
    return Replacement(path, std::move(spare.version));
  spare = Spare();  // its room may be needed
  return Replacement(path, old);
}

Replacement::Replacement(const fs::path& path, const FileDescriptor& old)
    : path_(path), next_(TemporaryFile::create(path, permissions(path).value_or(0666))) {
  survive_file_size_limit();
  int error = old ? copy_bytes(old.get(), fd(), 0, std::numeric_limits<off_t>::max()) : 0;
  if (const auto mode = permissions(path); error == 0 && mode && fchmod(fd(), *mode) != 0) error = errno;
  if (error == 0) return;
  next_.remove();
  fail(path, error);
}

Replacement::~Replacement() {
  if (next_.file) next_.remove();
}

FileDescriptor Replacement::install(bool overwrite) {
  if (uninterrupted([&] { return fsync(fd()); }) != 0) fail(path_, errno);
  const char *from = next_.name.c_str(), *to = path_.c_str();
  int error = renameat2(AT_FDCWD, from, AT_FDCWD, to, overwrite ? 0 : RENAME_NOREPLACE) == 0 ? 0 : errno;
  if (!overwrite &&
      (error == EINVAL || error == ENOSYS)) {  // some file systems cannot check and rename at once
    struct stat info {};
    error = lstat(to, &info) == 0 ? EEXIST : 0;
    if (error == 0 && rename(from, to) != 0) error = errno;
  }
  if (error != 0) fail(path_, error);
  return std::move(next_.file);
}

Spare Replacement::exchange(FileDescriptor& file, Changes changes) {
  if (uninterrupted([&] { return fsync(fd()); }) != 0) fail(path_, errno);
  // What the user has put there meanwhile stays.
  const bool ours = is_named(file, path_);
  if (!ours || renameat2(AT_FDCWD, next_.name.c_str(), AT_FDCWD, path_.c_str(), RENAME_EXCHANGE) != 0) {
    file = install(ours);
    return {};
  }
  return Spare({next_.name, std::exchange(file, std::move(next_.file))}, std::move(changes));
}

void sync_folder(const fs::path& path) {
  const FileDescriptor folder(
      uninterrupted([&] { return open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); }));
  if (!folder) fail(path, errno);
  // EINVAL: a file system without anything to bring to the disk.
  if (uninterrupted([&] { return fsync(folder.get()); }) != 0 && errno != EINVAL) fail(path, errno);
}

void write_file(const fs::path& path, std::string_view content, bool overwrite) {
  require_target(path, overwrite);
  remove_leftovers(path);
  Replacement next(path);
  if (const int error = write_all(next.fd(), content.data(), content.size(), 0)) fail(path, error);
  next.install(overwrite);
  sync_folder(path);
}

void survive_file_size_limit() {
  struct sigaction now {};
  if (sigaction(SIGXFSZ, nullptr, &now) == 0 && (now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == SIG_DFL)
    std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace cairn
