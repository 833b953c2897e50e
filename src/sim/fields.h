// The one table of everything a state consists of: it drives checkpoint, restart and snapshot.
#pragma once

#include "io/fields.h"
#include "io/results.h"
#include "sim/setup.h"
#include "sim/state.h"

namespace cairn {

/// Contact histories as columns.
struct MemoryColumns {
  std::vector<double> c_n, c_s, twist;
  std::vector<Vec3> slide, roll;

  void reserve(std::size_t count);
  void push_back(const ContactMemory<double>& memory);
  ContactMemory<double> operator[](std::size_t k) const;
  FieldTable table(const std::string& prefix);
};

/// Contacts of spheres as columns.
struct ContactColumns {
  std::vector<std::uint32_t> i, j;
  MemoryColumns memory;

  void assign(const std::vector<ContactRecord>& records);
  std::vector<ContactRecord> records() const;
  FieldTable table();
};

/// The same fields, to be written only: each is made when its turn comes, for there may be many contacts.
FieldTable contact_fields(const ContactList& contacts);

/// Contacts with walls as columns.
struct WallColumns {
  std::vector<std::uint32_t> sphere, wall, feature;
  MemoryColumns memory;

  void assign(const std::vector<WallContact>& contacts);
  std::vector<WallContact> contacts() const;
  /// Fields under `prefix`.
  FieldTable table(const std::string& prefix);
};

/// Constants of bodies and spheres, written once.
FieldTable body_constants(Bodies& bodies);
FieldTable sphere_constants(Bodies& bodies);

/// Poses and momenta.
FieldTable motion_fields(Bodies& bodies);

/// The whole state but for constants, with these fields of contacts.
FieldTable checkpoint_fields(State& state, const FieldTable& contacts, WallColumns& walls);

/// Writes what a run had done when it broke off, which its checkpoint is too old to tell.
void write_break(ResultFile& file, Clock clock);
/// How far a run has come: until it broke off, or else until its `checkpoint`.
struct Reached {
  std::uint64_t steps = 0;  ///< done in all
  double time = 0.0;        ///< s
};
Reached reached(const ResultFile& file, const Clock& checkpoint);

/// Writes the constants of bodies and spheres; `suffix` tells those of a former epoch.
void write_bodies(ResultFile& file, Bodies& bodies, const std::string& suffix = "");
/// The same with all else that their numbers refer to: names of shapes and materials, the frame.
void write_constants(ResultFile& file, State& state, std::vector<std::string>& shapes,
                     std::vector<std::string>& materials);

/// Reads the constants of bodies and spheres, those that they have now or had in an earlier epoch, and the
/// names of their shapes, checks that they fit together, and makes room for what is derived from them.
/// @throws InputError naming the file and what does not fit.
void read_constants(const ResultFile& file, Bodies& bodies, std::vector<std::string>& shapes);
void read_constants(const ResultFile& file, Bodies& bodies, std::vector<std::string>& shapes,
                    std::uint64_t epoch);

}  // namespace cairn
