// A scene: everything a run depends on, as its TOML file states it. SI units throughout.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/cells.h"
#include "contact/law/material.h"
#include "core/math.h"
#include "io/inputs.h"
#include "io/interval.h"
#include "io/source.h"
#include "io/track_rows.h"
#include "motion/spin.h"
#include "shape/shape.h"

namespace cairn {

enum class SizeDistribution { single, uniform, log_normal, power_law };
enum class DampingMass { bodies, spheres };
enum class RollingSlip { none, zhang2017 };
enum class GravityMethod { none, direct, tree };
enum class OnFailure { release, keep };
enum class WallKind { plane, sphere, cylinder, mesh };
enum class WallSide { inside, outside };
enum class LatticeKind { hcp, fcc, sc };
enum class RegionKind { ball, ellipsoid, box, mesh };
enum class MeshFrame { file, centroid, principal };
enum class ScaleBy { mass, size };

/// One shape of a mixture.
struct ShapeChoice {
  std::string shape;    ///< library name or path of a shape file
  double weight = 1.0;  ///< relative number of bodies
};

/// How what does not move freely moves.
struct MotionSpec {
  Vec3 velocity = Vec3::Zero();               ///< m/s
  Vec3 oscillation_amplitude = Vec3::Zero();  ///< m
  double oscillation_frequency = 0.0;         ///< Hz
  double oscillation_phase = 0.0;             ///< rad
  Vec3 angular_velocity = Vec3::Zero();       ///< rad/s
  std::optional<Vec3> rotation_point;         ///< m
};

/// A ball of bodies at random positions and orientations, without overlap.
struct CloudSpec {
  std::vector<ShapeChoice> shapes;
  std::int64_t count = 0;
  double filling = 0.1;  ///< volume of the bodies' bounding spheres over the volume of the ball
  SizeDistribution distribution = SizeDistribution::single;
  double size = 0.0;      ///< m; of every body, or the smallest
  double size_max = 0.0;  ///< m; the largest, unless single
  double exponent = 3.0;  ///< power_law: differential number ~ size^-exponent
  double median = 0.0;    ///< m, log_normal: before the limits cut it
  double sigma = 0.0;     ///< log_normal: standard deviation of ln size
  double density = 0.0;   ///< kg/m^3
  std::string material;
  Vec3 position = Vec3::Zero();  ///< m
  Vec3 velocity = Vec3::Zero();  ///< m/s
  double spin_period = 0.0;      ///< s, rigid rotation about z; 0: none
  double hole = 0.0;             ///< m, radius of a ball in the middle that stays free
  std::optional<MotionSpec> held;
  std::optional<std::vector<std::string>> walls;  ///< that touch them; absent: all
};

/// A part of space. Keys that its kind does not have are errors.
struct RegionSpec {
  RegionKind kind = RegionKind::ball;
  double radius = 0.0;       ///< m, of a ball
  Vec3 size = Vec3::Zero();  ///< m, full extents of an ellipsoid or box; of a mesh: scaled to these
  std::string file;          ///< of a mesh
  double unit = 1.0;         ///< m, of the lengths in the file
  MeshFrame frame = MeshFrame::file;
  Vec3 position = Vec3::Zero();         ///< m, of the centre, or of a mesh's origin
  Quat orientation = Quat::Identity();  ///< w, x, y, z: frame of the region -> space
};

/// Bodies of one kind on a lattice.
struct LatticeSpec {
  LatticeKind kind = LatticeKind::hcp;
  std::string shape = "sphere";
  double size = 0.0;     ///< m
  double density = 0.0;  ///< kg/m^3
  std::string material;
  double spacing = 0.0;  ///< m, of nearest sites; 0: bounding spheres touch
  bool random_orientation = false;
  RegionSpec region;
  std::optional<MotionSpec> held;
  std::optional<std::vector<std::string>> walls;  ///< that touch them; absent: all
};

/// One body put by hand. One of density and mass is given.
struct BodySpec {
  std::string shape;
  double size = 1.0;              ///< m
  std::optional<double> density;  ///< kg/m^3
  std::optional<double> mass;     ///< kg
  std::string material;
  Vec3 position = Vec3::Zero();          ///< m, centre of mass
  Vec3 velocity = Vec3::Zero();          ///< m/s
  Vec3 angular_velocity = Vec3::Zero();  ///< rad/s
  Quat orientation = Quat::Identity();   ///< w, x, y, z: frame of the shape file -> space
  std::optional<MotionSpec> held;
  std::optional<std::vector<std::string>> walls;  ///< that touch it; absent: all
};

/// A periodic box.
struct BoxSpec {
  Vec3 size = Vec3::Zero();  ///< m; 0: open in that direction; all 0: the pile's
};

/// A wall, fixed or moved as prescribed, or by a load. Keys that its kind does not have are errors.
struct WallSpec {
  std::string name;  ///< the wall's number when not given, see wall_name
  WallKind kind = WallKind::plane;
  std::string material;
  Vec3 point =
      Vec3::Zero();  ///< m, of the plane or the cylinder's axis; the sphere's centre; a mesh's origin
  Vec3 normal = Vec3::UnitZ();  ///< of a plane, to the side where the bodies are
  Vec3 axis = Vec3::UnitZ();    ///< of a cylinder
  double radius = 0.0;          ///< m, of a sphere or cylinder
  WallSide side = WallSide::inside;
  std::string file;                           ///< of a mesh
  double unit = 1.0;                          ///< m, of the lengths in the file
  Vec3 velocity = Vec3::Zero();               ///< m/s
  Vec3 oscillation_amplitude = Vec3::Zero();  ///< m
  double oscillation_frequency = 0.0;         ///< Hz
  double oscillation_phase = 0.0;             ///< rad
  Vec3 angular_velocity = Vec3::Zero();       ///< rad/s
  Vec3 rotation_point = Vec3::Zero();         ///< m; `point` when not given
  std::optional<double> motion_time;          ///< s, that it has moved so before it begins
  std::optional<double> load;                 ///< N, that moves it along load_axis
  Vec3 load_axis = Vec3::UnitZ();             ///< of a plane its normal when not given
  double load_mass = 0.0;                     ///< kg
  double load_damping = 0.0;                  ///< kg/s
  std::vector<std::string> stages;            ///< in which it is there; empty: all
};

struct ContactSpec {
  bool enabled = true;              ///< false: bodies pass through each other and through walls
  std::optional<double> stiffness;  ///< k_N, N/m; chosen by the program when absent
  std::optional<double> time_step;  ///< s; chosen by the program when absent
  bool unsafe_time_step = false;    ///< accept a time step longer than the longest safe one
  double steps_per_contact = 50.0;  ///< time steps in the shortest contact
  double max_overlap = 0.01;        ///< aimed at by the automatic stiffness, of the smallest radius
  double overlap_limit = 0.1;       ///< a larger overlap stops the run, of the smaller radius of the pair
  DampingMass damping_mass = DampingMass::bodies;
  RollingSlip rolling_slip = RollingSlip::none;
};

struct GravitySpec {
  GravityMethod method = GravityMethod::tree;
  double error = 1e-3;                  ///< asked of the tree: sqrt(sum |da|^2 / sum |a|^2)
  std::optional<double> opening_angle;  ///< by hand: cells meet when the sum of their radii < this x distance
  std::int64_t order = 5;               ///< of the expansions, with opening_angle
  Interval interval;                    ///< between evaluations
  Vec3 field = Vec3::Zero();            ///< m/s^2, uniform external field
};

/// Kepler elements of a perturber about the zero of the scene's frame. One of periapsis and semi_major_axis
/// is given, and at most one of periapsis_time and mean_anomaly.
struct OrbitSpec {
  double eccentricity = 0.0;
  std::optional<double> periapsis;        ///< m
  std::optional<double> semi_major_axis;  ///< m, negative for a hyperbola
  double inclination = 0.0;               ///< rad
  double node = 0.0;                      ///< rad
  double argument = 0.0;                  ///< rad, of the periapsis
  double periapsis_time = 0.0;            ///< s
  std::optional<double> mean_anomaly;     ///< rad, at time 0
  std::optional<double> gm;               ///< m^3/s^2; the perturber's and the bodies' when absent
};

/// A point mass outside the bodies. One of mass and gm is given, and one of position, orbit, track and
/// track_file.
struct PerturberSpec {
  std::string name;
  std::optional<double> mass;    ///< kg
  std::optional<double> gm;      ///< m^3/s^2
  double radius = 0.0;           ///< m; bodies that come so near stop the run
  bool tidal = true;             ///< the zero of the frame falls freely in its pull
  Vec3 position = Vec3::Zero();  ///< m, of a fixed one
  std::optional<OrbitSpec> orbit;
  TrackRows track;
  std::string track_file;  ///< its rows are in `track` once load_tracks has been called
};

/// Prescribed spin of the pile about z [Zhang et al. 2021, section 2.3].
struct SpinSpec {
  std::vector<SpinPoint> path;
  double ramp = 0.0;                     ///< s, in which the spin rate goes over to the path's
  double control_interval = 0.0;         ///< s between corrections; 0: every step
  std::optional<double> check_interval;  ///< s between looks at the pile; absent: chosen by the stage
  double remnant_gap = 0.1;              ///< bodies closer than this times the smallest radius are one pile
  OnFailure on_failure = OnFailure::release;
  double axis_drop = 0.01;              ///< failure: relative fall of c/a from that of the pile at rest ...
  std::optional<double> axis_hold;      ///< s; ... that lasts so long; absent: chosen by the stage
  bool include_shed = false;            ///< also spin bodies that have left the pile
  std::optional<double> after_failure;  ///< s; the stage ends this long after failure
};

/// Takes bodies away.
struct CarveSpec {
  RegionSpec region;     ///< from the mass centre of the bodies that are not held
  bool whole = false;    ///< a body stays if all of its spheres are in the region; otherwise, its centre
  bool outside = false;  ///< those in the region go instead
};

/// Gives the bodies a bulk density.
struct ScaleSpec {
  double density = 0.0;  ///< kg/m^3, mass of all bodies over the volume
  ScaleBy by = ScaleBy::mass;
  std::optional<double> volume;  ///< m^3; absent: of the region last carved
};

/// Gives the bodies in a region another density or material.
struct AssignSpec {
  RegionSpec region;                     ///< from the mass centre of the bodies that are not held
  bool outside = false;                  ///< those that are not in it instead
  std::optional<double> density;         ///< kg/m^3
  std::optional<double> density_factor;  ///< times their own
  std::string material;                  ///< empty: as it is
};

/// Takes energy out of the motion inside each pile of touching bodies, until it is quiet (see sim/relax.h).
struct RelaxSpec {
  std::optional<double> rate;  ///< 1/s, of the drag; absent: chosen for each pile
  double quiet = 1e-6;         ///< the stage ends at this energy over |W|, or the elastic energy at its start
};

/// A stretch of the run with its own settings, or an operation on the bodies that takes no time.
struct StageSpec {
  std::string name;
  double duration = 0.0;         ///< s; the longest, when it can end earlier
  double extension = 0.0;        ///< s, that it goes on after its duration
  std::string material;          ///< replaces every body's material during the stage, when given
  std::optional<bool> contacts;  ///< replaces contact.enabled
  std::optional<double>
      impact_speed;                 ///< m/s, for the automatic stiffness; the pile's escape speed when absent
  std::optional<double> stiffness;  ///< N/m; replaces contact.stiffness
  std::optional<double> time_step;  ///< s; replaces contact.time_step
  std::optional<SpinSpec> spin;
  std::optional<RelaxSpec> relax;
  Vec3 strain_rate = Vec3::Zero();  ///< 1/s, d ln(edge) / dt of the box
  std::optional<double> packing;    ///< the strain ends at this volume of the bodies over that of the box
  std::optional<GravityMethod> gravity;  ///< replaces gravity.method
  std::optional<Vec3> field;             ///< m/s^2; replaces gravity.field
  std::optional<double> quiet_energy;    ///< the stage ends at this kinetic energy over |W|
  std::optional<double> quiet_speed;     ///< m/s; the stage ends at this rms speed
  std::optional<double> quiet_interval;  ///< s, between looks at these; absent: 200 steps
  std::optional<CarveSpec> carve;
  std::optional<ScaleSpec> scale;
  std::optional<AssignSpec> assign;

