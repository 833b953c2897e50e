#include "io/inputs.h"

#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "io/input_store.h"
#include "io/source.h"

namespace cairn {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kKept = 16'000'000;  // bytes of one file

std::string read_whole(const fs::path& path, std::uint64_t most) {
  const std::string name = printable(path.string(), 4096);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw InputError("{}: no such file", name);
  if (error) throw InputError("{}: {}", name, error.message());
  // Only a regular file has an end for certain; opening a pipe would wait for ever.
  if (!fs::is_regular_file(status)) throw InputError("{}: not a regular file", name);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError("{}: cannot be read: {}", name, std::strerror(errno));
  std::string bytes;
  std::vector<char> block(1 << 20);
  while (file && bytes.size() <= most) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    bytes.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (bytes.size() > most) throw InputError("{}: larger than {} MB", name, most / 1'000'000);
  if (file.bad()) throw InputError("{}: cannot be read: {}", name, std::strerror(errno));
  return bytes;
}

}  // namespace

std::string checksum_of(const std::string& bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("xxh3-128:{:016x}{:016x}", hash.high64, hash.low64);
}

InputFiles::InputFiles(fs::path directory) : store_(std::make_shared<Store>()) {
  store_->directory = std::move(directory);
}

fs::path InputFiles::path_of(const std::string& name) const {
  return store_->directory / name;
}

std::string InputFiles::read(const std::string& name, std::uint64_t most) const {
  return read(name, path_of(name), most);
}

std::string InputFiles::read(const std::string& name, const fs::path& path, std::uint64_t most) const {
  const auto kept = store_->inputs.find(name);
  if (kept != store_->inputs.end() && kept->second.whole) return kept->second.bytes;
  if (kept == store_->inputs.end() && store_->closed)
    throw InputError("{}: not among the files that the run was started with", printable(path.string(), 4096));
  std::string bytes = read_whole(path, most);
  std::string checksum = checksum_of(bytes);
  if (kept != store_->inputs.end()) {
    if (checksum != kept->second.checksum)
      throw InputError("{}: has changed since the run was started; expected the former content, {}",
                       printable(path.string(), 4096), kept->second.checksum);
    return bytes;
  }
  const bool whole = bytes.size() <= kKept;
  store_->inputs[name] = {std::move(checksum), whole, whole ? bytes : std::string()};
  return bytes;
}

void InputFiles::reopen() const {
  store_->closed = false;
}

}  // namespace cairn
