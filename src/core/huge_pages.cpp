#include "core/huge_pages.h"

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace cairn {

void use_huge_pages(char** argv) {
  const char* set = std::getenv("GLIBC_TUNABLES");
  const std::string tunables = set != nullptr ? set : "";
  if (tunables.find("glibc.malloc.hugetlb") != std::string::npos) return;
  const std::string wanted = (tunables.empty() ? "" : tunables + ":") + "glibc.malloc.hugetlb=1";
  if (setenv("GLIBC_TUNABLES", wanted.c_str(), 1) == 0) execv("/proc/self/exe", argv);
}

}  // namespace cairn
