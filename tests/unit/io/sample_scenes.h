// Scenes that together give every key, and one that gives as few as it may.
#pragma once

namespace cairn {

// A cloud of mixed grains, collapsed and then spun up.
inline const char* const kPileScene = R"(
title = "Two materials, grains of two shapes"
seed = 9223372036854775807
mass_model = "spheres"

[[cloud]]
count = 500
filling = 0.05
distribution = "power_law"
size = 4
size_max = 32.0
exponent = 3.5
density = 3000
material = "rough"
position = [1, -2.5, 3e3]
velocity = [0.5, 0, -1]
spin_period = 18000
  [[cloud.shape]]
  shape = "tetrahedron"
  weight = 3
  [[cloud.shape]]
  shape = "grains/long.toml"

[[material]]
name = "rough"
restitution_normal = 0.5
restitution_tangential = 0.6
friction = 0.7
friction_rolling = 0.8
friction_twisting = 0.9
shape_factor = 0.4
cohesion = 120
stiffness = 3e7
stiffness_ratio = 0.8

[[material]]
name = "smooth"
friction = 0

[contact]
enabled = true
stiffness = 1e7
time_step = 0.01
unsafe_time_step = true
steps_per_contact = 40
max_overlap = 0.02
overlap_limit = 0.2
damping_mass = "spheres"
rolling_slip = "zhang2017"

[gravity]
method = "direct"
opening_angle = 0.6
order = 6
interval = 10
field = [0, 0, -9.81]

[[stage]]
name = "collapse"
duration = 5e4
material = "smooth"
impact_speed = 1.5
stiffness = 2e7
time_step = 0.005

[[stage]]
name = "spin-up"
duration = 147000
[stage.spin]
path = [[0, 18000], [7000, 10800], [147000, 8136]]
ramp = 500
control_interval = 60
check_interval = 30
remnant_gap = 0.15
on_failure = "keep"
axis_drop = 0.02
axis_hold = 400
include_shed = true
after_failure = 3600

[output]
snapshot_interval = 1000
series_interval = 10
checkpoint_interval = 60
remnant_gap = 0.2
)";

// Single bodies among walls of every kind, and the pile of another run.
inline const char* const kBodyScene = R"(
pile = "rubble.h5"
[[body]]
shape = "sphere"
size = 2
density = 2500
material = "stone"
position = [0, 0, 5]
velocity = [1, 2, 3]
angular_velocity = [0.1, 0.2, 0.3]
orientation = [0, 0, 0, 2]
walls = ["floor_1", "3"]
[[body]]
shape = "sphere"
density = 2500
material = "stone"
held = { velocity = [0, 0, 1], oscillation_amplitude = [0, 0, 0.01], oscillation_frequency = 20, oscillation_phase = 1.5, angular_velocity = [0, 0.5, 0], rotation_point = [5, 0, 1] }
[[wall]]
name = "floor_1"
kind = "plane"
point = [0, 0, 1]
normal = [0, 3, 4]
material = "stone"
velocity = [0, 0.1, 0]
[[wall]]
kind = "cylinder"
point = [5, 0, 0]
axis = [0, 2, 0]
radius = 12
side = "outside"
angular_velocity = [0, 0.5, 0]
rotation_point = [5, 0, 1]
[[wall]]
kind = "mesh"
file = "bowl.stl"
unit = 0.001
point = [0, 0, -9]
oscillation_amplitude = [0, 0, 0.01]
oscillation_frequency = 20
oscillation_phase = 1.5
motion_time = 0.25
[[wall]]
kind = "sphere"
radius = 100
angular_velocity = [0, 0, 1]
point = [1, 2, 3]
load = -5e4
load_axis = [0, 0, 2]
load_mass = 1e3
load_damping = 10
[[material]]
name = "stone"
[gravity]
error = 1e-4
[[stage]]
name = "fall"
duration = 1
)";

// A periodic slab that is compressed to a packing fraction, far away.
inline const char* const kBoxScene = R"(
[frame]
position = [1.5e11, 0, -2]
velocity = [0, 3e4, 0]
[box]
size = [30, 40, 0]
[[body]]
shape = "sphere"
mass = 12.5
[gravity]
method = "none"
[[stage]]
name = "compress"
duration = 10
extension = 2.5
strain_rate = [-0.01, -0.02, 0]
packing = 0.64
)";

