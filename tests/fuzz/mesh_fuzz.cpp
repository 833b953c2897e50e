// Mesh files: whatever the bytes, reading ends with finite triangles or with one line of complaint.
// The first byte of an input chooses the format: 0 OBJ, 1 OFF, 2 PLY, 3 STL (a digit will do), 4 and 5 what
// the text says itself, a table of numbers for instance.
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/error.h"
#include "shape/mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr const char* kinds[] = {"obj", "off", "ply", "stl", "tab", "txt"};
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    const cairn::TriangleMesh mesh = cairn::parse_mesh(bytes, kinds[data[0] % 6], "fuzz", 1.0);
    if (mesh.triangles.empty()) std::abort();
    for (const cairn::Vec3& x : mesh.vertices)
      if (!x.allFinite()) std::abort();
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner >= mesh.vertices.size()) std::abort();
  } catch (const cairn::InputError& error) {
    const std::string what = error.what();
    if (!what.starts_with("fuzz:") || what.find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
