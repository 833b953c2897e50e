#include "io/scene_keys.h"

#include "contact/box.h"
#include "shape/shape_file.h"

namespace cairn {
namespace {

// Bounds keep honest scenes in and products of a few such numbers far from overflow.
constexpr Bounds kName = within(1, 64);
constexpr Bounds kReference = within(0, 64);
constexpr Bounds kPath = within(1, 4096);
constexpr Bounds kPosition = magnitude(1e15);
constexpr Bounds kVelocity = magnitude(3e8);
constexpr Bounds kSize = within(1e-9, 1e9);
constexpr Bounds kDensity = within(1e-6, 1e9);
constexpr Bounds kFraction = within(0, 1);
constexpr Bounds kCoefficient = within(0, 1e6);
constexpr Bounds kTime = within(0, 1e15);
constexpr Bounds kDuration = above(0, 1e15);
constexpr Bounds kStiffness = above(0, 1e20);
constexpr Bounds kAngle = magnitude(1e6);
constexpr Bounds kGm = above(0, 1e30);

const char* const kMaterialHelp =
    "name of a [[material]]; may be left out when there is one, or none (then the nominal material is used)";

const Keys<ShapeChoice> kShapeKeys = {
    text("shape", &ShapeChoice::shape, kPath, "library name, or path of a shape file").required(),
    number("weight", &ShapeChoice::weight, "", within(0, 1e12), "relative number of bodies of this shape"),
};

const Keys<MotionSpec> kMotionKeys = {
    vector("velocity", &MotionSpec::velocity, "m/s", kVelocity, "of a translation that never ends"),
    vector("oscillation_amplitude", &MotionSpec::oscillation_amplitude, "m", kPosition,
           "displacement from the place given: amplitude sin(2 pi frequency t + phase)"),
    number("oscillation_frequency", &MotionSpec::oscillation_frequency, "Hz", above(0, 1e9),
           "required with an amplitude"),
    number("oscillation_phase", &MotionSpec::oscillation_phase, "rad", magnitude(1e6), "at time 0"),
    vector("angular_velocity", &MotionSpec::angular_velocity, "rad/s", magnitude(1e9),
           "of a rotation about an axis through rotation_point"),
    vector("rotation_point", &MotionSpec::rotation_point, "m", kPosition,
           "takes part in translation and oscillation; absent: the place of the body, cloud or region"),
};

const char* const kHeldHelp =
    "Given, if only as {}: bodies at rest or in this motion, whatever acts on them. They touch all others, "
    "but not each other, and walls only when a load moves these.";
const char* const kWallsHelp =
    "names of the walls that touch, numbers of those without a name; []: none; absent: all";

const Keys<CloudSpec> kCloudKeys = {
    tables("shape", &CloudSpec::shapes, kShapeKeys, "One shape of the mixture.").required(),
    integer("count", &CloudSpec::count, "", within(1, 10'000'000), "number of bodies").required(),
    number("filling", &CloudSpec::filling, "", above(0, 0.3),
           "volume of the bodies' bounding spheres over the volume of the ball"),
    choice("distribution", &CloudSpec::distribution,
           {{"single", SizeDistribution::single},
            {"uniform", SizeDistribution::uniform},
            {"log_normal", SizeDistribution::log_normal},
            {"power_law", SizeDistribution::power_law}},
           "distribution of the sizes"),
    number("size", &CloudSpec::size, "m", kSize, "size of every body, or the smallest; scales the shape")
        .required(),
    number("size_max", &CloudSpec::size_max, "m", kSize, "the largest size; required unless 'single'"),
    number("exponent", &CloudSpec::exponent, "", magnitude(20),
           "power_law only: differential number of bodies ~ size^-exponent"),
    number("median", &CloudSpec::median, "m", kSize,
           "log_normal, which requires it: median size before the limits cut the distribution"),
    number("sigma", &CloudSpec::sigma, "", within(1e-3, 10),
           "log_normal, which requires it: standard deviation of the logarithm of the size"),
    number("density", &CloudSpec::density, "kg/m^3", kDensity, "density of the bodies' material").required(),
    text("material", &CloudSpec::material, kReference, kMaterialHelp),
    vector("position", &CloudSpec::position, "m", kPosition, "centre of the ball"),
    vector("velocity", &CloudSpec::velocity, "m/s", kVelocity, "velocity of the centre"),
    number("spin_period", &CloudSpec::spin_period, "s", kTime,
           "period of a rigid rotation about z through the centre; 0: none"),
    number(
        "hole", &CloudSpec::hole, "m", within(0, 1e9),
        "radius of a ball in the middle that stays free, for a core from elsewhere; not counted in filling"),
    table("held", &CloudSpec::held, kMotionKeys, kHeldHelp),
    texts("walls", &CloudSpec::walls, kName, kWallsHelp),
};

const Keys<RegionSpec> kRegionKeys = {
    choice("kind", &RegionSpec::kind,
           {{"ball", RegionKind::ball},
            {"ellipsoid", RegionKind::ellipsoid},
            {"box", RegionKind::box},
            {"mesh", RegionKind::mesh}},
           "what bounds the region; the surface itself is not in it")
        .required(),
    number("radius", &RegionSpec::radius, "m", kSize, "ball, which requires it"),
    vector("size", &RegionSpec::size, "m", kSize,
           "ellipsoid and box, which require it: full extents; mesh: stretched to these extents"),
    text("file", &RegionSpec::file, kPath,
         "mesh, which requires it: path of a mesh file (OBJ, STL, PLY, OFF, a table of facets or radii), a "
         "closed "
         "surface"),
    number("unit", &RegionSpec::unit, "m", within(1e-9, 1e9), "mesh only: unit of the lengths in the file"),
    choice(
        "frame", &RegionSpec::frame,
        {{"file", MeshFrame::file}, {"centroid", MeshFrame::centroid}, {"principal", MeshFrame::principal}},
        "mesh only: as in the file; with its centroid at the origin; and turned, z the axis of the greatest "
        "moment of inertia, x of the least"),
    vector("position", &RegionSpec::position, "m", kPosition, "of the centre, or of a mesh's origin"),
    quaternion("orientation", &RegionSpec::orientation, magnitude(1e6),
               "w, x, y, z: rotation about that place; any length but zero"),
};

const Keys<LatticeSpec> kLatticeKeys = {
    choice("kind", &LatticeSpec::kind,
           {{"hcp", LatticeKind::hcp}, {"fcc", LatticeKind::fcc}, {"sc", LatticeKind::sc}},
           "hexagonal close packed, face-centred cubic or simple cubic"),
    text("shape", &LatticeSpec::shape, kPath, "library name, or path of a shape file"),
    number("size", &LatticeSpec::size, "m", kSize, "scales the shape").required(),
    number("density", &LatticeSpec::density, "kg/m^3", kDensity, "density of the bodies' material")
        .required(),
    text("material", &LatticeSpec::material, kReference, kMaterialHelp),
    number("spacing", &LatticeSpec::spacing, "m", kSize,
           "between nearest sites; absent: that at which bounding spheres touch"),
    flag("random_orientation", &LatticeSpec::random_orientation, "turn each body at random"),
    table("region", &LatticeSpec::region, kRegionKeys,
          "Where sites have bodies; a site is at its position, the lattice turns with it.")
        .required(),
    table("held", &LatticeSpec::held, kMotionKeys, kHeldHelp),
    texts("walls", &LatticeSpec::walls, kName, kWallsHelp),
};

const Keys<BodySpec> kBodyKeys = {
    text("shape", &BodySpec::shape, kPath, "library name, or path of a shape file").required(),
    number("size", &BodySpec::size, "m", kSize, "scales the shape"),
    number("density", &BodySpec::density, "kg/m^3", kDensity, "mean density of the body; this or mass"),
    number("mass", &BodySpec::mass, "kg", above(0, 1e36), "of the body, whatever its volume"),
    text("material", &BodySpec::material, kReference, kMaterialHelp),
    vector("position", &BodySpec::position, "m", kPosition, "centre of mass"),
    vector("velocity", &BodySpec::velocity, "m/s", kVelocity, "velocity of the centre of mass"),
    vector("angular_velocity", &BodySpec::angular_velocity, "rad/s", magnitude(1e9), "in the space frame"),
    quaternion("orientation", &BodySpec::orientation, magnitude(1e6),
               "w, x, y, z: rotation from the frame of the shape file to space; any length but zero"),
    table("held", &BodySpec::held, kMotionKeys, kHeldHelp),
    texts("walls", &BodySpec::walls, kName, kWallsHelp),
};

const Keys<Frame> kFrameKeys = {
    vector("position", &Frame::position, "m", kPosition, "of the zero at the start"),
    vector("velocity", &Frame::velocity, "m/s", kVelocity, "of the zero"),
};

const Keys<BoxSpec> kBoxKeys = {
    vector("size", &BoxSpec::size, "m", within(0, kWidestBox),
           "edges along x, y, z; 0: open in that direction; all 0: those of the pile's box at its end"),
};

const Keys<WallSpec> kWallKeys = {
    text("name", &WallSpec::name, kName,
         "what messages, other tables and the series call it (wall_NAME_force_x ...): letters, digits, '_', "
         "'-'; absent: its number, from 0"),
    choice("kind", &WallSpec::kind, wall_kinds(),
           "shape of the wall; a cylinder is infinite along its axis, both sides of a mesh are solid")
        .required(),
    text("material", &WallSpec::material, kReference, kMaterialHelp),
    vector(
        "point", &WallSpec::point, "m", kPosition,
        "a point of the plane or of the cylinder's axis, the sphere's centre, where a mesh's origin is put"),
    vector("normal", &WallSpec::normal, "", magnitude(1e6),
           "plane only: points to the side where the bodies are; any length but zero"),
    vector("axis", &WallSpec::axis, "", magnitude(1e6), "cylinder only: direction; any length but zero"),
    number("radius", &WallSpec::radius, "m", kSize, "sphere and cylinder, which require it"),
    choice("side", &WallSpec::side, {{"inside", WallSide::inside}, {"outside", WallSide::outside}},
           "sphere and cylinder: where the bodies are"),
    text("file", &WallSpec::file, kPath,
         "mesh, which requires it: path of a mesh file (OBJ, STL, PLY, OFF, a table of facets or radii)"),
    number("unit", &WallSpec::unit, "m", within(1e-9, 1e9), "mesh only: unit of the lengths in the file"),
    vector("velocity", &WallSpec::velocity, "m/s", kVelocity, "of a translation that never ends"),
    vector("oscillation_amplitude", &WallSpec::oscillation_amplitude, "m", kPosition,
           "displacement from the place given: amplitude sin(2 pi frequency t + phase)"),
    number("oscillation_frequency", &WallSpec::oscillation_frequency, "Hz", above(0, 1e9),
           "required with an amplitude"),
    number("oscillation_phase", &WallSpec::oscillation_phase, "rad", magnitude(1e6), "at time 0"),
    vector("angular_velocity", &WallSpec::angular_velocity, "rad/s", magnitude(1e9),
           "of a rotation about an axis through rotation_point"),
    vector("rotation_point", &WallSpec::rotation_point, "m", kPosition,
           "takes part in translation and oscillation; torques on the wall are about it; absent: point"),
    number(
        "motion_time", &WallSpec::motion_time, "s", kTime,
        "how long it has moved so when it begins; absent: 0, or as long as the same wall at the end of the "
        "run that the pile comes from"),
    number("load", &WallSpec::load, "N", magnitude(1e30),
           "force that moves the wall along load_axis, against the bodies: load_mass x acceleration is load, "
           "what the bodies do along the axis, and -load_damping x speed. The automatic stiffness bears its "
           "fall on the nearest body, load x distance, unless impact_speed is given"),
    vector("load_axis", &WallSpec::load_axis, "", magnitude(1e6),
           "direction of the load, any length but zero; absent: the normal of a plane; others require it"),
    number("load_mass", &WallSpec::load_mass, "kg", above(0, 1e30), "required with a load"),
    number("load_damping", &WallSpec::load_damping, "kg/s", within(0, 1e30), "with a load"),
    texts(
        "stages", &WallSpec::stages, kName,
        "names of the stages in which the wall is there, its motion counted from the start of the first; "
        "empty: all, from the start of the run. A wall that a load moves stays where it was while it is left "
        "out, and comes back at rest"),
};

const Keys<Material> kMaterialKeys = {
    text("name", &Material::name, kName, "what other tables call it").required(),
    number("restitution_normal", &Material::restitution_normal, "", kFraction, "e_n"),
    number("restitution_tangential", &Material::restitution_tangential, "", kFraction, "e_t"),
    number("friction", &Material::friction, "", kCoefficient, "mu_S, Coulomb sliding coefficient"),
    number("friction_rolling", &Material::friction_rolling, "", kCoefficient, "mu_R"),
    number("friction_twisting", &Material::friction_twisting, "", kCoefficient, "mu_T"),
    number("shape_factor", &Material::shape_factor, "", within(0, 10),
           "beta, radius of the contact area over the effective radius"),
    number("cohesion", &Material::cohesion, "Pa", within(0, 1e15), "c, interparticle tensile strength"),
    number(
        "stiffness", &Material::stiffness, "N/m", kStiffness,
        "k_N of a contact of two such surfaces, whatever the stage's; absent: that of the stage. The springs "
        "of a pair act in series, k = 2 / (1/k_a + 1/k_b), also those of a wall; k_S likewise"),
    number("stiffness_ratio", &Material::stiffness_ratio, "", above(0, 10),
           "k_S / k_N of a contact of two such surfaces; the twisting stiffness follows, 2 k_S (beta R)^2"),
};

const Keys<ContactSpec> kContactKeys = {
    flag("enabled", &ContactSpec::enabled,
         "false: no contacts, bodies pass through each other and through walls; as where nothing can touch "
         "(one "
         "body, no walls), no stiffness is needed"),
    number("stiffness", &ContactSpec::stiffness, "N/m", kStiffness,
           "normal k_N of materials without a stiffness of their own; chosen by the program when absent"),
    number(
        "time_step", &ContactSpec::time_step, "s", kDuration,
        "when absent a part of the shortest contact; without contacts a hundredth of the shortest time in "
        "which "
        "motion changes (two bodies side by side, the passage of a perturber, a turn by 1 rad), which leaves "
        "errors near 1e-5 of orbits' and turns' angles"),
    flag("unsafe_time_step", &ContactSpec::unsafe_time_step,
         "accept a time step longer than the longest safe one"),
    number("steps_per_contact", &ContactSpec::steps_per_contact, "", within(4, 1e6),
           "time steps in the shortest contact, for the automatic time step"),
    number("max_overlap", &ContactSpec::max_overlap, "", above(0, 0.5),
           "aimed at by the automatic stiffness, over the smallest radius"),
    number("overlap_limit", &ContactSpec::overlap_limit, "", above(0, 1),
           "a larger overlap stops the run, over the smaller radius of the pair"),
    choice("damping_mass", &ContactSpec::damping_mass,
           {{"bodies", DampingMass::bodies}, {"spheres", DampingMass::spheres}},
           "effective mass that turns restitution into damping: of the two bodies, or of the two spheres"),
    choice("rolling_slip", &ContactSpec::rolling_slip,
           {{"none", RollingSlip::none}, {"zhang2017", RollingSlip::zhang2017}},
           "sliding term in the rolling velocity: left out, or as printed by Zhang et al. 2017, eq. 8"),
};

const std::vector<std::pair<std::string, GravityMethod>> kGravityMethods = {
    {"none", GravityMethod::none}, {"direct", GravityMethod::direct}, {"tree", GravityMethod::tree}};

const Keys<GravitySpec> kGravityKeys = {
    choice("method", &GravitySpec::method, kGravityMethods,
           "self-gravity: none, the exact pair sum, or the fast method"),
    number("error", &GravitySpec::error, "", within(1e-8, 0.1),
           "rms error of the tree's field over the rms field; measured at the start of each stage"),
    number("opening_angle", &GravitySpec::opening_angle, "", above(0, 1),
           "of the tree, by hand instead of 'error'; smaller is more accurate"),
    integer("order", &GravitySpec::order, "", within(4, 7),
            "of the tree's expansions, with opening_angle; higher is more accurate"),
    interval("interval", &GravitySpec::interval, above(0, 1e6),
             "between evaluations: as rarely as 'error' allows, in time steps, or in seconds"),
    vector("field", &GravitySpec::field, "m/s^2", magnitude(1e12), "uniform external field"),
};

const Keys<OrbitSpec> kOrbitKeys = {
    number("eccentricity", &OrbitSpec::eccentricity, "", within(0, 1e6), "1: parabola, above: hyperbola")
        .required(),
    number("periapsis", &OrbitSpec::periapsis, "m", above(0, 1e15),
           "distance of the periapsis; this or semi_major_axis"),
    number("semi_major_axis", &OrbitSpec::semi_major_axis, "m", magnitude(1e15),
           "negative for a hyperbola; a parabola has none"),
    number("inclination", &OrbitSpec::inclination, "rad", kAngle, "of the orbit's plane to x y"),
    number("node", &OrbitSpec::node, "rad", kAngle, "direction of the ascending node, from x"),
    number("argument", &OrbitSpec::argument, "rad", kAngle, "of the periapsis, from the node"),
    number("periapsis_time", &OrbitSpec::periapsis_time, "s", magnitude(1e15),
           "time of a passage through the periapsis"),
    number("mean_anomaly", &OrbitSpec::mean_anomaly, "rad", magnitude(1e9),
           "at time 0, instead of periapsis_time; a parabola has none"),
    number("gm", &OrbitSpec::gm, "m^3/s^2", kGm,
           "gravitational parameter of the motion; absent: that of the perturber and the bodies together"),
};

const Keys<PerturberSpec> kPerturberKeys = {
    text("name", &PerturberSpec::name, kName, "what messages call it").required(),
    number("mass", &PerturberSpec::mass, "kg", above(0, 1e40), "this or gm"),
    number("gm", &PerturberSpec::gm, "m^3/s^2", kGm, "gravitational parameter"),
    number("radius", &PerturberSpec::radius, "m", within(0, 1e15),
           "a sphere that touches the ball of this radius stops the run"),
    flag("tidal", &PerturberSpec::tidal,
         "true: the zero of the frame falls freely in its pull, which acts less the pull on the zero; false: "
         "the zero is inertial and the whole pull acts"),
    vector("position", &PerturberSpec::position, "m", kPosition,
           "of one at rest; this, orbit, track or track_file"),
    table("orbit", &PerturberSpec::orbit, kOrbitKeys,
          "Kepler orbit of the perturber about the zero of the scene's frame. The zero is on the same orbit "
          "about the perturber, with the argument larger by pi."),
    rows("track", &PerturberSpec::track, {4, 7}, "s, m, m/s", magnitude(1e15),
         "places [t, x, y, z] or with velocities [t, x, y, z, vx, vy, vz], from the zero of the scene's "
         "frame; cubics between, times increase and cover the run"),
    text("track_file", &PerturberSpec::track_file, kPath,
         "path of a text file of such rows; '#' begins a comment"),
};

const Keys<SpinSpec> kSpinKeys = {
    pairs("path", &SpinSpec::path, &SpinPoint::time, &SpinPoint::period, "s", kTime,
          "[time since the start of the stage, spin period]; linear between, times increase")
        .required(),
    number("ramp", &SpinSpec::ramp, "s", kTime,
           "time in which the spin rate goes over smoothly from that of the pile to the path's, which is not "
           "shifted; 0: in one step"),
    number("control_interval", &SpinSpec::control_interval, "s", kTime, "between corrections; 0: every step"),
    number(
        "check_interval", &SpinSpec::check_interval, "s", kDuration,
        "between looks at the pile: which bodies belong to it, and has it failed; absent: the time in which "
        "the path's period changes by 0.001 h, at most a twentieth of 1/sqrt(4 pi G rho / 3)"),
    number("remnant_gap", &SpinSpec::remnant_gap, "", within(0, 1e6),
           "bodies closer than this times the smallest radius belong to one pile; the largest is spun"),
    choice("on_failure", &SpinSpec::on_failure, {{"release", OnFailure::release}, {"keep", OnFailure::keep}},
           "after failure the pile is left to itself, or the spin stays prescribed"),
    number("axis_drop", &SpinSpec::axis_drop, "", above(0, 1),
           "failure is this relative fall of the pile's c/a from its value at rest: when control begins, or "
           "when the pile has come to rest under it"),
    number("axis_hold", &SpinSpec::axis_hold, "s", kTime,
           "a fall counts when it has lasted so long, failure is its beginning; absent: a quarter of "
           "1/sqrt(4 pi G rho / 3)"),
    flag("include_shed", &SpinSpec::include_shed, "also spin bodies that have left the pile"),
    number("after_failure", &SpinSpec::after_failure, "s", kTime,
           "the stage ends this long after failure; absent: at its duration"),
};

const Keys<CarveSpec> kCarveKeys = {
    table("region", &CarveSpec::region, kRegionKeys,
          "What stays; its position counts from the mass centre of the bodies that are not held.")
        .required(),
    flag("whole", &CarveSpec::whole,
         "a body belongs to the region if all of its spheres lie in it; false: if its mass centre does"),
    flag("outside", &CarveSpec::outside, "the bodies of the region go, the others stay"),
};

const Keys<ScaleSpec> kScaleKeys = {
    number("density", &ScaleSpec::density, "kg/m^3", kDensity,
           "mass of all bodies over the volume; that of held ones stays as it is")
        .required(),
    choice("by", &ScaleSpec::by, {{"mass", ScaleBy::mass}, {"size", ScaleBy::size}},
           "masses change and lengths stay, or lengths change (the volume's too) and masses stay"),
    number("volume", &ScaleSpec::volume, "m^3", within(1e-30, 1e30),
           "that the bodies fill; absent: that of the region last carved"),
};

const Keys<AssignSpec> kAssignKeys = {
    table(
        "region", &AssignSpec::region, kRegionKeys,
        "Bodies with their mass centre here; its position counts from the mass centre of the bodies that are "
        "not held.")
        .required(),
    flag("outside", &AssignSpec::outside, "the bodies that are not in the region"),
    number("density", &AssignSpec::density, "kg/m^3", kDensity, "their new density"),
    number("density_factor", &AssignSpec::density_factor, "", within(1e-6, 1e6),
           "their new density over the old one"),
    text("material", &AssignSpec::material, kReference, "name of a [[material]], theirs from now on"),
};

const Keys<RelaxSpec> kRelaxKeys = {
    number(
        "rate", &RelaxSpec::rate, "1/s", above(0, 1e12),
        "of the drag; absent: 2 sqrt(k_N / m) / n^(1/3) for a pile of n bodies of mean mass m, at which it "
        "swings as a whole"),
    number(
        "quiet", &RelaxSpec::quiet, "", above(0, 1),
        "the stage ends when the energy of the motion inside the piles is below this times the gravitational "
        "energy (without self-gravity: the elastic energy) at its start, after ten times 1 / rate"),
};

const Keys<StageSpec> kStageKeys = {
    text("name", &StageSpec::name, kName, "of its own").required(),
    number("duration", &StageSpec::duration, "s", kDuration,
           "simulated time, at most; required unless the stage carves, scales or assigns"),
    number("extension", &StageSpec::extension, "s", kTime,
           "the stage goes on so long after its duration, with the time step and intervals that follow from "
           "that; `cairn resume --until` writes it here"),
    text("material", &StageSpec::material, kReference,
         "name of a [[material]] that replaces every body's during the stage; absent: none does"),
    flag("contacts", &StageSpec::contacts,
         "replaces contact.enabled; a stage without contacts forgets those that there were; what their "
         "springs held counts as dissipated"),
    number("impact_speed", &StageSpec::impact_speed, "m/s", within(0, 3e8),
           "for the automatic stiffness; when absent the pile's escape speed, or a settled pile's contacts "
           "stay as they are"),
    number("stiffness", &StageSpec::stiffness, "N/m", kStiffness,
           "replaces contact.stiffness, for materials without a stiffness of their own"),
    number("time_step", &StageSpec::time_step, "s", kDuration, "replaces contact.time_step"),
    table("spin", &StageSpec::spin, kSpinKeys,
          "Prescribed spin of the pile about z [Zhang et al. 2021, section 2.3]."),
    table(
        "relax", &StageSpec::relax, kRelaxKeys,
        "Takes energy out: bodies that touch at the start of the stage are a pile; the motion of its bodies "
        "less the rigid motion of the pile decays at a rate, what it loses is 'relaxed_work'. Momenta stay."),
    vector("strain_rate", &StageSpec::strain_rate, "1/s", magnitude(1e6),
           "growth rate of the edges of the box, d ln(edge)/dt; negative: compression"),
    number(
        "packing", &StageSpec::packing, "", above(0, 10),
        "the strain ends when the volume of the bodies over that of the box is this; absent: with the stage"),
    choice("gravity", &StageSpec::gravity, kGravityMethods, "replaces gravity.method"),
    vector("field", &StageSpec::field, "m/s^2", magnitude(1e12), "replaces gravity.field"),
    number(
        "quiet_energy", &StageSpec::quiet_energy, "", above(0, 1),
        "the stage ends when the kinetic energy, without walls less that of rigid motion, over the size of "
        "the "
        "gravitational energy is below this; not before a tenth of duration"),
    number("quiet_speed", &StageSpec::quiet_speed, "m/s", above(0, 1e6),
           "the same for the rms speed that belongs to that energy"),
    number("quiet_interval", &StageSpec::quiet_interval, "s", kDuration,
           "between looks at these; absent: 200 steps"),
    table("carve", &StageSpec::carve, kCarveKeys,
          "Takes bodies away; the stage does only this, and no time passes."),
    table("scale", &StageSpec::scale, kScaleKeys,
          "Gives the bodies a bulk density; the stage does only this, and no time passes."),
    table("assign", &StageSpec::assign, kAssignKeys,
          "Gives bodies another density or material; the stage does only this, and no time passes."),
};

const Keys<OutputSpec> kOutputKeys = {
    number("snapshot_interval", &OutputSpec::snapshot_interval, "s", kTime,
           "of simulated time; 0: only the ends of stages"),
    number("series_interval", &OutputSpec::series_interval, "s", kTime,
           "of simulated time; 0: a thousandth of each stage, or two hundred steps if that is longer"),
    number("checkpoint_interval", &OutputSpec::checkpoint_interval, "s", within(1, 1e9),
           "of wall-clock time"),
    number("remnant_gap", &OutputSpec::remnant_gap, "", within(0, 1e6),
           "bodies closer than this times the smallest radius belong together, in what is written"),
    number("interior", &OutputSpec::interior, "m", within(0, 1e12),
           "the packing is measured on spheres this close to the mass centre; 0: 3/8 of the shortest extent"),
};

const Keys<Scene> kSceneKeys = {
    text("title", &Scene::title, within(0, 200), "one line about the scene"),
    integer("seed", &Scene::seed, "", Bounds{.low = 0}, "of every random number"),
    choice(
        "mass_model", &Scene::mass_model, kMassModelNames,
        "whose mass a body has: the mesh's that its spheres stand for (union if there is none), the covered "
        "volume's, counted once, or each sphere's fully"),
    text("pile", &Scene::pile, kPath, "result file whose last snapshot supplies the bodies; absent: none"),
    table("frame", &Scene::frame, kFrameKeys,
          "Where the zero of all positions and velocities of the scene is; changes no result, recorded in "
          "the result file. A double has 16 digits: for bodies 1.5e11 m away give this, and positions from "
          "here."),
    table("box", &Scene::box, kBoxKeys, "A periodic box: bodies meet the images of others one edge away."),
    tables("lattice", &Scene::lattices, kLatticeKeys, "Bodies of one kind on a lattice."),
    tables("cloud", &Scene::clouds, kCloudKeys,
           "A ball of bodies at random positions and orientations, without overlap."),
    tables("body", &Scene::bodies, kBodyKeys, "One body put by hand."),
    tables("wall", &Scene::walls, kWallKeys, "A wall, fixed or moved as prescribed, or by a load."),
    tables("material", &Scene::materials, kMaterialKeys,
           "Surface of bodies and walls. A pair takes geometric means, of beta the arithmetic mean, of "
           "stiffnesses those of springs in series."),
    table("contact", &Scene::contact, kContactKeys, "The contact law and its time step."),
    table("gravity", &Scene::gravity, kGravityKeys, "Self-gravity and uniform field."),
    tables("perturber", &Scene::perturbers, kPerturberKeys,
           "A point mass outside the bodies that pulls on every sphere: a planet, the Sun."),
    tables("stage", &Scene::stages, kStageKeys,
           "A stretch of the run with its own settings; stages follow each other.")
        .required(),
    table("output", &Scene::output, kOutputKeys, "What is written, and how often."),
};

}  // namespace

const Keys<Scene>& scene_keys() {
  return kSceneKeys;
}

}  // namespace cairn
