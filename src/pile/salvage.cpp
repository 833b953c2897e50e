#include "pile/salvage.h"

#include <fmt/format.h>

#include "body/bodies.h"
#include "core/build.h"
#include "core/error.h"
#include "io/results.h"
#include "sim/check_state.h"
#include "sim/fields.h"
#include "sim/observe.h"
#include "sim/run.h"

namespace cairn {
namespace {

struct Rescued {
  State state;
  std::vector<std::string> shapes, materials;
};

/// Snapshot k as the state at the start of a run.
Rescued read(const ResultFile& file, std::size_t k) {
  Rescued out;
  State& state = out.state;
  Bodies& bodies = state.bodies;
  const SnapshotInfo& info = file.snapshots()[k];
  if (info.stage.empty()) throw InputError("{}: snapshot {}: damaged", file.path().string(), k);
  read_constants(file, bodies, out.shapes, info.epoch);
  file.read_static("materials", {{"name", "", "", &out.materials}});
  file.read_static(
      "frame", {{"position", "", "", &state.frame.position}, {"velocity", "", "", &state.frame.velocity}});
  Vec3 origin = Vec3::Zero();
  FieldTable fields = motion_fields(bodies);
  fields.push_back({"origin", "", "", &origin});
  fields.push_back({"box", "", "", &state.box.edge});
  file.read_snapshot(k, fields);
  state.frame.position += origin + info.time * state.frame.velocity;
  bodies.remainder.assign(bodies.size(), Vec3::Zero());
  state.remnant.assign(bodies.size(), 1);
  if (const std::string what = not_finite(fields); !what.empty())
    throw InputError("{}: snapshot {}: {} is not finite", file.path().string(), k, what);
  check_motion(bodies, out.materials.size());
  return out;
}

void write(Rescued& rescued, RunAttributes& attributes, const std::filesystem::path& output, bool overwrite) {
  ResultFile result = ResultFile::create(output, attributes.table(), overwrite);
  State& state = rescued.state;
  write_constants(result, state, rescued.shapes, rescued.materials);
  result.declare_series(series_columns());
  ContactColumns contacts;
  WallColumns walls;
  result.finish(checkpoint_fields(state, contacts.table(), walls), kFinished);
}

}  // namespace

Salvage salvage(const std::filesystem::path& damaged, const std::filesystem::path& output, bool overwrite) {
  const ResultFile file = ResultFile::open_damaged(damaged);
  Salvage saved;
  for (std::size_t k = file.snapshots().size(); k-- > 0;) {
    Rescued rescued;
    try {
      rescued = read(file, k);
    } catch (const InputError& error) {
      if (saved.lost.empty()) saved.lost = error.what();
      continue;
    }
    saved.snapshot = k;
    saved.time = file.snapshots()[k].time;
    saved.bodies = rescued.state.bodies.size();
    RunAttributes attributes;
    try {
      file.read_attributes(attributes.table());
    } catch (const InputError&) {
      attributes = RunAttributes();  // they are no part of a pile
      attributes.version = CAIRN_VERSION;
    }
    attributes.title = fmt::format("snapshot {} of {}, saved", k, damaged.filename().string());
    attributes.build = build_name();
    write(rescued, attributes, output, overwrite);
    return saved;
  }
  throw InputError("{}: no snapshot is whole{}", damaged.string(),
                   saved.lost.empty() ? "" : ", the last one: " + saved.lost);
}

}  // namespace cairn
