#include "core/build.h"

#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/instruction_set.h"

namespace cairn {
namespace {

constexpr const char* compiler() {
#ifdef __clang__
  return "Clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

/// The first bytes of the program's build ID, a note that the linker leaves in it.
int find_build_id(dl_phdr_info* object, std::size_t, void* text) {
  for (int k = 0; k < object->dlpi_phnum; ++k) {
    const ElfW(Phdr)& segment = object->dlpi_phdr[k];
    if (segment.p_type != PT_NOTE) continue;
    const auto* at = reinterpret_cast<const std::uint8_t*>(object->dlpi_addr + segment.p_vaddr);
    const std::uint8_t* const end = at + segment.p_memsz;
    ElfW(Nhdr) note;
    while (at + sizeof note <= end) {
      std::memcpy(&note, at, sizeof note);
      const std::uint8_t* const content = at + sizeof note + (note.n_namesz + 3u) / 4u * 4u;
      if (note.n_type == NT_GNU_BUILD_ID && content + note.n_descsz <= end)
        for (std::size_t b = 0; b < std::min<std::size_t>(note.n_descsz, 8); ++b)
          *static_cast<std::string*>(text) += fmt::format("{:02x}", content[b]);
      at = content + (note.n_descsz + 3u) / 4u * 4u;
    }
  }
  return 1;  // the first object is the program; libraries do not count
}

}  // namespace

std::string build_name() {
  std::string id;
  dl_iterate_phdr(find_build_id, &id);
  return fmt::format("{}, {}, {}", compiler(), promise_of_bits(), id.empty() ? "no build ID" : id);
}

}  // namespace cairn
