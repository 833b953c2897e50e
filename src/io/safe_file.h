// Replacing a file so that its name always stands for a whole file, and keeping two writers apart.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>

namespace cairn {

/// Owns an open file; closing it gives up its lock.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileDescriptor();

  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// Opens an existing regular file for reading. Throws InputError.
FileDescriptor open_for_reading(const std::filesystem::path& path);

/// Opens an existing regular file (no symbolic link) and takes its lock, which the kernel drops when the
/// process dies. Throws InputError, also when another process holds the lock.
FileDescriptor open_locked(const std::filesystem::path& path);

/// Throws InputError unless a file can be made at `path`: its folder exists and is writable, and nothing is
/// there or, with `overwrite`, a regular file that nobody else writes. Returns the lock of a file that is
/// there.
FileDescriptor claim(const std::filesystem::path& path, bool overwrite);

/// The next version of a file, written beside it under a temporary name (the path + ".part") and locked.
/// Removed again unless installed.
class Replacement {
 public:
  /// Starts as a copy of `old`, or empty when `old` holds no file. Throws InputError.
  Replacement(const std::filesystem::path& path, const FileDescriptor& old);
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;
  ~Replacement();

  int fd() const { return file_.get(); }

  /// Brings the content to the disk and gives it the file's name, in one step for all others. Returns the
  /// file, still locked. A file that is there is replaced only with `overwrite`. Throws InputError.
  FileDescriptor install(bool overwrite);

 private:
  std::filesystem::path path_, temporary_;
  FileDescriptor file_;
};

/// Makes a completed install survive a power cut. Throws InputError.
void sync_folder(const std::filesystem::path& path);

/// A write beyond the file-size limit shall fail like one to a full disk instead of killing the process.
void survive_file_size_limit();

/// The text of an operating system error.
std::string reason(int error);

}  // namespace cairn
