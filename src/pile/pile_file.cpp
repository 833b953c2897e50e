#include "pile/pile_file.h"

#include <algorithm>
#include <optional>
#include <ranges>

#include "core/error.h"
#include "io/results.h"
#include "pile/match_walls.h"
#include "sim/check_state.h"
#include "sim/fields.h"
#include "sim/make_walls.h"
#include "sim/restraints.h"
#include "sim/run.h"
#include "sim/springs.h"

namespace cairn {

namespace {

/// The scene of the run, with the files that it was started with; nothing when it is not to be understood.
std::optional<Scene> former_scene(const ResultFile& file, std::string& why) {
  try {
    RunAttributes attributes;
    file.read_attributes(attributes.table());
    Scene scene = parse_scene(attributes.scene, file.path().string(), attributes.directory);
    scene.files.restore(file);
    return scene;
  } catch (const InputError& error) {
    why = error.what();
    return {};
  }
}

/// Numbers in the scene of the file's materials, by name or else by values; those of bodies must be there.
std::vector<std::uint16_t> match_materials(const std::vector<std::string>& names, const Bodies& bodies,
                                           const std::optional<Scene>& former, const Scene& scene,
                                           std::vector<std::string>& notes) {
  const auto find = [&](auto&& test) -> std::optional<std::uint16_t> {
    const auto it = std::find_if(scene.materials.begin(), scene.materials.end(), test);
    if (it == scene.materials.end()) return {};
    return static_cast<std::uint16_t>(it - scene.materials.begin());
  };
  std::vector<std::uint16_t> numbers(names.size(), 0);
  std::vector<std::uint8_t> used(names.size(), 0);
  for (const std::uint16_t m : bodies.material) used[m] = 1;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!used[k]) continue;
    auto number = find([&](const Material& m) { return m.name == names[k]; });
    if (!number && former && k < former->materials.size()) {
      number = find([&](const Material& m) { return same_values(m, former->materials[k]); });
      if (number)
        notes.push_back(fmt::format("its material '{}' is '{}' here, which has the same values", names[k],
                                    scene.materials[*number].name));
    }
    if (!number)
      throw InputError(
          "its material '{}' is not in the scene, nor one of its values; add such a [[material]]", names[k]);
    numbers[k] = *number;
  }
  return numbers;
}

/// Which of the checkpoint's fields make a pile, whatever version of the program has made it, and how.
FieldTable pile_fields(const ResultFile& file, FieldTable fields) {
  const auto there = [&](const std::string& name) { return file.has_group("checkpoint/" + name); };
  std::erase_if(fields, [&](const Field& field) {
    for (const char* group : {"gravity/", "control/", "ledger/", "wall_loads/", "held/"})
      if (field.name.starts_with(group)) return true;
    for (const char* newer : {"walls/", "clock/stage_starts", "region_volume", "wall_lead", "driven/"})
      if (field.name.starts_with(newer)) return !there(field.name);
    return false;
  });
  return fields;
}

}  // namespace

Setup read_pile(const std::filesystem::path& path, const Scene& scene, const std::vector<Wall>& walls) {
  const ResultFile file = ResultFile::open(path);
  if (file.outcome() != kFinished)
    throw InputError("{}: the run has not finished; a pile comes from a finished one", path.string());
  State state;
  ContactColumns contacts;
  WallColumns touching;
  Setup setup;
  std::vector<std::string> names;
  read_constants(file, state.bodies, setup.shapes);
  file.read_static("materials", {{"name", "", "", &names}});
  read_restraints(file, state.bodies, setup.held, setup.wall_sets);
  const FieldTable fields = pile_fields(file, checkpoint_fields(state, contacts.table(), touching));
  file.read_checkpoint(fields);
  std::string why;
  const std::optional<Scene> former = former_scene(file, why);
  setup.frame = state.frame;
  setup.frame.position += state.clock.time() * state.frame.velocity;
  const auto naming_file = [&](auto&& work) { naming(path.string(), work); };
  const std::size_t materials = former ? std::min(names.size(), former->materials.size()) : names.size();
  naming_file([&] { check_pile(state, materials, contacts, fields); });
  place_spheres(state.bodies);
  setup.contacts = contacts.records();
  if (former) {
    naming_file([&] {
      if (state.clock.stage >= former->stages.size())
        throw InputError("checkpoint: clock/stage: expected a stage of its scene");
      const std::optional<std::size_t> timed = last_timed_stage(*former, state.clock.stage + 1);
      const std::size_t stage = timed.value_or(0);  // as walls are while none has taken time
      FormerStage last{
          resolve_laws(*former, stage, state.bodies, state.k_n), {}, timed == state.clock.stage, stage};
      std::vector<WallContact> none;
      if (timed && state.clock.steps > 0) leave_stiffness(last.physics, state.bodies, setup.contacts, none);
      WallHeritage heritage = match_walls(
          {path.string(), *former, state, last, touching.contacts()}, scene, walls,
          {setup.frame.position - scene.frame.position, setup.frame.velocity - scene.frame.velocity});
      setup.wall_contacts = std::move(heritage.contacts);
      setup.wall_lead = std::move(heritage.lead);
      setup.driven = std::move(heritage.driven);
      setup.notes = std::move(heritage.notes);
      setup.warnings = std::move(heritage.warnings);
      if (!timed) return;
      last.walls = std::move(heritage.ending);
      last.walls.set_laws(last.physics.materials, last.physics.wall_materials, state.k_n);
      setup.former = std::move(last);
    });
  } else if (!touching.sphere.empty()) {
    setup.warnings.push_back(
        fmt::format("the walls of {} cannot be told, its {} contacts with them are dropped: {}",
                    path.string(), touching.sphere.size(), why));
  }
  naming_file([&] {
    const std::vector<std::uint16_t> numbers =
        match_materials(names, state.bodies, former, scene, setup.notes);
    for (std::uint16_t& m : state.bodies.material) m = numbers[m];
  });
  for (const std::string& name : names_of_walls(setup.wall_sets))
    if (!std::ranges::any_of(std::views::iota(std::size_t{0}, scene.walls.size()),
                             [&](std::size_t w) { return wall_name(scene, w) == name; }))
      setup.warnings.push_back(
          fmt::format("bodies of {} touch a wall '{}', which is not in this scene", path.string(), name));
  setup.notes.insert(
      setup.notes.begin(),
      fmt::format(
          "{} bodies with {} contacts at the end of {}, t = {:.6g} s; {} of {} contacts with walls go "
          "on; time, ledgers, spin control and perturbers begin anew",
          state.bodies.size(), contacts.i.size(), path.string(), state.clock.time(),
          setup.wall_contacts.size(), touching.sphere.size()));
  setup.bodies = std::move(state.bodies);
  setup.box.edge = state.box.edge;
  setup.k_n = state.k_n;
  for (WallMotion& motion : setup.held.motions) motion.since -= state.clock.time();  // they go on
  setup.region_volume = state.region_volume;
  return setup;
}

}  // namespace cairn
