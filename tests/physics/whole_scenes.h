// Small scenes that use every kind of stage, operation, wall, perturber and box, and how to begin to run
// them.
#pragma once

#include "pile/assemble.h"
#include "pile/operate.h"
#include "whole_run.h"

namespace cairn {

inline constexpr const char* kMaterials = R"(
[[material]]
name = "rock"
friction = 0.6
friction_rolling = 0.5
friction_twisting = 0.5
cohesion = 5
[[material]]
name = "slippery"
restitution_normal = 0.1
)";

/// Grains that settle, are cut, made denser, larger and of two kinds, and spun until they have failed.
inline const std::string kRecipe = R"(
title = "recipe"
[[lattice]]
kind = "hcp"
size = 10
density = 2500
spacing = 20.0005
material = "rock"
region = { kind = "ball", radius = 45 }
[gravity]
interval = 7
[contact]
stiffness = 1e5
overlap_limit = 1
[[stage]]
name = "fall"
duration = 300
material = "slippery"
quiet_energy = 1e-3
quiet_interval = 40
[[stage]]
name = "cut"
carve = { region = { kind = "ball", radius = 38 } }
[[stage]]
name = "bulk"
scale = { density = 1500, by = "mass" }
[[stage]]
name = "settle"
duration = 60
[[stage]]
name = "larger"
scale = { density = 1400, by = "size", volume = 2e5 }
[[stage]]
name = "core"
assign = { density_factor = 1.5, region = { kind = "ball", radius = 30 } }
[[stage]]
name = "spin"
duration = 3000
[stage.spin]
path = [[0, 20000], [500, 3000]]
ramp = 50
remnant_gap = 1
axis_drop = 0.02
axis_hold = 20
control_interval = 2
after_failure = 60
[[stage]]
name = "free"
duration = 40
)" + std::string(kMaterials);

/// A bed of grains between moving walls of several kinds, some only in some stages.
inline const std::string kWalls = R"(
title = "walls"
[[lattice]]
kind = "sc"
shape = "tetrahedron"
size = 1
density = 2000
spacing = 4.2
material = "rock"
random_orientation = true
region = { kind = "box", size = [13, 13, 9], position = [0, 0, 6] }
[[wall]]
kind = "plane"
material = "rock"
oscillation_amplitude = [0.2, 0, 0.3]
oscillation_frequency = 0.5
[[wall]]
kind = "cylinder"
material = "slippery"
radius = 12
angular_velocity = [0, 0, 0.3]
stages = ["pour", "shake"]
[[wall]]
kind = "sphere"
material = "rock"
radius = 15
point = [0, 0, 8]
stages = ["shake", "rest"]
[gravity]
method = "none"
field = [0, 0.1, -1]
[contact]
stiffness = 3e6
overlap_limit = 1
[[stage]]
name = "pour"
duration = 4
[[stage]]
name = "shake"
duration = 2
material = "slippery"
[[stage]]
name = "cut"
carve = { region = { kind = "box", size = [11, 30, 30] }, whole = true }
[[stage]]
name = "rest"
duration = 2
)" + std::string(kMaterials);

/// Grains past a planet, heavier at last.
inline const std::string kFlyby = R"(
title = "flyby"
[[lattice]]
kind = "hcp"
size = 10
density = 2500
material = "rock"
region = { kind = "ball", radius = 35 }
[gravity]
method = "direct"
[contact]
stiffness = 1e7
[[perturber]]
name = "Earth"
gm = 3.986004e14
[perturber.orbit]
periapsis = 1.0e7
eccentricity = 1.5
periapsis_time = 40
[[stage]]
name = "in"
duration = 40
[[stage]]
name = "heavy"
assign = { density_factor = 2, region = { kind = "ball", radius = 15 } }
[[stage]]
name = "out"
duration = 40
)" + std::string(kMaterials);

/// A packing that is pressed together in a periodic box.
inline const std::string kBox = R"(
title = "box"
box = { size = [20, 21, 22] }
[[lattice]]
kind = "sc"
size = 1
density = 2000
spacing = 2.3
material = "rock"
region = { kind = "box", size = [17, 18, 19] }
[gravity]
method = "none"
[contact]
stiffness = 1e6
overlap_limit = 1
[[stage]]
name = "press"
duration = 1
strain_rate = [-0.3, -0.3, -0.2]
packing = 0.4
[[stage]]
name = "shear"
duration = 1
strain_rate = [0.1, -0.1, 0]
)" + std::string(kMaterials);

/// A cloud that falls together, far enough for the tree.
inline const std::string kCollapse = R"(
title = "collapse"
[[cloud]]
count = 400
size = 8
size_max = 12
distribution = "uniform"
filling = 0.25
density = 2500
material = "rock"
spin_period = 20000
[[cloud.shape]]
shape = "sphere"
[[cloud.shape]]
shape = "tetrahedron"
[gravity]
error = 1e-3
method = "tree"
[contact]
overlap_limit = 1
stiffness = 1e6
[[stage]]
name = "fall"
duration = 400
)" + std::string(kMaterials);

inline const std::vector<std::string>& scenes() {
  static const std::vector<std::string> all{kRecipe, kWalls, kFlyby, kBox};
  return all;
}

inline Run new_run(const std::string& text, const std::filesystem::path& path) {
  const Scene scene = parse_scene(text, "run.toml", ".");
  return new_run(scene, assemble(scene), path, operate);
}

}  // namespace cairn
