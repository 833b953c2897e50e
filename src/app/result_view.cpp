#include "app/result_view.h"

#include <charconv>

#include "core/error.h"
#include "sim/run.h"

namespace cairn {

ResultView::ResultView(const std::filesystem::path& path) : file_(ResultFile::open(path)) {
  read_constants(file_, state_.bodies, shapes_);
  ContactColumns contacts;
  WallColumns walls;
  file_.read_checkpoint(checkpoint_fields(state_, contacts.table(), walls));
  RunAttributes attributes;
  file_.read_attributes(attributes.table());
  title_ = attributes.title;
}

std::string ResultView::outcome() const {
  return file_.finished() ? file_.outcome() : "unfinished";
}

SnapshotView ResultView::snapshot(std::size_t k) const {
  SnapshotView s;
  s.time = file_.snapshots()[k].time;
  s.stage = file_.snapshots()[k].stage;
  file_.read_snapshot(k, {{"velocity", "", "", &s.velocity, "body"},
                          {"remnant", "", "", &s.remnant, "body"},
                          {"sphere_position", "", "", &s.positions, "sphere"},
                          {"sphere_contacts", "", "", &s.contacts, "sphere"},
                          {"period", "", "", &s.period},
                          {"failed", "", "", &s.failed}});
  s.bodies = bodies_of(file_.snapshots()[k].epoch);
  const std::size_t spheres = s.bodies->spheres.size();
  if (s.velocity.size() != s.bodies->size() || s.remnant.size() != s.bodies->size() ||
      s.positions.size() != spheres || s.contacts.size() != spheres)
    throw InputError("{}: snapshot {} has other bodies than the file", file_.path().string(), k);
  return s;
}

std::shared_ptr<const Bodies> ResultView::bodies_of(std::uint64_t epoch) const {
  std::shared_ptr<const Bodies>& known = former_[epoch];
  if (!known) {
    auto bodies = std::make_shared<Bodies>();
    std::vector<std::string> shapes;
    read_constants(file_, *bodies, shapes, epoch);
    known = std::move(bodies);
  }
  return known;
}

std::vector<std::size_t> ResultView::select(const std::string& which) const {
  const std::size_t n = snapshots();
  if (n == 0) throw InputError("{}: no snapshots", file_.path().string());
  if (which == "first") return {0};
  if (which == "last") return {n - 1};
  if (which == "all") {
    std::vector<std::size_t> all(n);
    for (std::size_t k = 0; k < n; ++k) all[k] = k;
    return all;
  }
  if (which == "failure") {
    for (std::size_t k = 0; k < n; ++k)
      if (snapshot(k).failed) return {k};
    throw InputError("{}: the pile has not failed; there is no snapshot 'failure'", file_.path().string());
  }
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(which.data(), which.data() + which.size(), number);
  if (error == std::errc{} && end == which.data() + which.size()) {
    if (number < n) return {number};
    throw InputError("{}: no snapshot {}; there are 0 to {}", file_.path().string(), number, n - 1);
  }
  for (std::size_t k = n; k-- > 0;)
    if (file_.snapshots()[k].stage == which) return {k};
  throw InputError(
      "{}: no snapshot '{}'; expected a number from 0 to {}, first, last, failure, all or a stage",
      file_.path().string(), which, n - 1);
}

}  // namespace cairn
