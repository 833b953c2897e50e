// cairn: rubble piles of glued-sphere grains. Exit codes: 0 done, 2 bad input or unusable file, 3 the physics
// left its bounds, 130 interrupted.
#include <fmt/core.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "app/commands.h"
#include "app/run_loop.h"
#include "core/error.h"
#include "core/runtime.h"

int main(int argc, char** argv) {
  cairn::tune_runtime(argv);
  spdlog::set_default_logger(spdlog::stderr_color_st("cairn"));
  spdlog::set_pattern("%^%l%$: %v");
  CLI::App app{"Rubble piles of glued-sphere grains: contacts, self-gravity, spin-up.", "cairn"};
  app.set_version_flag("--version", CAIRN_VERSION);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return fmt::format("error: {} (see cairn --help)\n", error.what());
  });
  cairn::add_shape_commands(app);
  cairn::add_check_command(app);
  cairn::add_run_commands(app);
  cairn::add_render_command(app);
  cairn::add_summary_command(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const cairn::Interrupted&) {
    return 130;
  } catch (const cairn::InputError& error) {
    spdlog::error("{}", error.what());
    return 2;
  } catch (const cairn::UnstableError& error) {
    spdlog::error("{}", error.what());
    return 3;
  } catch (const std::bad_alloc&) {
    spdlog::error("not enough memory");
    return 2;
  }
}
