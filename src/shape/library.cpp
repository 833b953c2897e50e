#include "shape/library.h"

#include <algorithm>
#include <cstdlib>

#include "core/error.h"
#include "core/read_file.h"
#include "core/safe_file.h"
#include "core/suggest.h"
#include "shape/mesh.h"
#include "shape/shape_file.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

fs::path library_directory() {
  const char* chosen = std::getenv("CAIRN_SHAPES");
  return chosen && *chosen ? chosen : CAIRN_SHAPES_DIR;
}

// Where a shape is expected, users name the mesh that they would like to be one.
void refuse_mesh(const fs::path& path) {
  if (!mesh_kind(path).empty())
    throw InputError(
        "{}: expected a shape file, found a mesh: `cairn shape fit` makes a shape file of it, `cairn shape "
        "check` tells about the mesh itself",
        path.string());
}

fs::path library_file(const std::string& name) {
  const fs::path path = library_directory() / (name + ".toml");
  std::error_code error;
  if (!name.empty() && fs::exists(path, error)) return path;
  const std::vector<std::string> names = library_names();
  const std::string nearest = nearest_name(name.substr(0, 100), names);
  throw InputError("shape '{}': not in the library {}: {}", name, library_directory().string(),
                   nearest.empty() ? fmt::format("expected one of {}", fmt::join(names, ", "))
                                   : fmt::format("did you mean '{}'?", nearest));
}

}  // namespace

std::vector<std::string> library_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(library_directory(), error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().extension() == ".toml") names.push_back(entry->path().stem().string());
  if (error)
    throw InputError("{}: cannot list the shape library: {}", library_directory().string(), error.message());
  std::sort(names.begin(), names.end());
  return names;
}

bool is_shape_path(const std::string& name_or_path) {
  return name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml");
}

fs::path shape_path(const std::string& name_or_path, const fs::path& base) {
  refuse_mesh(name_or_path);
  return is_shape_path(name_or_path) ? base / name_or_path : library_file(name_or_path);
}

Shape load_shape(const std::string& name_or_path, const fs::path& base) {
  const fs::path path = shape_path(name_or_path, base);
  return parse_shape(read_file(path, path.string(), {.what = "shape file", .most = 64'000'000}),
                     path.string());
}

void save_shape(const Shape& shape, const fs::path& path, bool overwrite) {
  const std::string text = shape_text(shape);
  make_rigid(parse_shape(text, path.string() + " (not written)"), MassModel::mesh);
  write_file(path, text, overwrite);
}

}  // namespace cairn
