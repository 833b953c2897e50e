// The sub-commands of the program. Each registers its options with the parser and returns what to run.
#pragma once

#include <CLI/CLI.hpp>

namespace cairn {

void add_shape_commands(CLI::App& app);
void add_check_command(CLI::App& app);
void add_run_commands(CLI::App& app);
void add_render_command(CLI::App& app);
void add_summary_command(CLI::App& app);
void add_xdmf_command(CLI::App& app);
void add_info_command(CLI::App& app);

}  // namespace cairn
