// Clouds of mixed shapes: random sizes, positions and orientations, without overlap.
#pragma once

#include <vector>

#include "body/bodies.h"
#include "io/scene.h"

namespace cairn {

/// Size of a body (m) for a uniform deviate u in [0, 1).
double draw_size(const CloudSpec& cloud, double u);

/// Adds the cloud's bodies to `bodies`, in an order that keeps neighbours close in memory. Shape numbers are
/// indices into `shapes`, where `shape_index[k]` belongs to the k-th entry of the mixture. Numbers of each
/// shape follow the weights to the nearest integer. Deterministic for (seed, stream).
/// @throws InputError when the bodies do not fit at the requested filling.
void add_cloud(const CloudSpec& cloud, const std::vector<RigidShape>& shapes,
               const std::vector<std::uint32_t>& shape_index, std::uint16_t material, std::uint64_t seed,
               std::uint64_t stream, Bodies& bodies);

}  // namespace cairn
