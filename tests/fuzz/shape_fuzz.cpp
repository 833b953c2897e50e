// Shape files: whatever the bytes, reading ends with a shape or with one line of complaint.
#include <cstdlib>
#include <string>
#include <string_view>

#include "core/error.h"
#include "shape/shape_file.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  try {
    cairn::parse_shape(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.toml");
  } catch (const cairn::InputError& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