  /// Whether it changes the bodies instead of following their motion.
  bool operates() const { return carve || scale || assign; }
};

struct OutputSpec {
  double snapshot_interval = 0.0;      ///< s of simulated time; 0: only the ends of stages
  double series_interval = 0.0;        ///< s of simulated time; 0: chosen by the stage
  double checkpoint_interval = 300.0;  ///< s of wall-clock time
  double remnant_gap = 0.1;            ///< bodies closer than this times the smallest radius are one remnant
  double interior = 0.0;  ///< m, radius within which the packing is measured; 0: 3/4 of the half extent c/2
};

struct Scene {
  std::string title;
  std::uint64_t seed = 1;
  MassModel mass_model = MassModel::mesh;
  std::string pile;  ///< result file whose last snapshot supplies the bodies; empty: none
  Frame frame;       ///< where the scene's zero is, and how it moves
  std::optional<BoxSpec> box;
  std::vector<LatticeSpec> lattices;
  std::vector<CloudSpec> clouds;
  std::vector<BodySpec> bodies;
  std::vector<WallSpec> walls;
  std::vector<Material> materials;
  ContactSpec contact;
  GravitySpec gravity;
  std::vector<PerturberSpec> perturbers;
  std::vector<StageSpec> stages;
  OutputSpec output;

