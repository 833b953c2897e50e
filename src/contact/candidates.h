// How long a candidate list lives. Distances do not change under rigid motion, so displacements are measured
// against the rigid motion the pile had when the list was made: a quiet spinning pile rebuilds almost never.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "contact/history.h"
#include "contact/search.h"

namespace cairn {

/// A rigid motion through space.
struct RigidMotion {
  Vec3 center = Vec3::Zero();    ///< m, at `time`
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s
  double time = 0.0;             ///< s
};

/// Keeps a contact list complete: every pair closer than the sum of its radii is among its slots.
class Candidates {
 public:
  /// Whether some sphere has moved too far, relative to the motion at the last rebuild.
  bool expired(const Bodies& bodies, double time) const;

  /// Searches afresh; histories in `contacts` are carried over.
  /// @throws UnstableError when a position is not finite.
  void rebuild(const Bodies& bodies, const RigidMotion& motion, const Features& features,
               ContactList& contacts);

  /// Tells the age of the list in steps when it expired, to adapt the skin. The result of the run does not
  /// depend on the skin.
  void adapt_skin(std::uint64_t age);

 private:
  NeighbourSearch search_;
  std::vector<Vec3> reference_;  ///< sphere centres at the rebuild, relative to the motion's centre
  std::vector<Pair> pairs_;
  RigidMotion motion_;
  double skin_ = 0.0;      ///< m; 0: not chosen yet
  double smallest_ = 0.0;  ///< m, smallest sphere radius
};

}  // namespace cairn
