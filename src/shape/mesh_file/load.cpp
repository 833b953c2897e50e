// Files of any format into meshes.
#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/read_file.h"
#include "shape/mesh.h"
#include "shape/mesh_file/file_surface.h"
#include "shape/mesh_file/other_formats.h"
#include "shape/mesh_file/text.h"

namespace cairn {
namespace {

constexpr const char* kTables[] = {"tab", "wf", "plt", "ver", "icq"};

std::string extension(const std::filesystem::path& path) {
  std::string name = path.extension().string();
  if (!name.empty()) name.erase(0, 1);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

auto own_reader(const std::string& kind) -> FileSurface (*)(std::string_view, const std::string&) {
  if (kind == "obj") return read_obj;
  if (kind == "ply") return read_ply;
  if (kind == "stl") return read_stl;
  if (kind == "off") return read_off;
  return nullptr;
}

}  // namespace

FileSurface read_unnamed(std::string_view bytes, const std::string& name) {
  if (bytes.substr(0, 4096).find('\0') != bytes.npos)
    throw InputError(
        "{}: a binary file of an unknown kind: expected .obj, .ply, .stl or .off, a table of vertices and "
        "facets, "
        "or .gltf, .glb, .fbx, .dae, .3mf, .3ds and others of that kind",
        name);
  Text text(bytes, name, {});
  if (!text.next_line()) throw InputError("{}: holds nothing but blanks", name);
  const std::string_view word = text.word();
  const std::string_view obj_words[] = {"v", "vn", "vt", "f", "g", "o", "s", "mtllib", "usemtl"};
  if (std::find(std::begin(obj_words), std::end(obj_words), word) != std::end(obj_words))
    return read_obj(bytes, name);
  if (word == "ply") return read_ply(bytes, name);
  if (word.ends_with("OFF")) return read_off(bytes, name);
  if (word == "solid") return read_stl(bytes, name);
  if (word.find_first_of("0123456789") <= 2 && word.find_first_not_of("0123456789+-.,eEdD") == word.npos)
    return read_table(bytes, name);
  text.fail("expected a mesh (the text of an OBJ, PLY, STL or OFF file, or a table of numbers), found {}",
            in_quotes(word));
}

std::string mesh_kind(const std::filesystem::path& path) {
  const std::string kind = extension(path);
  const bool known = own_reader(kind) || is_other_format(kind) ||
                     std::find(std::begin(kTables), std::end(kTables), kind) != std::end(kTables);
  return known ? kind : "";
}

TriangleMesh parse_mesh(std::string_view bytes, const std::string& kind, const std::string& name, double unit,
                        Welding* welding) {
  if (bytes.empty()) throw InputError("{}: the file is empty", name);
  const auto reader = own_reader(kind);
  return make_mesh(reader ? reader(bytes, name) : read_unnamed(bytes, name), name, unit, welding);
}

TriangleMesh load_mesh(const std::filesystem::path& path, double unit, Welding* welding) {
  const std::string name = path.string(), kind = extension(path);
  constexpr const char* what = "mesh file";
  if (is_other_format(kind)) {
    require_regular(path, name, what);
    return make_mesh(read_other_format(path, kind), name, unit, welding);
  }
  return parse_mesh(read_file(path, name, {.what = what}), kind, name, unit, welding);
}

}  // namespace cairn
