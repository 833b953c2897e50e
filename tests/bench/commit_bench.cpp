// What commits of a long run cost: ./bench_commit FILE SPHERES SNAPSHOTS [copy]
// Snapshots as those of loose spheres, one and a checkpoint in each commit; ten lines of wall-clock time and
// bytes written. With `copy` somebody reads every version, so that each one is a copy of the whole.
#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <utility>

#include "core/timer.h"
#include "io/results.h"

namespace cairn {
namespace {

/// Bytes that this process has handed to files.
double written() {
  std::ifstream in("/proc/self/io");
  std::string name;
  for (double value = 0.0; in >> name >> value;)
    if (name == "wchar:") return value;
  return 0.0;
}

void run(const std::filesystem::path& path, std::size_t spheres, std::size_t snapshots, bool copy) {
  std::vector<Vec3> x(spheres, Vec3::Ones()), v = x, spin = x, rest(7 * spheres, Vec3::Ones());
  std::vector<Quat> q(spheres, Quat::Identity());
  std::vector<Vec3f> shown(spheres, Vec3f::Ones()), moving = shown;
  std::vector<std::uint16_t> touching(spheres, 6);
  std::vector<std::uint8_t> remnant(spheres, 1);
  const std::vector<double> row(45, 1.0);
  std::vector<SeriesColumn> columns;
  for (std::size_t c = 0; c < row.size(); ++c)
    columns.push_back({fmt::format("column{}", c), "s", "one of many"});
  ResultFile file = ResultFile::create(path, {}, true);
  file.declare_series(columns);
  FileDescriptor last, before;
  double start = wall_seconds(), bytes = written();
  for (std::size_t k = 1; k <= snapshots; ++k) {
    x[0].x() = static_cast<double>(k);
    file.add_series_row(row);
    file.add_snapshot(static_cast<double>(k), "s",
                      {{"position", "m", "", &x, "body"},
                       {"velocity", "m/s", "", &v, "body"},
                       {"orientation", "", "", &q, "body"},
                       {"angular_momentum", "kg m^2/s", "", &spin, "body"},
                       {"remnant", "", "", &remnant, "body"},
                       {"sphere_position", "m", "", &shown, "sphere"},
                       {"sphere_velocity", "m/s", "", &moving, "sphere"},
                       {"sphere_contacts", "", "", &touching, "sphere"}});
    file.commit({{"position", "", "", &x}, {"velocity", "", "", &v}, {"rest", "", "", &rest}});
    if (copy) {
      before = std::move(last);
      last = open_for_reading(path);
    }
    if (k % std::max<std::size_t>(1, snapshots / 10) != 0) continue;
    const double now = wall_seconds(), all = written();
    fmt::print("{:>7} snapshots {:>9.1f} MB {:>9.2f} s {:>9.1f} MB written\n", k,
               1e-6 * static_cast<double>(std::filesystem::file_size(path)), now - start,
               1e-6 * (all - bytes));
    std::fflush(stdout);
    start = now;
    bytes = all;
  }
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "bench_commit FILE SPHERES SNAPSHOTS [copy]\n");
    return 2;
  }
  cairn::run(argv[1], std::strtoul(argv[2], nullptr, 10), std::strtoul(argv[3], nullptr, 10), argc > 4);
}
