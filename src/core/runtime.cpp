#include "core/runtime.h"

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace cairn {

void tune_runtime(char** argv) {
  const auto value = [](const char* name) {
    const char* set = std::getenv(name);
    return std::string(set != nullptr ? set : "");
  };
  bool changed = false;
  const auto set = [&](const char* name, const std::string& to) {
    changed |= setenv(name, to.c_str(), 1) == 0;
  };
  const std::string tunables = value("GLIBC_TUNABLES");
  if (tunables.find("glibc.malloc.hugetlb") == std::string::npos)
    set("GLIBC_TUNABLES", (tunables.empty() ? "" : tunables + ":") + "glibc.malloc.hugetlb=1");
  if (value("GOMP_SPINCOUNT").empty() && value("OMP_WAIT_POLICY").empty()) set("GOMP_SPINCOUNT", "1000");
  if (changed) execv("/proc/self/exe", argv);
}

}  // namespace cairn
