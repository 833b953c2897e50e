#include <fmt/core.h>

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "app/arguments.h"
#include "app/commands.h"
#include "app/run_loop.h"
#include "app/summary.h"
#include "core/build.h"
#include "core/error.h"
#include "io/toml_file.h"
#include "io/xdmf.h"
#include "pile/assemble.h"
#include "pile/operate.h"
#include "pile/outlook.h"
#include "sim/extend.h"
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
    for (const std::string& w : setup.warnings) spdlog::warn("{}", w);
    return Run(std::move(scene), std::move(setup), std::move(results), operate);
  });
  for (const std::string& note : run.scene().files.notes()) spdlog::warn("{}", note);
  for (const std::string& w : run.warnings()) spdlog::warn("{}", w);
  const std::vector<std::vector<std::string>> looks_wrong = operation_warnings(run.scene(), run.state());
  for (std::size_t k = 0; k < looks_wrong.size(); ++k)
    for (const std::string& w : looks_wrong[k]) spdlog::warn("stage '{}': {}", run.scene().stages[k].name, w);
  run_to_end(std::move(run));
  print_summary({output});
}

struct ResumeOptions {
  std::filesystem::path result, stages;
  std::optional<double> until;
};

void resume(const ResumeOptions& options) {
  require_sidecar(options.result);
  const bool longer = options.until || !options.stages.empty();
  Continuation more{.until = options.until};
  if (!options.stages.empty()) {
    more.stages = read_text_file(options.stages);
    more.stages_file = options.stages.string();
  }
  run_to_end(longer ? Run::extend(options.result, more, check_operations, operate)
                    : Run::resume(options.result, operate));
  print_summary({options.result});
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
  auto options = std::make_shared<ResumeOptions>();
  CLI::App* command =
      app.add_subcommand("resume", "continue an interrupted run, bitwise as if it had not stopped");
  command->add_option("result", options->result, "result file of the run")->required();
  command
      ->add_option("--until", options->until,
                   "let the last stage end at this time (s) of the run, finished or not, in steps as before")
      ->check(number_from(0.0, 1e15));
  command->add_option("--add", options->stages,
                      "let the [[stage]] tables of this file follow the last stage; paths as in the scene");
  command->callback([options] { resume(*options); });
}

}  // namespace cairn
