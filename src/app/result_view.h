// A result file as the drawing and summarising commands see it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/results.h"
#include "sim/fields.h"
#include "sim/state.h"

namespace cairn {

/// Bodies and spheres at one time.
struct SnapshotView {
  double time = 0.0, period = 0.0;  ///< s
  std::string stage;
  bool failed = false;
  std::vector<Vec3f> positions;          ///< m, of spheres
  std::vector<std::uint16_t> contacts;   ///< of spheres
  std::vector<std::uint8_t> remnant;     ///< of bodies
  std::vector<Vec3> velocity;            ///< m/s, of bodies
  std::shared_ptr<const Bodies> bodies;  ///< constants of the bodies at that time
};

/// @throws InputError from every member when the file is damaged or not a result file.
class ResultView {
 public:
  explicit ResultView(const std::filesystem::path& path);

  const Bodies& bodies() const { return state_.bodies; }
  const Control& control() const { return state_.control; }
  Reached reached() const { return cairn::reached(file_, state_.clock); }
  const std::vector<std::string>& shapes() const { return shapes_; }
  const std::string& title() const { return title_; }
  std::string outcome() const;
  std::size_t snapshots() const { return file_.snapshots().size(); }
  SnapshotView snapshot(std::size_t k) const;
  std::vector<double> series(const std::string& column) const { return file_.read_series(column); }
  /// Numbers of the snapshots that `which` names: a number, "first", "last", "failure", the name of a stage
  /// (its last snapshot), or "all". @throws InputError listing what there is.
  std::vector<std::size_t> select(const std::string& which) const;

 private:
  std::shared_ptr<const Bodies> bodies_of(std::uint64_t epoch) const;

  ResultFile file_;
  mutable std::map<std::uint64_t, std::shared_ptr<const Bodies>> former_;  // constants by epoch
  State state_;
  std::vector<std::string> shapes_;
  std::string title_;
};

}  // namespace cairn
