// Counts allocations of the whole program. To be included in one file of an executable. The address sanitizer
// wants its own operators: with it nothing is counted.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

namespace cairn {
inline std::atomic<long> g_allocations{0};
}

#ifndef __SANITIZE_ADDRESS__
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // both replacements are here

void* operator new(std::size_t size) {
  ++cairn::g_allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++cairn::g_allocations;
  return std::malloc(size);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
#endif
