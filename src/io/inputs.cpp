#include "io/inputs.h"

#include <algorithm>

#include "core/error.h"
#include "core/read_file.h"
#include "io/checksum.h"
#include "io/input_store.h"
#include "io/source.h"

namespace cairn {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kKept = 16'000'000;  // bytes of one file

}  // namespace

std::string checksum_of(const std::string& bytes) {
  return "xxh3-128:" + cairn::checksum(bytes);
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
  std::string bytes = read_file(path, printable(path.string(), 4096), {.most = most});
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

void InputFiles::note(const std::string& line) const {
  std::vector<std::string>& notes = store_->notes;
  if (std::find(notes.begin(), notes.end(), line) == notes.end()) notes.push_back(line);
}

const std::vector<std::string>& InputFiles::notes() const {
  return store_->notes;
}

void InputFiles::reopen() const {
  store_->closed = false;
}

}  // namespace cairn
