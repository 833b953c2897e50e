#include "pile/pile_file.h"

#include <algorithm>

#include "core/error.h"
#include "io/results.h"
#include "sim/check_state.h"
#include "sim/fields.h"

namespace cairn {

namespace {

/// What a damaged or edited file could get wrong; errors lack the file's name.
void check_pile(const State& state, std::size_t materials, const ContactColumns& contacts) {
  check_motion(state.bodies, materials);
  check_contacts(contacts, state.bodies);
  if (!(state.box.edge.minCoeff() >= 0.0 && state.k_n >= 0.0 && state.region_volume >= 0.0))
    throw InputError("checkpoint: box, stiffness, region_volume: expected 0 or more");
}

/// Numbers in `materials` of the file's materials.
std::vector<std::uint16_t> match(const std::vector<std::string>& names,
                                 const std::vector<Material>& materials) {
  std::vector<std::uint16_t> numbers;
  for (const std::string& name : names) {
    const auto it =
        std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == name; });
    if (it == materials.end())
      throw InputError("its material '{}' is not in the scene; add such a [[material]]", name);
    numbers.push_back(static_cast<std::uint16_t>(it - materials.begin()));
  }
  return numbers;
}

}  // namespace

Setup read_pile(const std::filesystem::path& path, const std::vector<Material>& materials) {
  const ResultFile file = ResultFile::open(path);
  if (file.outcome() != kFinished)
    throw InputError("{}: the run has not finished; a pile comes from a finished one", path.string());
  State state;
  ContactColumns contacts;
  WallColumns walls;
  Setup setup;
  std::vector<std::string> names;
  read_constants(file, state.bodies, setup.shapes);
  file.read_static("materials", {{"name", "", "", &names}});
  // A pile is its bodies and their contacts, whatever version of the program has made it, and how.
  FieldTable fields = checkpoint_fields(state, contacts.table(), walls);
  const std::vector<DatasetInfo> there = file.list("checkpoint");
  const bool volume = std::ranges::find(there, "region_volume", &DatasetInfo::name) != there.end();
  std::erase_if(fields, [&](const Field& field) {
    const auto within = [&](std::string_view group) {
      return std::string_view(field.name).starts_with(group);
    };
    return within("gravity/") || within("control/") || within("ledger/") || within("walls/") ||
           within("wall_loads/") || within("clock/stage_starts") || (!volume && within("region_volume"));
  });
  file.read_checkpoint(fields);
  try {
    if (const std::string what = not_finite(fields); !what.empty())
      throw InputError("checkpoint/{}: not finite", what);
    check_pile(state, names.size(), contacts);
    // Only materials that bodies have are asked of the scene; those of single stages or walls are not.
    std::vector<std::uint16_t> used = state.bodies.material;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<std::string> asked;
    for (std::uint16_t m : used) asked.push_back(names[m]);
    const std::vector<std::uint16_t> numbers = match(asked, materials);
    for (std::uint16_t& m : state.bodies.material)
      m = numbers[static_cast<std::size_t>(std::lower_bound(used.begin(), used.end(), m) - used.begin())];
  } catch (const InputError& error) {
    throw InputError("{}: {}", path.string(), error.what());
  }
  setup.bodies = std::move(state.bodies);
  setup.frame = state.frame;
  setup.frame.position += state.clock.time() * state.frame.velocity;
  setup.box.edge = state.box.edge;
  setup.contacts = contacts.records();
  setup.k_n = state.k_n;
  setup.region_volume = state.region_volume;
  return setup;
}

}  // namespace cairn
