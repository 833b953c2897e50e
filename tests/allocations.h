// Counts allocations of the whole program. To be included in one file of an executable.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // both replacements are here

namespace cairn {
inline std::atomic<long> g_allocations{0};
}

void* operator new(std::size_t size) {
  ++cairn::g_allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
