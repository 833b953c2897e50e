// A run: the stages of a scene one after the other, with outputs, checkpoints and spin control.
#pragma once

#include <functional>
#include <optional>

#include "io/results.h"
#include "io/xdmf.h"
#include "sim/observe.h"
#include "sim/physics.h"
#include "sim/setup.h"
#include "sim/stage_report.h"
#include "sim/start_energy.h"
#include "sim/step.h"

namespace cairn {

/// Snapshots and rows of the series that wait in memory for the next commit cause one when they are as large
/// as this (bytes).
inline constexpr std::uint64_t kMostWaiting = 64u << 20;

enum class RunEnd { finished, interrupted };

struct Continuation;  // in sim/extend.h

/// Does what a stage that operates asks for to the bodies and their contacts; returns what that was. Room
/// pile supplies it.
using Operation =
    std::function<std::string(const Scene&, std::size_t stage, State&, std::vector<ContactRecord>&)>;

class Run {
 public:
  /// A new run into `results`.
  Run(Scene scene, Setup setup, ResultFile results, Operation operation = {});
  /// Continues the run in `path`, bitwise as if it had not stopped.
  /// @throws InputError when the file is not a result file, has no checkpoint, or the run has finished.
  static Run resume(const std::filesystem::path& path, Operation operation = {});
  /// Continues the run in `path`, finished or not, beyond its scene, bitwise as if this had been so from the
  /// start, see sim/extend.h; the file holds the longer scene from now on. `check` looks at that scene first.
  /// @throws InputError, with the file as it was, when the run or what it shall do is not fit for that.
  static Run extend(const std::filesystem::path& path, const Continuation& more,
                    const std::function<void(const Scene&)>& check, Operation operation = {});

  /// Called back while a run advances; any may be empty.
  struct Listener {
    std::function<bool(const Run&)> watch =
        {};  ///< now and then; false: the run writes a checkpoint and stops
    std::function<void(const StageReport&)> report = {};    ///< at the end of each stage
    std::function<void(const std::string&)> announce = {};  ///< what has happened, in a line
    std::function<void(const std::string&)> warn = {};      ///< what makes a result doubtful, in a line
    double watch_interval = 0.05;  ///< s of wall-clock time between calls of `watch`; 0: after every step
  };
  /// Runs to the end of the scene.
  /// @throws UnstableError when the physics leaves its bounds; the result file keeps everything until then.
  RunEnd advance(const Listener& listener);

  /// How the program and the scene of a run that is resumed differ from those it was started with, in a line
  /// each: what follows is then not what it would have been.
  const std::vector<std::string>& differences() const { return differences_; }
  /// What looks wrong about the bodies' motion at the start.
  std::vector<std::string> warnings() const;

  const Scene& scene() const { return scene_; }
  const State& state() const { return state_; }
  const Physics& physics() const { return physics_; }
  const Observation& last_observation() const { return last_; }
  const PhaseTimes& times() const { return scratch_.times; }
  const std::filesystem::path& path() const { return results_.path(); }
  std::size_t sphere_count() const { return state_.bodies.spheres.size(); }
  std::size_t stages() const { return scene_.stages.size(); }
  /// What the contacts of the stage held at its start beyond what they held before; nothing after a resume
  /// within it.
  const StartEnergy& start_energy() const { return start_energy_; }

 private:
  Run(Scene scene, ResultFile results, Operation operation)
      : scene_(std::move(scene)), results_(std::move(results)), operation_(std::move(operation)) {}

  static Run load(const std::filesystem::path& path, Operation operation);
  void check_stages(std::size_t first) const;
  void start_stage();
  std::string operate();
  std::string follow();
  void leave_stage();
  void begin();
  void rebase();
  StageReport end_stage(std::string what, double seconds);
  void prepare_bodies();
  void look();
  void announce_start(const std::string& why_so_stiff) const;
  void announce_failure() const;
  void warn(const std::vector<std::string>& lines) const;
  bool checkpoint_asked();
  void add_snapshot();
  void commit(bool last);

  Scene scene_;
  ResultFile results_;
  Sidecar sidecar_;
  std::vector<std::string> shapes_;
  std::vector<ContactRecord> inherited_;  ///< contacts between two stages
  std::optional<FormerStage> former_;     ///< of the pile that the run starts from
  std::vector<Wall> walls_;               ///< of the scene
  StageColumns stages_done_;
  Operation operation_;
  std::uint64_t epoch_ = 0;  ///< operations done
  std::vector<std::string> differences_;
  double link_gap_ = 0.0;  ///< m
  StartEnergy start_energy_;
  State state_;
  Physics physics_;
  Scratch scratch_;
  Observation last_;
  Listener listener_;
  double last_watch_ = 0.0, last_commit_ = 0.0;  ///< s of wall-clock time
  double commit_seconds_ = 0.0;                  ///< of wall-clock time, that the last commit took
};

/// Title, version, scene and seed, as result files carry them.
struct RunAttributes {
  std::string title, scene, directory, version;
  std::string build = {};  ///< see core/build.h
  std::uint64_t seed = 0;
  FieldTable table();
};

}  // namespace cairn
