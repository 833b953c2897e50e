// How long a candidate list lives. Distances do not change under rigid motion, so displacements are measured
// against the rigid motion the pile had when the list was made: a quiet spinning pile rebuilds almost never.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "contact/box.h"
#include "contact/history.h"
#include "contact/near_pairs.h"

namespace cairn {

/// A rigid motion through space; in a periodic box a translation.
struct RigidMotion {
  Vec3 center = Vec3::Zero();    ///< m, at `time`
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s
  double time = 0.0;             ///< s
};

/// Tells the list how far apart the cells, or the images in the box, are now.
void set_lattice(const Bodies& bodies, const Box& box, ContactList& contacts);

/// Keeps a contact list complete: every pair closer than the sum of its radii is among its slots.
class Candidates {
 public:
  /// Whether some sphere has moved too far, relative to the motion at the last rebuild and to the strain of
  /// the box since. If none has, `contacts` is told how far they have moved.
  bool expired(const Bodies& bodies, double time, ContactList& contacts, const Box& box = {}) const;

  /// Whether a list of that age (steps) has lived so long that a tighter one would be quicker.
  bool too_wide(std::uint64_t age) const;

  /// Searches afresh; histories in `contacts` are carried over.
  /// @throws UnstableError when a position is not finite, InputError when the box is too small.
  void rebuild(const Bodies& bodies, const RigidMotion& motion, const Features& features,
               ContactList& contacts, const Box& box = {});

  /// Tells the age of the list in steps when it expired, to adapt the skin: of all spheres, or of a few that
  /// fly about while the others stay where they are. The result of the run does not depend on the skin.
  void adapt_skin(std::uint64_t age, const ContactList& contacts);

 private:
  bool widen_few(std::uint64_t age, const std::vector<float>& moved);

  NearPairs search_;
  std::vector<Vec3> reference_;  ///< sphere centres at the rebuild, relative to the motion's centre
  std::vector<Pair> pairs_;
  std::vector<Vec3> cells_;   ///< of the bodies, at the rebuild
  Vec3 edge_ = Vec3::Zero();  ///< m, of the box, at the rebuild
  RigidMotion motion_;
  double skin_ = 0.0;                      ///< m; 0: not chosen yet
  std::vector<double> own_;                ///< m, half the skin of each sphere; empty when none has its own
  double smallest_ = 0.0, largest_ = 0.0;  ///< m, sphere radii
};

}  // namespace cairn
