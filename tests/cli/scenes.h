// Scenes of the tests of the program.
#pragma once

#include <string>

namespace cairn::cli {

/// Forty grains of three shapes fall together and are spun until they fail; every feature of the contacts,
/// tree gravity. Intervals of series, snapshots and renewals have no common divisor.
inline const std::string kForty = R"(title = "Forty mixed grains"
seed = 7

[[cloud]]
count = 40
filling = 0.2
distribution = "uniform"
size = 6
size_max = 12
density = 3000
material = "rough"
spin_period = 60000
[[cloud.shape]]
shape = "diamond"
[[cloud.shape]]
shape = "tetrahedron"
[[cloud.shape]]
shape = "sphere"

[[material]]
name = "rough"
restitution_normal = 0.5
restitution_tangential = 0.5
friction = 0.8
friction_rolling = 1.0
friction_twisting = 1.3
cohesion = 5
[[material]]
name = "sticky"
restitution_normal = 0.1
restitution_tangential = 0.1

[contact]
max_overlap = 0.04
steps_per_contact = 50

[gravity]
interval = "auto"

[[stage]]
name = "collapse"
duration = 5500
material = "sticky"
[[stage]]
name = "spin-up"
duration = 3000
[stage.spin]
path = [[0, 14000], [3000, 10000]]

[output]
snapshot_interval = 170
series_interval = 31
checkpoint_interval = 1
)";

/// Two clouds run into each other; enough spheres that threads share the work.
inline const std::string kClouds = R"(title = "Two clouds meet"
seed = 3

[[cloud]]
count = 60
filling = 0.2
size = 10
density = 3000
position = [-150, 0, 0]
velocity = [2, 0, 0]
[[cloud.shape]]
shape = "diamond"
[[cloud]]
count = 60
filling = 0.2
size = 10
density = 3000
position = [150, 40, 0]
velocity = [-2, 0, 0]
[[cloud.shape]]
shape = "tetrahedron"

[[material]]
name = "nominal"
cohesion = 50

[contact]
max_overlap = 0.05
steps_per_contact = 20

[gravity]
interval = 7

[[stage]]
name = "meet"
duration = 40

[output]
snapshot_interval = 13
series_interval = 3
)";

/// Grains in a shaken and turning box of triangles ("box.off").
inline const std::string kBox = R"(title = "Shaken box"
seed = 4

[[cloud]]
count = 12
filling = 0.2
size = 0.7
density = 2000
[[cloud.shape]]
shape = "tetrahedron"
[[cloud.shape]]
shape = "rod4"

[[wall]]
kind = "mesh"
file = "box.off"
unit = 2
oscillation_amplitude = [0.1, 0, 0.2]
oscillation_frequency = 0.7
angular_velocity = [0.3, 0.8, 0.1]

[contact]
stiffness = 1e9

[gravity]
method = "none"
field = [0, 0, -5]

[[stage]]
name = "shake"
duration = 20

[output]
snapshot_interval = 7
)";

/// A ball between two planes that close in on it, for a moment.
inline const std::string kPress = R"(title = "Press"

[[body]]
shape = "sphere"
size = 1
density = 2000
position = [0, 0, 0]

[[wall]]
kind = "plane"
point = [0, 0, -1.001]
velocity = [0, 0, 0.01]
[[wall]]
kind = "plane"
point = [0, 0, 1.001]
normal = [0, 0, -1]
velocity = [0, 0, -0.01]

[gravity]
method = "none"

[[stage]]
name = "press"
duration = 1
)";

/// Two spheres that meet; a run of a moment.
inline const std::string kTwo = R"(title = "Two balls"

[[body]]
shape = "sphere"
size = 1
density = 2000
position = [0, 0, 0]
[[body]]
shape = "sphere"
size = 1
density = 2000
position = [2.01, 0, 0]
velocity = [-0.01, 0, 0]

[gravity]
method = "none"

[[stage]]
name = "meet"
duration = 3

[output]
series_interval = 0.05
)";

/// The scene with the first `from` replaced.
inline std::string with(std::string scene, const std::string& from, const std::string& to) {
  return scene.replace(scene.find(from), from.size(), to);
}

}  // namespace cairn::cli
