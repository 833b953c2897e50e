// What keeps bodies from moving freely, as result files hold it: the motions of held bodies and the sets of
// walls that bodies refer to.
#pragma once

#include "io/results.h"
#include "sim/state.h"

namespace cairn {

void write_restraints(ResultFile& file, const HeldBodies& held, std::vector<std::string> wall_sets);

/// Those that the bodies, whose constants have been read, refer to. From where they are held is not found.
/// @throws InputError naming the file when the bodies refer to what is not there.
void read_restraints(const ResultFile& file, const Bodies& bodies, HeldBodies& held,
                     std::vector<std::string>& wall_sets);

}  // namespace cairn
