#include "sim/restraints.h"

#include <algorithm>

#include "core/error.h"

namespace cairn {

namespace {

/// Prescribed motions as columns.
struct MotionColumns {
  std::vector<Vec3> velocity, amplitude, spin, center;
  std::vector<double> frequency, phase, since;

  void assign(const std::vector<WallMotion>& motions);
  std::vector<WallMotion> motions() const;
  FieldTable table();
};

void MotionColumns::assign(const std::vector<WallMotion>& motions) {
  *this = MotionColumns{};
  for (const WallMotion& m : motions) {
    velocity.push_back(m.velocity);
    amplitude.push_back(m.amplitude);
    frequency.push_back(m.frequency);
    phase.push_back(m.phase);
    spin.push_back(m.spin);
    center.push_back(m.center);
    since.push_back(m.since);
  }
}

std::vector<WallMotion> MotionColumns::motions() const {
  std::vector<WallMotion> out;
  for (std::size_t k = 0; k < velocity.size(); ++k)
    out.push_back({velocity[k], amplitude[k], frequency[k], phase[k], spin[k], center[k], since[k]});
  return out;
}

FieldTable MotionColumns::table() {
  return {{"velocity", "m/s", "of a translation", &velocity, "motion"},
          {"oscillation_amplitude", "m", "displacement amplitude sin(2 pi frequency t + phase)", &amplitude,
           "motion"},
          {"oscillation_frequency", "Hz", "of it", &frequency, "motion"},
          {"oscillation_phase", "rad", "of it", &phase, "motion"},
          {"angular_velocity", "rad/s", "of a rotation", &spin, "motion"},
          {"rotation_point", "m", "before translation and oscillation", &center, "motion"},
          {"since", "s", "zero of the motion's time", &since, "motion"}};
}

FieldTable set_fields(std::vector<std::string>& sets) {
  return {{"walls", "", "names of the walls of a set, each between commas", &sets, "set"}};
}

}  // namespace

void write_restraints(ResultFile& file, const HeldBodies& held, std::vector<std::string> wall_sets) {
  MotionColumns columns;
  columns.assign(held.motions);
  if (!held.motions.empty()) file.write_static("held_motions", columns.table());
  if (!wall_sets.empty()) file.write_static("wall_sets", set_fields(wall_sets));
}

void read_restraints(const ResultFile& file, const Bodies& bodies, HeldBodies& held,
                     std::vector<std::string>& wall_sets) {
  MotionColumns columns;
  if (file.has_group("held_motions")) file.read_static("held_motions", columns.table());
  if (file.has_group("wall_sets")) file.read_static("wall_sets", set_fields(wall_sets));
  const auto check = [&](const std::vector<std::uint16_t>& numbers, std::size_t count, const char* what) {
    if (!numbers.empty() && *std::max_element(numbers.begin(), numbers.end()) > count)
      throw InputError("{}: bodies/{}: a body has a number above {}", file.path().string(), what, count);
  };
  const auto& c = columns;
  for (const std::size_t rows : {c.amplitude.size(), c.frequency.size(), c.phase.size(), c.spin.size(),
                                 c.center.size(), c.since.size()})
    if (rows != c.velocity.size())
      throw InputError("{}: held_motions: expected columns of one length", file.path().string());
  held.motions = columns.motions();
  check(bodies.held, held.motions.size(), "held");
  check(bodies.wall_set, wall_sets.size(), "wall_set");
}

}  // namespace cairn
