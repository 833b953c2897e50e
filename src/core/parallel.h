// The parallel loop. Work is cut into blocks that do not depend on the number of threads, and sums add the
// blocks in order: every result is bitwise the same for any number of threads.
#pragma once

#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <exception>
#include <vector>

namespace cairn {

/// Lets loops run on as many threads as the work pays for, at most what OMP_NUM_THREADS or the machine
/// allows: one for each thousand spheres.
inline void use_threads_for(std::size_t spheres) {
  static const auto most = static_cast<std::size_t>(omp_get_max_threads());
  omp_set_num_threads(static_cast<int>(std::clamp<std::size_t>(spheres / 1000, 1, most)));
}

/// Calls body(begin, end) over [0, count) in blocks of `block`; blocks may run in any order and at once. Each
/// thread begins with a part of its own, the same every time, which then is in its cache, and helps others
/// when it is done. The first exception thrown by a block is rethrown.
template <class Body>
void parallel_blocks(std::size_t count, std::size_t block, Body&& body) {
  constexpr std::size_t kMostParts = 64;
  const std::size_t parts = std::min(static_cast<std::size_t>(omp_get_max_threads()), kMostParts);
  if (count <= block || parts == 1) {  // a parallel region costs a microsecond even for one
    for (std::size_t begin = 0; begin < count; begin += block) body(begin, std::min(begin + block, count));
    return;
  }
  struct alignas(64) Part {
    std::atomic<std::size_t> next;
    std::size_t end;
  };
  std::array<Part, kMostParts> part;
  const std::size_t blocks = (count + block - 1) / block;
  for (std::size_t p = 0; p < parts; ++p) {
    part[p].next.store(p * blocks / parts, std::memory_order_relaxed);
    part[p].end = (p + 1) * blocks / parts;
  }
  std::exception_ptr error;
#pragma omp parallel
  for (std::size_t k = 0; k < parts; ++k) {
    Part& from = part[(static_cast<std::size_t>(omp_get_thread_num()) + k) % parts];
    for (;;) {
      const std::size_t begin = from.next.fetch_add(1, std::memory_order_relaxed) * block;
      if (begin >= from.end * block) break;
      try {
        body(begin, std::min(begin + block, count));
      } catch (...) {
#pragma omp critical(cairn_parallel_error)
        if (!error) error = std::current_exception();
      }
    }
  }
  if (error) std::rethrow_exception(error);
}

/// Calls body(i) for i in [0, count).
template <class Body>
void parallel_for(std::size_t count, Body&& body) {
  parallel_blocks(count, 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Sum of term(begin, end) over the blocks of [0, count), added in a fixed order. `zero` is the additive
/// identity.
template <class Value, class Term>
Value parallel_block_sum(std::size_t count, std::size_t block, Value zero, Term&& term) {
  static thread_local std::vector<Value> kept;  // a step allocates nothing
  std::vector<Value>& partial = kept;           // of the calling thread, in all of them
  partial.assign((count + block - 1) / block, zero);
  parallel_blocks(count, block,
                  [&](std::size_t begin, std::size_t end) { partial[begin / block] = term(begin, end); });
  Value total = zero;
  for (const Value& p : partial) total += p;
  return total;
}

/// Sum of term(i) over [0, count), added in a fixed order.
template <class Value, class Term>
Value parallel_sum(std::size_t count, Value zero, Term&& term) {
  return parallel_block_sum(count, 512, zero, [&](std::size_t begin, std::size_t end) {
    Value sum = zero;
    for (std::size_t i = begin; i < end; ++i) sum += term(i);
    return sum;
  });
}

}  // namespace cairn
