#include "sim/extend.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/extend_scene.h"
#include "sim/make_perturbers.h"

namespace cairn {

namespace {

/// Whether a stage may end before its time.
bool may_end_early(const StageSpec& stage) {
  return stage.quiet_energy || stage.quiet_speed || (stage.spin && stage.spin->after_failure);
}

/// When the last stage begins or has begun (s).
double start_of_last(const Scene& scene, const Clock& clock) {
  double start = clock.stage_start;
  for (std::size_t k = clock.stage; k + 1 < scene.stages.size(); ++k) {
    const StageSpec& stage = scene.stages[k];
    if (may_end_early(stage))
      throw InputError(
          "--until: the run is in stage '{}', and stage '{}' may end before its time, so that it is not "
          "known "
          "when the last one begins: resume the run first, or --add stages",
          scene.stages[clock.stage].name, stage.name);
    start += stage.duration + stage.extension;
  }
  return start;
}

/// The extension of the last stage with which it ends at `until` (s); none when it does so already.
std::optional<double> extension_until(const Scene& scene, const Clock& clock, bool finished, double until) {
  const StageSpec& last = scene.stages.back();
  if (last.operates())
    throw InputError("--until: the last stage, '{}', takes no time; --add stages to it", last.name);
  const double start = start_of_last(scene, clock);
  const bool within = clock.stage + 1 == scene.stages.size() && clock.steps > 0;
  if (finished && clock.step < clock.steps)
    throw InputError(
        "--until: the last stage, '{}', has ended at t = {:.6g} s, before its time, and would end there "
        "again; "
        "--add stages to it",
        last.name, clock.time());
  const double end =
      within ? start + static_cast<double>(clock.steps) * clock.dt : start + last.duration + last.extension;
  const double least = within ? 0.5 * clock.dt : 1e-12 * end;  // less is no difference
  if (until < end - least || (finished && until <= end + least))
    throw InputError("--until: the run {} at t = {:.9g} s; expected a later time, found {:.9g} s",
                     finished ? "has finished" : "ends", end, until);
  if (until <= end + least) return {};
  return until - start - last.duration;
}

/// The scene so continued, of a run in the file `path`.
Scene continued_scene(const Scene& scene, const Clock& clock, bool finished, const Continuation& more,
                      const std::string& path) {
  std::string text = scene.text;
  if (more.until)
    naming(path, [&] {
      if (const auto extension = extension_until(scene, clock, finished, *more.until))
        text = extend_last_stage(text, *extension);
    });
  SourceMap sources;
  sources.file = path;
  if (!more.stages_file.empty()) {
    text = add_stages(text, more.stages, more.stages_file);
    sources.added_file = more.stages_file;
    const auto added = text.end() - static_cast<std::ptrdiff_t>(more.stages.size());
    sources.first_added = 1 + static_cast<std::uint32_t>(std::count(text.begin(), added, '\n'));
  }
  return parse_scene(text, std::move(sources), scene.directory);
}

}  // namespace

Run Run::extend(const std::filesystem::path& path, const Continuation& more,
                const std::function<void(const Scene&)>& check, Operation operation) {
  Run run = load(path, std::move(operation));
  Clock& clock = run.state_.clock;
  const bool finished = run.results_.finished();
  const std::size_t former = run.stages();
  RunAttributes attributes;
  run.results_.read_attributes(attributes.table());
  Scene scene = continued_scene(run.scene_, clock, finished, more, path.string());
  attributes.scene = scene.text;
  scene.files = run.scene_.files;
  scene.files.reopen();
  load_tracks(scene);
  check(scene);
  run.scene_ = std::move(scene);
  run.check_stages(former);

  if (finished && !more.until) {
    run.epoch_ += run.scene_.stages[clock.stage].operates();  // those of stages before have been counted
    run.leave_stage();
  } else if (finished) {
    run.stages_done_.pop_back();
    run.results_.write_static("stages", run.stages_done_.table());
  }
  if (clock.steps > 0) {
    run.physics_ = resolve_physics(run.scene_, clock.stage, run.state_.bodies, run.state_.k_n, clock.dt);
    clock.steps = run.physics_.steps;
  }
  run.results_.write_attributes(attributes.table());
  run.scene_.files.write(run.results_);
  run.commit(false);
  return run;
}

}  // namespace cairn
