// Scene files: whatever the bytes, parsing ends with a scene or with one line of complaint.
#include <cstdlib>
#include <string>

#include "core/error.h"
#include "io/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  try {
    cairn::parse_scene(std::string(reinterpret_cast<const char*>(data), size), "fuzz.toml", ".");
  } catch (const cairn::InputError& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