  std::string text;                 ///< the scene file as read
  SourceMap sources;                ///< where each key stands in it, for errors found later
  std::filesystem::path directory;  ///< where relative paths start
  InputFiles files;                 ///< that it names
};

/// Reads and validates a scene. Every key is checked against the key table (see scene_keys.cpp).
/// @throws InputError with one line: file, line, column, key, what was expected.
Scene load_scene(const std::filesystem::path& path);

/// The same from text already in memory (a result file carries its scene); `sources` names the file, or the
/// two that it comes from.
Scene parse_scene(const std::string& text, SourceMap sources, const std::filesystem::path& directory);
Scene parse_scene(const std::string& text, const std::string& name, const std::filesystem::path& directory);

/// What other tables and the columns of the series call wall `wall`: its name, or its number.
std::string wall_name(const Scene& scene, std::size_t wall);

/// The words for kinds of walls.
const std::vector<std::pair<std::string, WallKind>>& wall_kinds();

/// What messages call it: "wall 'lid' (plane, scene.toml:12)", with its number where it has no name.
std::string describe_wall(const Scene& scene, std::size_t wall);

/// Whether bodies and walls can touch in stage `stage`, were they to meet.
bool contacts_of(const Scene& scene, std::size_t stage);

/// Whether wall `wall` is there in stage `stage`; without contacts none is.
bool has_wall(const Scene& scene, std::size_t stage, std::size_t wall);

/// Self-gravity and the uniform field (m/s^2) in stage `stage`.
GravityMethod gravity_of(const Scene& scene, std::size_t stage);
Vec3 field_of(const Scene& scene, std::size_t stage);

/// Simulated time (s) of all stages together, at most.
double total_duration(const Scene& scene);

/// The reference of all scene keys: name, type, unit, default, bounds, help; made from the key table.
std::string scene_reference();

}  // namespace cairn
