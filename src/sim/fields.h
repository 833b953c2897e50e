// The one table of everything a state consists of: it drives checkpoint, restart and snapshot.
#pragma once

#include "io/fields.h"
#include "sim/setup.h"
#include "sim/state.h"

namespace cairn {

/// Contact records as columns.
struct ContactColumns {
  std::vector<std::uint32_t> i, j;
  std::vector<double> c_n, c_s, twist;
  std::vector<Vec3> slide, roll;

  void assign(const std::vector<ContactRecord>& records);
  std::vector<ContactRecord> records() const;
  /// Fields under `prefix`.
  FieldTable table(const std::string& prefix);
};

/// Constants of bodies and spheres, written once.
FieldTable body_constants(Bodies& bodies);
FieldTable sphere_constants(Bodies& bodies);

/// Poses and momenta.
FieldTable motion_fields(Bodies& bodies);

/// The whole state but for constants; contacts go through the columns.
FieldTable checkpoint_fields(State& state, ContactColumns& contacts, ContactColumns& walls);

/// Checks that constants read from a file fit together, and makes room for what is derived from them.
/// @throws InputError naming what does not fit.
void complete_bodies(Bodies& bodies);

}  // namespace cairn
