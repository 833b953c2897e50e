#include "core/read_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "core/error.h"

namespace cairn {

void require_regular(const std::filesystem::path& path, const std::string& name, std::string_view what) {
  using std::filesystem::file_type;
  std::error_code error;
  const file_type type = std::filesystem::status(path, error).type();
  if (type == file_type::regular) return;
  if (type == file_type::not_found) throw InputError("{}: no such {}", name, what);
  if (error) throw InputError("{}: {}", name, error.message());
  throw InputError("{}: expected a {}, found {}", name, what,
                   type == file_type::directory ? "a directory"
                   : type == file_type::fifo    ? "a pipe"
                   : type == file_type::socket  ? "a socket"
                                                : "a device");
}

std::string read_file(const std::filesystem::path& path, const std::string& name, const FileKind& kind) {
  require_regular(path, name, kind.what);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError("{}: cannot be read: {}", name, std::strerror(errno));
  std::string bytes;
  std::vector<char> block(1 << 20);
  while (file && bytes.size() <= kind.most) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    bytes.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (bytes.size() > kind.most) throw InputError("{}: larger than {} MB", name, kind.most / 1'000'000);
  if (!file.eof()) throw InputError("{}: cannot be read: {}", name, std::strerror(errno));
  return bytes;
}

}  // namespace cairn
