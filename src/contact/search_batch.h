// The distance tests of the neighbour search, several at once.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "contact/search.h"
#include "contact/search_level.h"

namespace cairn::search {

constexpr std::size_t kLanes = 8;  // doubles of the widest vector

struct Found {
  std::vector<std::uint64_t> pairs;  // i << 32 | j; the first `count` are valid
  std::size_t count = 0;

  std::span<const std::uint64_t> valid() const { return {pairs.data(), count}; }
};

// What a group of spheres has to be tested against, laid out for vector arithmetic.
struct Candidates {
  std::vector<double> x, y, z, radius;
  std::vector<std::uint32_t> id, body;
  std::vector<std::uint64_t> hit;
  std::size_t count = 0;

  void add(std::span<const Entry> entries) {
    if (x.size() < count + entries.size() + kLanes) resize(2 * (count + entries.size()) + kLanes);
    for (const Entry& e : entries) {
      x[count] = e.position.x();
      y[count] = e.position.y();
      z[count] = e.position.z();
      radius[count] = e.radius;
      id[count] = e.id;
      body[count] = e.body;
      ++count;
    }
  }

  // Appends the pairs of a sphere with the candidates from `first` on.
  void test(const Entry& sphere, std::size_t first, double gap, Found& found) {
    const double px = sphere.position.x(), py = sphere.position.y(), pz = sphere.position.z();
    const double own_radius = sphere.radius;
    const double* __restrict cx = x.data(), * __restrict cy = y.data(), * __restrict cz = z.data();
    const double* __restrict cr = radius.data();
    std::uint64_t* __restrict flag = hit.data();
    // Whole vectors: the flags beyond the last candidate are not read as hits.
    const std::size_t end = first + (count - first + kLanes - 1) / kLanes * kLanes;
    for (std::size_t c = first; c < end; ++c)
      flag[c] = closer_than(px - cx[c], py - cy[c], pz - cz[c], (own_radius + cr[c]) + gap);
    for (std::size_t c = first; c < count; c += kLanes) {
      std::uint64_t any = 0;
      for (std::size_t k = c; k < c + kLanes; ++k) any |= flag[k];
      if (any == 0) continue;
      if (found.pairs.size() < found.count + kLanes) found.pairs.resize(2 * found.count + kLanes);
      for (std::size_t k = c; k < std::min(c + kLanes, count); ++k) {
        const auto [i, j] = std::minmax(sphere.id, id[k]);
        found.pairs[found.count] = (std::uint64_t{i} << 32) | j;
        found.count +=
            flag[k] & static_cast<std::uint64_t>(body[k] != sphere.body);  // a coin toss: no branch
      }
    }
  }

 private:
  void resize(std::size_t size) {
    for (auto* values : {&x, &y, &z, &radius}) values->resize(size);
    id.resize(size);
    body.resize(size);
    hit.resize(size);
  }
};

}  // namespace cairn::search
