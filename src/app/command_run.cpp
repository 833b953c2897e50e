#include <fmt/core.h>

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "app/commands.h"
#include "app/run_loop.h"
#include "app/summary.h"
#include "core/build.h"
#include "core/error.h"
#include "io/xdmf.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "sim/run.h"

namespace cairn {

namespace {

struct Options {
  std::filesystem::path scene, output;
  bool force = false;
};

void start(const Options& options) {
  Scene scene = load_scene(options.scene);
  const std::filesystem::path output =
      options.output.empty() ? std::filesystem::path(options.scene.stem().string() + ".h5") : options.output;
  RunAttributes attributes{.title = scene.title,
                           .scene = scene.text,
                           .directory = std::filesystem::absolute(scene.directory).string(),
                           .version = CAIRN_VERSION,
                           .build = build_name(),
                           .seed = scene.seed};
  std::error_code none;
  if (!scene.pile.empty() && std::filesystem::equivalent(scene.pile, output, none))
    throw InputError("{}: the scene starts from this file; give the result another name", output.string());
  ResultFile results = ResultFile::create(output, attributes.table(), options.force);
  require_sidecar(output);
  Run run = naming(options.scene.string(), [&] {
    Setup setup = assemble(scene);
    return Run(std::move(scene), std::move(setup), std::move(results), operate);
  });
  for (const std::string& w : run.warnings()) spdlog::warn("{}", w);
  run_to_end(std::move(run));
  print_summary({output});
}

void resume(const Options& options) {
  require_sidecar(options.output);
  Run run = Run::resume(options.output, operate);
  run_to_end(std::move(run));
  print_summary({options.output});
}

CLI::App* add_start(CLI::App& app, const char* name, const char* help) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(name, help);
  command->add_option("scene", options->scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", options->output,
                      "result file (HDF5); default: the scene's name with .h5");
  command->add_flag("-f,--force", options->force, "replace an existing result file");
  command->callback([options] { start(*options); });
  return command;
}

}  // namespace

void add_run_commands(CLI::App& app) {
  add_start(app, "build",
            "make a pile: run the stages of a scene, for other scenes to start from (pile = FILE)");
  add_start(app, "run", "run a scene: progress, checkpoints, results; Ctrl-C leaves a file to resume");
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("resume", "continue an interrupted run, bitwise as if it had not stopped");
  command->add_option("result", options->output, "result file of the run")->required();
  command->callback([options] { resume(*options); });
}

}  // namespace cairn
