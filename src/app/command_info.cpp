#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "app/commands.h"
#include "app/summary.h"
#include "core/build.h"
#include "core/error.h"
#include "io/verify.h"
#include "pile/salvage.h"
#include "sim/run.h"

namespace cairn {

namespace {

struct Options {
  std::filesystem::path file, pile;
  bool verify = false, force = false;
};

std::string megabytes(std::uint64_t bytes) {
  return fmt::format("{:.2f} MB", 1e-6 * static_cast<double>(bytes));
}

void line(const char* name, const std::string& text) {
  fmt::print("  {:<12}{}\n", name, text);
}

/// How far the run has come.
std::string progress(const ResultFile& file) {
  if (file.finished()) return file.outcome();
  Clock clock;
  file.read_checkpoint({{"clock/stage", "", "", &clock.stage},
                        {"clock/step", "", "", &clock.step},
                        {"clock/steps", "", "", &clock.steps},
                        {"clock/stage_start", "", "", &clock.stage_start},
                        {"clock/dt", "", "", &clock.dt}});
  const std::string where =
      clock.steps > 0 ? fmt::format("step {} of {}", clock.step, clock.steps) : std::string("about to begin");
  return fmt::format("unfinished: stage {}, {}, t = {:.6g} s; continue with: cairn resume", clock.stage,
                     where, clock.time());
}

void print_stages(const ResultFile& file) {
  if (!file.has_group("stages")) return;
  std::vector<std::string> names, what;
  file.read_static("stages", {{"name", "", "", &names}, {"what", "", "", &what}});
  for (std::size_t k = 0; k < names.size(); ++k)
    line(k == 0 ? "stages" : "", fmt::format("{} '{}': {}", k, names[k], what[k]));
}

void print_info(const std::filesystem::path& path) {
  const ResultFile file = ResultFile::open(path);
  RunAttributes attributes;
  file.read_attributes(attributes.table());
  fmt::print("{}: {}\n", path.string(), megabytes(std::filesystem::file_size(path)));
  line("title", attributes.title);
  line("program", fmt::format("cairn {} ({})", attributes.version, attributes.build));
  if (attributes.build != build_name())
    line("", fmt::format("this is cairn {} ({})", CAIRN_VERSION, build_name()));
  line("scene", fmt::format("{} bytes, seed {}, files from {}{}", attributes.scene.size(), attributes.seed,
                            attributes.directory,
                            file.scene_is_as_written() ? "" : "; edited since the run has begun"));
  line("state", progress(file));
  print_stages(file);
  std::vector<double> mass;
  std::vector<double> radius;
  file.read_static("bodies", {{"mass", "", "", &mass}});
  file.read_static("spheres", {{"radius", "", "", &radius}});
  line("bodies", fmt::format("{} of {} spheres", mass.size(), radius.size()));
  const auto& snapshots = file.snapshots();
  line("snapshots", snapshots.empty() ? std::string("none")
                                      : fmt::format("{}, t = {:.6g} to {:.6g} s", snapshots.size(),
                                                    snapshots.front().time, snapshots.back().time));
  if (!file.series_columns().empty())
    line("series", fmt::format("{} columns of {} rows", file.series_columns().size(),
                               file.read_series(file.series_columns().front().name).size()));
}

void print_verification(const std::filesystem::path& path) {
  constexpr std::size_t kMostLines = 10;
  const Verification found = verify(path);
  for (std::size_t k = 0; k < std::min(found.damaged.size(), kMostLines); ++k)
    spdlog::warn("{}", found.damaged[k]);
  if (!found.damaged.empty())
    throw InputError("{}: damaged in {} places; what is left: --salvage", path.string(),
                     found.damaged.size());
  line("whole", fmt::format("{} datasets, {}", found.datasets, megabytes(found.bytes)));
  line("digest", found.digest + " (equal results have equal ones)");
}

void info(const Options& options) {
  if (options.pile.empty()) {
    print_info(options.file);
    if (options.verify) print_verification(options.file);
    return;
  }
  const Salvage saved = salvage(options.file, options.pile, options.force);
  if (!saved.lost.empty()) spdlog::warn("{}", saved.lost);
  fmt::print("{}: {} bodies of snapshot {}, t = {:.6g} s, without springs of contacts\n",
             options.pile.string(), saved.bodies, saved.snapshot, saved.time);
}

}  // namespace

void add_info_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("info", "what a result file is, whether it is whole, what can be saved");
  command->add_option("result", options->file, "result file")->required();
  command->add_flag("--verify", options->verify, "read all of it and compare the checksums");
  command->add_option("--salvage", options->pile,
                      "write the last whole snapshot of a damaged file as a pile (pile = FILE) to this file");
  command->add_flag("-f,--force", options->force, "replace an existing file");
  command->callback([options] { info(*options); });
}

}  // namespace cairn
