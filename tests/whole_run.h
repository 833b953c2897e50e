// Runs of scenes into result files: begun as the program begins them, to their ends at once or in pieces.
#pragma once

#include <omp.h>

#include <optional>

#include "core/build.h"
#include "sim/run.h"

namespace cairn {

/// One thread while it lives: scenes as small as tests have gain nothing from more.
struct OneThread {
  const int threads = omp_get_max_threads();
  OneThread() { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(threads); }
};

/// A run of the scene into a file, which replaces one of that name.
inline Run new_run(Scene scene, Setup setup, const std::filesystem::path& path, Operation operation = {}) {
  RunAttributes attributes{.title = scene.title,
                           .scene = scene.text,
                           .directory = scene.directory.string(),
                           .version = CAIRN_VERSION,
                           .build = build_name(),
                           .seed = scene.seed};
  ResultFile results = ResultFile::create(path, attributes.table(), true);
  return Run(std::move(scene), std::move(setup), std::move(results), std::move(operation));
}

inline Run new_run(const std::string& text, Setup setup, const std::filesystem::path& path,
                   Operation operation = {}) {
  return new_run(parse_scene(text, "run.toml", "."), std::move(setup), path, std::move(operation));
}

/// Runs to the end, resumed from the file whenever the listener has interrupted it. @return how often.
inline int run_to_end(Run first, const Run::Listener& listener, const Operation& operation = {}) {
  const std::filesystem::path path = first.path();
  std::optional<Run> run(std::move(first));
  for (int count = 0;; ++count) {
    if (run->advance(listener) == RunEnd::finished) return count;
    run.reset();  // the file takes one writer at a time
    run.emplace(Run::resume(path, operation));
  }
}

}  // namespace cairn
