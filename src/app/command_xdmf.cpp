#include <fmt/core.h>

#include "app/commands.h"
#include "io/xdmf.h"

namespace cairn {

void add_xdmf_command(CLI::App& app) {
  auto results = std::make_shared<std::vector<std::filesystem::path>>();
  CLI::App* command = app.add_subcommand(
      "xdmf", "make the sidecars anew by which ParaView opens result files, as after renaming them");
  command->add_option("results", *results, "result files")->required();
  command->callback([results] {
    for (const std::filesystem::path& result : *results)
      fmt::print("wrote {}\n", Sidecar().write(ResultFile::open(result)).string());
  });
}

}  // namespace cairn
