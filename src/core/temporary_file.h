// The next version of a file while it is being written: beside it, under a name that nobody else gives.
#pragma once

#include <sys/types.h>

#include "core/file_descriptor.h"

namespace cairn {

/// A new, empty, locked file. Its name, "FILE.0123456789abcdef.part", cannot be foreseen, and half of its
/// digits follow from the other half and from FILE, so that it tells by whom it was made.
struct TemporaryFile {
  std::filesystem::path name;
  FileDescriptor file;

  /// Makes one beside `path`, with the permissions `mode` less the umask. Throws InputError.
  static TemporaryFile create(const std::filesystem::path& path, mode_t mode);
  /// Takes the name away, unless it stands for another file by now.
  void remove() const;
};

/// Removes what killed processes of this user have left of their next versions of `path`: files of such a
/// name that no living process has locked.
void remove_leftovers(const std::filesystem::path& path);

}  // namespace cairn
