// The springs of contacts on their way from stage to stage, whose pairs may differ in stiffness.
#pragma once

#include <vector>

#include "contact/history.h"
#include "contact/walls.h"
#include "sim/physics.h"

namespace cairn {

/// Within a stage springs are as long as the stiffnesses of their pairs make them. Between stages, where
/// materials may change, they are as long as the same forces would make them at the stiffness physics.k_n of
/// the stage that they come from and k_S = 2/7 k_N. Wall contacts index physics.wall_materials.
void leave_stiffness(const Physics& physics, const Bodies& bodies, std::vector<ContactRecord>& contacts,
                     std::vector<WallContact>& walls);

/// The way back: springs that were left at stiffness `k_n` (N/m) get the lengths of the same forces in the
/// stage.
void enter_stiffness(const Physics& physics, const Bodies& bodies, double k_n,
                     std::vector<ContactRecord>& contacts, std::vector<WallContact>& walls);
/// The same of one contact.
void enter_stiffness(const PairLaw& law, double k_n, ContactMemory<double>& memory);

}  // namespace cairn
