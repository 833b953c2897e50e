// An open file of the operating system, and what can be asked of it.
#pragma once

#include <cerrno>
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

/// The result of a system call that returns -1 on failure, called again when a signal has interrupted it.
template <class Call>
auto uninterrupted(Call&& call) {
  for (;;)
    if (const auto result = call(); result != -1 || errno != EINTR) return result;
}

/// Takes the lock of an open file for writing, without waiting; whether it could. It belongs to this opening
/// of the file, not to the process: the last close or the death of the process gives it up, and it is
/// invisible to flock, so that readers that lock with flock (HDF5 itself does) can look at a file that is
/// being written.
bool lock(const FileDescriptor& file);

/// Whether a name stands for the open file.
bool is_named(const FileDescriptor& file, const std::filesystem::path& path);

/// The text of an operating system error.
std::string reason(int error);

/// Throws InputError: "path: " and the text of the error.
[[noreturn]] void fail(const std::filesystem::path& path, int error);

}  // namespace cairn
