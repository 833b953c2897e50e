#include "core/runtime.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

namespace cairn {

void tune_runtime(char** argv) {
  const auto value = [](const char* name) {
    const char* set = std::getenv(name);
    return std::string(set != nullptr ? set : "");
  };
  constexpr const char* kDone = "CAIRN_TUNED";  // where a value cannot be set, it is not tried again
  if (!value(kDone).empty()) return;
  const auto set = [](const char* name, const std::string& to) { setenv(name, to.c_str(), 1); };
  set(kDone, "1");
  for (const auto& [name, to] :
       {std::pair("glibc.malloc.hugetlb", "1"), {"glibc.malloc.mmap_threshold", "4194304"}}) {
    const std::string tunables = value("GLIBC_TUNABLES");
    if (tunables.find(name) == std::string::npos)
      set("GLIBC_TUNABLES", (tunables.empty() ? "" : tunables + ":") + name + "=" + to);
  }
  if (value("GOMP_SPINCOUNT").empty() && value("OMP_WAIT_POLICY").empty()) set("GOMP_SPINCOUNT", "1000");
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string name = program.filename().string();
  const bool loader = name.starts_with("ld-") || name.starts_with("ld.");
  if (!error && !loader) execv(program.c_str(), argv);
}

}  // namespace cairn
