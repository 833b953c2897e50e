// What the memory allocator and the thread pool are told before the program begins.
#pragma once

namespace cairn {

/// Starts the program again with what glibc and libgomp read from the environment at their start, where the
/// user has not set it:
/// * GLIBC_TUNABLES glibc.malloc.hugetlb=1: arrays lie in pages of 2 MB where the kernel has them on request.
///   A dense pile walks through tens of megabytes in every step, and a tenth of its time goes into finding
///   pages. glibc.malloc.mmap_threshold=4194304: the arrays of many spheres go back to the system when they
///   are freed (left to itself, glibc keeps up to 32 MB of each).
/// * GOMP_SPINCOUNT 1000: threads that wait for others give their core away after some microseconds, not
///   milliseconds. Beside other jobs two threads are ten times slower without it.
/// To be called first in main; it returns when all is set, or cannot be.
void tune_runtime(char** argv);

}  // namespace cairn
