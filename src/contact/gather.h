// The wrenches of bodies from those of their contacts and from what else acts on them.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "contact/history.h"

namespace cairn {

/// What is done with bodies [begin, end) beside their contacts, while they are in the cache. Calls come from
/// many threads, each for bodies of its own.
class BodyWork {
 public:
  virtual ~BodyWork() = default;
  /// Sets their wrenches to those of all but contacts; here nothing else acts.
  virtual void before_contacts(Bodies& bodies, std::size_t begin, std::size_t end) const;
  /// Goes on when their wrenches are complete.
  virtual void after_contacts(Bodies&, std::size_t, std::size_t) const {}
};

/// Sets the wrenches of the bodies of block k. `own` has the shares of its spheres from the block's own
/// pairs; to these come those from earlier blocks, in order.
void gather_block(const ContactList& contacts, std::size_t k, const std::vector<WrenchShare>& own,
                  const BodyWork& work, Bodies& bodies);

}  // namespace cairn
