#include "io/track_rows.h"

#include <charconv>
#include <cmath>

#include "core/error.h"
#include "gravity/track.h"
#include "io/options.h"

namespace cairn {

void check_track(const TrackRows& rows, double duration,
                 const std::function<void(std::size_t, const std::string&)>& fail) {
  const bool hermite = !rows.empty() && rows[0].size() == 7;
  const std::size_t least = hermite ? gravity::Track::kLeastHermite : gravity::Track::kLeastSpline;
  if (rows.size() < least)
    fail(rows.size(), fmt::format("expected at least {} rows{}, found {}", least,
                                  hermite ? "" : " without velocities", rows.size()));
  for (std::size_t k = 1; k < rows.size(); ++k)
    if (!(rows[k][0] > rows[k - 1][0]))
      fail(k, fmt::format("expected a time after {} s, found {}", show(rows[k - 1][0]), show(rows[k][0])));
  if (rows.front()[0] > 0.0 || rows.back()[0] < duration)
    fail(rows.size(), fmt::format("expected times that cover the run, 0 to {} s, found {} to {} s",
                                  show(duration), show(rows.front()[0]), show(rows.back()[0])));
}

TrackRows parse_track(std::string_view text, const std::string& file, double duration) {
  TrackRows rows;
  std::vector<std::size_t> lines;
  std::size_t line = 0;
  const auto fail = [&](std::size_t where, const std::string& what) {
    throw InputError("{}:{}: {}", file, where, what);
  };
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view rest = text.substr(begin, end - begin);
    rest = rest.substr(0, rest.find('#'));
    begin = end + 1;
    ++line;
    std::vector<double> row;
    for (;;) {
      const std::size_t first = rest.find_first_not_of(" \t\r,");
      if (first == rest.npos) break;
      rest.remove_prefix(first);
      const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r,"));
      const std::string_view digits = word.substr(word.starts_with('+') ? 1 : 0);
      double number = 0.0;
      const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
      if (error != std::errc{} || stop != digits.data() + digits.size() || !(std::abs(number) <= 1e15))
        fail(line, fmt::format("expected a number of at most 1e15, found '{}'", printable(word, 40)));
      row.push_back(number);
      rest.remove_prefix(word.size());
    }
    if (row.empty()) continue;
    const std::size_t width = rows.empty() ? row.size() : rows[0].size();
    if ((width != 4 && width != 7) || row.size() != width)
      fail(line, fmt::format("expected a row of {} numbers, found {}",
                             rows.empty() ? "4 or 7" : fmt::format("{}", width), row.size()));
    rows.push_back(std::move(row));
    lines.push_back(line);
  }
  check_track(rows, duration, [&](std::size_t row, const std::string& what) {
    fail(row < rows.size() ? lines[row] : std::max<std::size_t>(line, 1), what);
  });
  return rows;
}

}  // namespace cairn