// A pebble among perturbers of every kind.
inline const char* const kPerturberScene = R"(
[[body]]
shape = "sphere"
density = 2500
[[perturber]]
name = "Earth"
gm = 3.986004e14
radius = 6.371e6
tidal = true
[perturber.orbit]
eccentricity = 1.5
periapsis = 2e7
inclination = 0.5
node = -1
argument = 2
periapsis_time = 5000
gm = 4e14
[[perturber]]
name = "Sun"
mass = 1.989e30
[perturber.orbit]
eccentricity = 0.2
semi_major_axis = 1.5e11
mean_anomaly = 1.25
[[perturber]]
name = "Moon"
mass = 7.3e22
tidal = false
track = [[0, 1e8, 0, 0, 0, 1e3, 0], [10000, 1e8, 1e7, 0, 0, 1e3, 0]]
[[perturber]]
name = "Io"
mass = 9e22
track_file = "io.txt"
[[perturber]]
name = "rock"
mass = 1e12
position = [1e3, 0, 0]
[gravity]
method = "none"
[[stage]]
name = "pass"
duration = 10000
contacts = false
)";

// A recipe for a pile: a lattice in a cloud, shaken, carved, scaled and settled.
inline const char* const kRecipeScene = R"(
[[lattice]]
kind = "fcc"
shape = "cube"
size = 2
density = 2500
material = "stone"
spacing = 7
random_orientation = true
walls = []
held = { velocity = [0, 0, 1], oscillation_amplitude = [0, 0, 0.01], oscillation_frequency = 20, oscillation_phase = 1.5, angular_velocity = [0, 0.5, 0], rotation_point = [5, 0, 1] }
[lattice.region]
kind = "ball"
radius = 40
position = [1, 0, 0]
orientation = [1, 0, 0, 0.5]
[[lattice]]
size = 2
density = 2500
region = { kind = "mesh", file = "top.obj", unit = 1000, frame = "principal", size = [797, 783, 761], position = [1, 2, 3], orientation = [1, 0, 0, 0.5] }
[[cloud]]
count = 100
distribution = "log_normal"
size = 1
size_max = 3
median = 2
sigma = 0.3
density = 2000
hole = 50
walls = ["0"]
held = { velocity = [0, 0, 1], oscillation_amplitude = [0, 0, 0.01], oscillation_frequency = 20, oscillation_phase = 1.5, angular_velocity = [0, 0.5, 0], rotation_point = [5, 0, 1] }
[[cloud.shape]]
shape = "sphere"
[[material]]
name = "stone"
[[wall]]
kind = "sphere"
radius = 200
stages = ["shake"]
[[stage]]
name = "shake"
duration = 100
gravity = "none"
field = [0, 0, -9.81]
quiet_speed = 0.01
quiet_interval = 5
[[stage]]
name = "relax"
duration = 100
relax = { rate = 2, quiet = 1e-5 }
[[stage]]
name = "settle"
duration = 100
quiet_energy = 1e-6
[[stage]]
name = "carve"
[stage.carve]
whole = true
outside = true
[stage.carve.region]
kind = "mesh"
file = "top.obj"
unit = 1000
size = [797, 783, 761]
[[stage]]
name = "ball"
carve = { region = { kind = "ball", radius = 50 } }
[[stage]]
name = "turned"
carve = { region = { kind = "mesh", file = "top.obj", unit = 1000, frame = "principal", size = [797, 783, 761], position = [1, 2, 3], orientation = [1, 0, 0, 0.5] } }
[[stage]]
name = "turned core"
assign = { region = { kind = "mesh", file = "top.obj", unit = 1000, frame = "principal", size = [797, 783, 761], position = [1, 2, 3], orientation = [1, 0, 0, 0.5] }, density = 1 }
[[stage]]
name = "core"
[stage.assign]
outside = true
density = 1500
material = "stone"
[stage.assign.region]
kind = "box"
size = [200, 200, 200]
[[stage]]
name = "denser"
assign = { region = { kind = "ball", radius = 50 }, density_factor = 1.5 }
[[stage]]
name = "bulk"
[stage.scale]
density = 2170
by = "size"
volume = 2.5e8
[output]
interior = 300
)";

// As little as a scene can say.
inline const char* const kShortScene = R"(
[[body]]
shape = "sphere"
density = 1000
[[cloud]]
count = 1
size = 1
density = 1000
shape = [{ shape = "sphere" }]
[[wall]]
kind = "plane"
[[stage]]
name = "only"
duration = 1
spin.path = [[0, 100]]
)";

}  // namespace cairn
