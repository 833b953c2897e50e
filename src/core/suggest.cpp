#include "core/suggest.h"

#include <algorithm>
#include <utility>

namespace cairn {
namespace {

// Edit distance with neighbouring letters exchanged counted as one edit (optimal string alignment).
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = std::exchange(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  constexpr std::size_t longest_sensible = 64;
  if (name.size() > longest_sensible) return {};
  std::string best;
  std::size_t fewest = longest_sensible;
  for (const std::string& candidate : known) {
    const std::size_t count = edits(name, candidate);
    const std::size_t tolerated = std::max<std::size_t>(1, std::max(name.size(), candidate.size()) / 3);
    if (count > tolerated || count >= fewest) continue;
    best = candidate;
    fewest = count;
  }
  return best;
}

}  // namespace cairn
