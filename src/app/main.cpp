// cairn: rubble piles of glued-sphere grains. Exit codes: 0 done, 2 bad input or unusable file, 3 the physics
// left its bounds, 130 interrupted.
#include <fmt/ranges.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <sstream>
#include <string_view>

#include "app/commands.h"
#include "app/run_loop.h"
#include "app/standard_streams.h"
#include "core/build.h"
#include "core/error.h"
#include "core/file_descriptor.h"
#include "core/instruction_set.h"
#include "core/runtime.h"
#include "io/options.h"

namespace {

std::string version_text() {
  return fmt::format("{}\nbuild: {}\ninstruction set: {} of {}", CAIRN_VERSION, cairn::build_name(),
                     cairn::instruction_set(), fmt::join(cairn::instruction_sets(), ", "));
}

/// Parses the command line and does what it asks for.
int run(CLI::App& app, int argc, char** argv) {
  const auto say = [](std::string_view what) { spdlog::error("{}", cairn::printable(what, 4096)); };
  try {
    cairn::obey_environment();
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // help and version
      std::ostringstream text;
      app.exit(error, text, text);
      fmt::print("{}", text.str());
      return 0;
    }
    say(fmt::format("{} (see cairn --help)", error.what()));
    return 2;
  } catch (const cairn::Interrupted&) {
    return 130;
  } catch (const cairn::UnstableError& error) {
    say(error.what());
    return 3;
  } catch (const std::bad_alloc&) {
    say("not enough memory");
    return 2;
  } catch (const std::exception& error) {
    say(error.what());
    return 2;
  }
}

/// Whether the command leaves a file, and what it prints only reports on that.
bool leaves_a_file(const CLI::App& app) {
  constexpr std::array<std::string_view, 6> kNames{"build", "run", "resume", "render", "xdmf", "fit"};
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return std::ranges::find(kNames, command->get_name()) != kNames.end();
}

/// The exit code, when what was to be printed may not have arrived.
int end(int code, const CLI::App& app) {
  const cairn::OutputEnd output = cairn::end_of_output();
  if (output.error == 0 || code != 0) return code;
  if (output.ask_for_signal) {  // as with any program whose reader has seen enough
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  if (output.was_closed && leaves_a_file(app)) {
    spdlog::warn("standard output is closed: what this command reports has not been shown");
    return code;
  }
  spdlog::error("standard output: {}", output.was_closed ? "is closed" : cairn::reason(output.error));
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (!cairn::processor_suffices()) {
    std::fputs("error: this processor lacks SSE4.2, which cairn needs\n", stderr);
    return 2;
  }
  cairn::tune_runtime(argv);
  // Before stderr is guarded, behind which no terminal for colours would be seen.
  spdlog::set_default_logger(spdlog::stderr_color_st("cairn"));
  spdlog::set_pattern("%^%l%$: %v");
  cairn::guard_standard_streams();
  CLI::App app{"Rubble piles of glued-sphere grains: contacts, self-gravity, spin-up.", "cairn"};
  app.set_version_flag("--version", version_text);
  app.add_option_function<std::string>("--instruction-set", cairn::use_instruction_set,
                                       "run on this one of the processor's; also CAIRN_INSTRUCTION_SET")
      ->trigger_on_parse()
      ->type_name(fmt::format("{}", fmt::join(cairn::instruction_sets(), "|")));
  app.require_subcommand(1);
  cairn::add_shape_commands(app);
  cairn::add_check_command(app);
  cairn::add_run_commands(app);
  cairn::add_render_command(app);
  cairn::add_summary_command(app);
  cairn::add_info_command(app);
  cairn::add_xdmf_command(app);
  return end(run(app, argc, argv), app);
}
