// Memory in huge pages.
#pragma once

namespace cairn {

/// Starts the program again with glibc's tunable `glibc.malloc.hugetlb=1`, where it is not set yet: arrays
/// lie in pages of 2 MB where the kernel has them on request. A dense pile walks through tens of megabytes in
/// every step, and without them a tenth of its time goes into looking up pages. To be called first in main;
/// it returns when the tunable is set, or cannot be.
void use_huge_pages(char** argv);

}  // namespace cairn
