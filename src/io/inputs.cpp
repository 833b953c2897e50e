#include "io/inputs.h"

#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>

#include "core/error.h"
#include "io/source.h"

namespace cairn {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kKept = 16'000'000;  // bytes of one file

struct Input {
  std::string checksum;
  bool whole = false;
  std::string bytes;  ///< when whole
};

std::string checksum_of(const std::string& bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("xxh3-128:{:016x}{:016x}", hash.high64, hash.low64);
}

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

std::string dataset(std::size_t k) {
  return fmt::format("{:04}", k);
}

}  // namespace

struct InputFiles::Store {
  fs::path directory;
  std::map<std::string, Input> inputs;
  bool closed = false;
};

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

void InputFiles::write(ResultFile& file) const {
  if (store_->inputs.empty()) return;
  std::vector<std::string> names, checksums;
  std::vector<std::uint8_t> whole;
  std::vector<std::vector<std::uint8_t>> bytes;
  for (const auto& [name, input] : store_->inputs) {
    names.push_back(name);
    checksums.push_back(input.checksum);
    whole.push_back(input.whole);
    bytes.emplace_back(input.bytes.begin(), input.bytes.end());
  }
  FieldTable table{{"name", "", "of a file, as the scene calls it", &names, "file"},
                   {"checksum", "", "of its content", &checksums, "file"},
                   {"whole", "", "1: its content is here, in the dataset of its number", &whole, "file"}};
  for (std::size_t k = 0; k < bytes.size(); ++k)
    if (whole[k]) table.push_back({dataset(k), "", "bytes of " + names[k], &bytes[k], ""});
  file.write_static("inputs", table);
}

void InputFiles::restore(const ResultFile& file) const {
  store_->inputs.clear();
  store_->closed = true;
  if (!file.has_group("inputs")) return;
  std::vector<std::string> names, checksums;
  std::vector<std::uint8_t> whole;
  file.read_static("inputs", {{"name", "", "", &names, "file"},
                              {"checksum", "", "", &checksums, "file"},
                              {"whole", "", "", &whole, "file"}});
  for (std::size_t k = 0; k < names.size(); ++k) {
    Input input{checksums[k], whole[k] != 0, {}};
    if (input.whole) {
      std::vector<std::uint8_t> bytes;
      file.read_static("inputs", {{dataset(k), "", "", &bytes, ""}});
      input.bytes.assign(bytes.begin(), bytes.end());
      if (checksum_of(input.bytes) != input.checksum)
        throw InputError("{}: inputs/{}: damaged", file.path().string(), dataset(k));
    }
    store_->inputs[names[k]] = std::move(input);
  }
}

void InputFiles::reopen() const {
  store_->closed = false;
}

}  // namespace cairn
