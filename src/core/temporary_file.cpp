#include "core/temporary_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnd = ".part";
constexpr std::size_t kDigits = 8;         // random, and as many that follow from them
constexpr std::size_t kLongestName = 255;  // bytes, of a name in a folder

/// What every name begins with.
std::string beginning(const std::string& file) {
  std::size_t length = std::min(file.size(), kLongestName - 2 * kDigits - 1 - kEnd.size());
  while (length < file.size() && length > 0 && (file[length] & 0xc0) == 0x80) --length;  // within a character
  return file.substr(0, length) + ".";
}

/// The digits that follow from the random ones (FNV-1a).
std::string check_digits(const std::string& file, std::string_view random) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::string_view part : {std::string_view(file), std::string_view("/cairn/"), random})
    for (const char c : part) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:08x}", static_cast<std::uint32_t>(hash ^ hash >> 32));
}

bool is_temporary_name(const std::string& name, const std::string& file) {
  const std::string begin = beginning(file);
  if (name.size() != begin.size() + 2 * kDigits + kEnd.size() || !name.starts_with(begin) ||
      !name.ends_with(kEnd))
    return false;
  return name.compare(begin.size() + kDigits, kDigits,
                      check_digits(file, std::string_view(name).substr(begin.size(), kDigits))) == 0;
}

}  // namespace

TemporaryFile TemporaryFile::create(const fs::path& path, mode_t mode) {
  const std::string file = path.filename().string();
  for (int tries = 100;; --tries) {
    std::uint32_t random = 0;
    if (uninterrupted([&] { return getrandom(&random, sizeof random, 0); }) != sizeof random)
      fail(path, errno);
    const std::string digits = fmt::format("{:08x}", random);
    TemporaryFile made{path.parent_path() /
                           fmt::format("{}{}{}{}", beginning(file), digits, check_digits(file, digits), kEnd),
                       {}};
    made.file = FileDescriptor(uninterrupted(
        [&] { return open(made.name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode); }));
    if (!made.file && errno == EEXIST && tries > 1) continue;
    if (!made.file) fail(path, errno);
    const int error = lock(made.file) ? 0 : errno;
    // Until it was locked, another process may have taken it for a leftover.
    if (error == 0 && is_named(made.file, made.name)) return made;
    made.remove();
    if (error != 0 && ((error != EAGAIN && error != EACCES) || tries <= 1)) fail(path, error);
  }
}

void TemporaryFile::remove() const {
  if (is_named(file, name)) unlink(name.c_str());
}

void remove_leftovers(const fs::path& path) {
  const std::string file = path.filename().string();
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (is_temporary_name(entry->path().filename().string(), file)) found.push_back(entry->path());
  for (const fs::path& name : found) {
    TemporaryFile left{name, FileDescriptor(uninterrupted([&] {
                         return open(name.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
                       }))};
    struct stat info {};
    if (left.file && fstat(left.file.get(), &info) == 0 && S_ISREG(info.st_mode) &&
        info.st_uid == geteuid() && lock(left.file))
      left.remove();
  }
}

}  // namespace cairn
