// What a damaged or edited file could get wrong, and what a run must never write.
#pragma once

#include <span>

#include "io/fields.h"
#include "io/results.h"
#include "sim/fields.h"
#include "sim/physics.h"
#include "sim/state.h"

namespace cairn {

/// Poses and momenta of all bodies, and their materials, of which there are so many: as many as bodies, unit
/// quaternions, all finite.
/// @throws InputError naming the quantity and the body.
void check_motion(const Bodies& bodies, std::size_t materials);

/// Contacts of spheres of different bodies, each once and in order.
/// @throws InputError naming the spheres.
void check_contacts(const ContactColumns& contacts, const Bodies& bodies);

/// What makes a pile of a checkpoint: motion and contacts as above, its box, its stiffness, and nothing in
/// `fields` that is not finite.
/// @throws InputError naming what does not fit.
void check_pile(const State& state, std::size_t materials, const ContactColumns& contacts,
                const FieldTable& fields);

/// Everything else of a checkpoint from which a run of so many stages and walls is to go on; contacts with
/// walls are left to these.
/// @throws InputError naming what does not fit.
void check_checkpoint(const State& state, std::size_t stages, std::size_t walls);

/// Whether clock, gravity, spin control and relaxation are those of the stage that the run is in.
/// @throws InputError naming what does not fit.
void check_stage(const State& state, const Physics& physics);

/// @throws UnstableError with quantity, body and time (s) when a number of the table is not finite.
void require_finite(const FieldTable& table, double time);

/// @throws UnstableError with quantity and time (s) when a value of the row is not finite whose column does
/// not say that it may be: "NaN" or "infinite" stands in its help.
void require_documented(const std::vector<SeriesColumn>& columns, std::span<const double> row, double time);

}  // namespace cairn
