// Replacing a file so that its name always stands for a whole file, and keeping two writers apart.
#pragma once

#include <string_view>

#include "core/changes.h"
#include "core/file_descriptor.h"
#include "core/temporary_file.h"

namespace cairn {

/// Opens an existing regular file for reading. Throws InputError.
FileDescriptor open_for_reading(const std::filesystem::path& path);

/// Opens an existing regular file (no symbolic link) and takes its lock, which the kernel drops when the
/// process dies. Throws InputError, also when another process holds the lock.
FileDescriptor open_locked(const std::filesystem::path& path);

/// Throws InputError unless a file can be made at `path`: its folder exists and is writable, and nothing is
/// there or, with `overwrite`, a regular file that may be written.
void require_writable(const std::filesystem::path& path, bool overwrite);

/// The same, and nobody else writes the file that is there. Returns its lock.
FileDescriptor claim(const std::filesystem::path& path, bool overwrite);

/// An earlier version of a file, kept beside it under a temporary name, so that the next version need not
/// begin as a copy of all. Removed when it goes.
struct Spare {
  TemporaryFile version;  ///< without a file: there is none
  Changes behind;         ///< what it lacks of the present version

  Spare() = default;
  Spare(TemporaryFile earlier, Changes lacks) : version(std::move(earlier)), behind(std::move(lacks)) {}
  Spare(Spare&&) noexcept = default;
  Spare& operator=(Spare&& other) noexcept {
    std::swap(version, other.version);
    std::swap(behind, other.behind);
    return *this;
  }
  ~Spare() {
    if (version.file) version.remove();
  }
};

/// The next version of a file, written beside it into a temporary file. Removed again unless installed.
class Replacement {
 public:
  /// Starts as a copy of `old`, or empty when `old` holds no file; with the permissions of the file at
  /// `path`, if there is one. Throws InputError.
  explicit Replacement(const std::filesystem::path& path, const FileDescriptor& old = {});
  /// The same, made of `spare` where there is one that nobody else has open.
  static Replacement of(const std::filesystem::path& path, const FileDescriptor& old, Spare spare);
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;
  ~Replacement();

  int fd() const { return next_.file.get(); }

  /// Brings the content to the disk and gives it the file's name, in one step for all others. Returns the
  /// file, still locked. A file that is there is replaced only with `overwrite`. Throws InputError.
  FileDescriptor install(bool overwrite);

  /// The same for a file that will be replaced again: `file` is the present version, and becomes the new one.
  /// `changes` is what was written since the start. Returns the former version where it can be kept.
  Spare exchange(FileDescriptor& file, Changes changes);

 private:
  Replacement(std::filesystem::path path, TemporaryFile next)
      : path_(std::move(path)), next_(std::move(next)) {}

  std::filesystem::path path_;
  TemporaryFile next_;
};

/// Makes a completed install survive a power cut. Throws InputError.
void sync_folder(const std::filesystem::path& path);

/// Writes a whole file: whatever happens, its name stands for all of the old or all of the new content. A
/// regular file that is there is replaced only with `overwrite`. Throws InputError.
void write_file(const std::filesystem::path& path, std::string_view content, bool overwrite);

/// A write beyond the file-size limit shall fail like one to a full disk instead of killing the process.
void survive_file_size_limit();

}  // namespace cairn
