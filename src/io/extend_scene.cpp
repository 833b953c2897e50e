#include "io/extend_scene.h"

#include "core/error.h"
#include "io/scene.h"
#include "io/scene_keys.h"
#include "io/toml_file.h"

namespace cairn {

namespace {

/// Where a place of a text is in its bytes.
std::size_t offset_of(const std::string& text, toml::source_position place) {
  std::size_t at = 0;
  for (toml::source_index line = 1; line < place.line; ++line) at = text.find('\n', at) + 1;
  const auto in_character = [&](std::size_t i) {
    return i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
  };
  for (toml::source_index column = 1; column < place.column; ++column) {
    ++at;
    while (in_character(at)) ++at;
  }
  return at;
}

/// The last stage, when stages are [[stage]] tables.
const toml::table* last_stage(const toml::table& root) {
  const toml::node* node = root.get("stage");
  const toml::array* stages = node ? node->as_array() : nullptr;
  if (!stages || stages->empty()) return nullptr;
  return stages->back().as_table();
}

}  // namespace

std::string add_stages(const std::string& scene, const std::string& stages, const std::string& file) {
  const toml::table added = parse_toml(stages, file);
  SourceMap sources;
  sources.file = file;
  for (const auto& [key, node] : added)
    if (key.str() != "stage")
      throw sources.error(SourcePosition{key.source().begin.line, key.source().begin.column}, key.str(),
                          "expected [[stage]] tables only: nothing else of a run can be changed");
  Scene of_keys;  // every key is looked at in its place
  read_options(stages, sources, scene_keys(), of_keys);
  const toml::table* last = last_stage(added);
  if (!last || last->is_inline()) throw sources.error(SourcePosition{}, "stage", "expected [[stage]] tables");
  const toml::table before = parse_toml(scene, "scene");
  if (last_stage(before)->is_inline())
    throw sources.error(
        "stage", "the scene of the run has its stages in an array, stage = [...]; none can be added to it");
  return scene + (scene.ends_with('\n') ? "" : "\n") + stages;
}

std::string extend_last_stage(const std::string& scene, double extension) {
  const toml::table root = parse_toml(scene, "scene");
  const toml::table& stage = *last_stage(root);
  std::string text = scene;
  if (const toml::node* former = stage.get("extension")) {
    const std::size_t begin = offset_of(text, former->source().begin),
                      end = offset_of(text, former->source().end);
    return text.replace(begin, end - begin, show(extension));
  }
  for (const auto& [key, node] : stage)
    if (key.str() == "duration")
      return text.insert(offset_of(text, key.source().begin),
                         fmt::format("extension = {}{}", show(extension), stage.is_inline() ? ", " : "\n"));
  throw InputError("the last stage has no duration");
}

}  // namespace cairn
