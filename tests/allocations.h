// Counts allocations of the whole program, and lets one fail when asked to. To be included in one file of an
// executable. The address sanitizer wants its own operators: with it nothing is counted.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

namespace cairn {
inline std::atomic<long> g_allocations{0};
inline std::atomic<long> g_failing{-1};  ///< number of the allocation that fails; negative: none does

inline void* allocate(std::size_t size) {
  return g_allocations++ == g_failing ? nullptr : std::malloc(size);
}
}  // namespace cairn

#ifndef __SANITIZE_ADDRESS__
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // both replacements are here

void* operator new(std::size_t size) {
  if (void* p = cairn::allocate(size)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return cairn::allocate(size);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
#endif
