#include "shape/mesh_file/other_formats.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstring>

#include "core/apart.h"
#include "core/error.h"

namespace cairn {
namespace {

constexpr const char* kKinds[] = {"gltf", "glb", "fbx", "dae", "zae", "3mf",  "amf",
                                  "3ds",  "x3d", "lwo", "ac",  "dxf", "blend"};

template <class T>
void pack(std::string& to, const std::vector<T>& values) {
  const std::uint64_t bytes = values.size() * sizeof(T);
  to.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
  to.append(reinterpret_cast<const char*>(values.data()), bytes);
}

template <class T>
std::vector<T> unpack(std::string_view& from) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, from.data(), sizeof bytes);
  std::vector<T> values(bytes / sizeof(T));
  if (bytes > 0) std::memcpy(values.data(), from.data() + sizeof bytes, bytes);
  from.remove_prefix(sizeof bytes + bytes);
  return values;
}

/// What is said of a file that assimp refuses: the first line of its message, safe to print, unless that
/// tells of its own insides only.
std::string complaint(std::string_view text, const std::string& kind) {
  const std::string what = fmt::format("truncated or no .{} file", kind);
  if (text.empty() || text.find("$$$") != text.npos || text.find("::") != text.npos) return what;
  std::string line(text.substr(0, std::min<std::size_t>(text.find('\n'), 200)));
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  return fmt::format("{}: {}", what, line);
}

/// Vertices, corners and ends of the facets of a file as assimp reads them, packed.
std::string import(const std::string& path, const std::string& kind) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_PreTransformVertices);
  if (!scene) throw InputError("{}", complaint(importer.GetErrorString(), kind));
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::uint32_t> corners, ends;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v)
      vertices.push_back({part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z});
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices < 3) continue;  // points and lines
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        if (face.mIndices[k] >= part.mNumVertices)
          throw InputError("facet {} has a vertex that does not exist", ends.size() + 1);
        corners.push_back(first + face.mIndices[k]);
      }
      ends.push_back(static_cast<std::uint32_t>(corners.size()));
    }
  }
  std::string out;
  pack(out, vertices);
  pack(out, corners);
  pack(out, ends);
  return out;
}

}  // namespace

bool is_other_format(const std::string& kind) {
  return std::find(std::begin(kKinds), std::end(kKinds), kind) != std::end(kKinds);
}

FileSurface read_other_format(const std::filesystem::path& path, const std::string& kind) {
  const std::string name = path.string();
  // Broken files make assimp 5.2 write beyond its memory, hang, or ask for any amount of it.
  const std::string packed = naming(name, [&] {
    try {
      return run_apart([&] { return import(name, kind); });
    } catch (const BrokeDown&) {
      throw InputError("{}", complaint("", kind));
    }
  });
  std::string_view rest = packed;
  FileSurface surface;
  for (const auto& [x, y, z] : unpack<std::array<float, 3>>(rest)) surface.vertices.push_back({x, y, z});
  surface.corners = unpack<std::uint32_t>(rest);
  surface.ends = unpack<std::uint32_t>(rest);
  surface.rounding = kSingleRounding;
  surface.notes.push_back(
      "read by the assimp library, in single precision; it does not tell of what it leaves out or of the "
      "unit: "
      "compare volume and extent with what the file should hold");
  return surface;
}

}  // namespace cairn
