// The files that a scene names: read once, and kept in the result file, so that a run goes on with what it
// was started with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace cairn {

class ResultFile;

/// Files by the names that the scene calls them. Copies share what has been read.
class InputFiles {
 public:
  /// Relative names start at `directory`, which stands for its files wherever these are asked for.
  InputFiles(std::filesystem::path directory = ".");  // NOLINT(google-explicit-constructor)

  /// The content of a file: as it was when it was first read, or when the run began that is resumed.
  /// @throws InputError "PATH: what is wrong" for what is no regular file, is larger than `most` bytes, has
  /// changed since, or is not among those that the result file keeps.
  std::string read(const std::string& name,
                   std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) const;
  /// The same of a file at `path`, for names that are no paths.
  std::string read(const std::string& name, const std::filesystem::path& path, std::uint64_t most) const;

  /// Where a name leads, for messages.
  std::filesystem::path path_of(const std::string& name) const;

  /// Adds a line on how a file was read, unless it is there already.
  void note(const std::string& line) const;
  /// What a user should know of how the files were read, a line each.
  const std::vector<std::string>& notes() const;

  /// Adds the group `inputs` with all that has been read. Of files beyond 16 MB it holds only a checksum.
  void write(ResultFile& file) const;
  /// Takes what was read from the group. From now on other files are not read.
  /// @throws InputError for a damaged group.
  void restore(const ResultFile& file) const;
  /// Lets files be read that are not kept, those of stages added to the scene.
  void reopen() const;

 private:
  struct Store;
  std::shared_ptr<Store> store_;
};

}  // namespace cairn
