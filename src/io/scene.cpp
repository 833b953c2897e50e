#include "io/scene.h"

#include <algorithm>
#include <set>

#include "core/suggest.h"
#include "io/scene_keys.h"
#include "io/toml_file.h"

namespace cairn {
namespace {

// What one key alone cannot tell: references between tables, sums, orders and directions.
class Checks {
 public:
  explicit Checks(Scene& scene) : scene_(scene) {}

  void run() {
    check_materials();
    for (std::size_t i = 0; i < scene_.lattices.size(); ++i)
      check_lattice(scene_.lattices[i], fmt::format("lattice[{}]", i));
    for (std::size_t i = 0; i < scene_.clouds.size(); ++i)
      check_cloud(scene_.clouds[i], fmt::format("cloud[{}]", i));
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      check_body(scene_.bodies[i], fmt::format("body[{}]", i));
    check_wall_names();
    for (std::size_t i = 0; i < scene_.walls.size(); ++i)
      check_wall(scene_.walls[i], fmt::format("wall[{}]", i));
    check_contact();
    check_gravity();
    for (std::size_t i = 0; i < scene_.perturbers.size(); ++i)
      check_perturber(scene_.perturbers[i], fmt::format("perturber[{}]", i));
    check_stages();
    if (scene_.box) check_box(scene_.box->size);
    if (scene_.pile.empty() && scene_.lattices.empty() && scene_.clouds.empty() && scene_.bodies.empty())
      throw error("", "the scene has no bodies; expected 'pile', [[lattice]], [[cloud]] or [[body]]");
  }

 private:
  template <class... Args>
  [[nodiscard]] InputError error(const std::string& key, fmt::format_string<Args...> what,
                                 Args&&... args) const {
    return scene_.sources.error(key, fmt::format(what, std::forward<Args>(args)...));
  }

  bool given(const std::string& key) const { return scene_.sources.has(key); }

  void check_materials() {
    if (scene_.materials.empty()) scene_.materials.push_back({.name = "nominal"});
    for (const Material& material : scene_.materials)
      if (!materials_.insert(material.name).second)
        throw error(fmt::format("material[{}].name", materials_.size()),
                    "expected a name of its own, found '{}' for a second time", material.name);
  }

  std::vector<std::string> material_names() const { return {materials_.begin(), materials_.end()}; }

  void check_reference(const std::string& name, const std::string& key) const {
    if (materials_.contains(name)) return;
    const std::string near = nearest_name(name, material_names());
    throw error(key, "no [[material]] is called '{}'; {}", name,
                near.empty() ? "expected " + alternatives(material_names())
                             : fmt::format("did you mean '{}'?", near));
  }

  void complete_material(std::string& name, const std::string& owner) const {
    const std::string key = owner + ".material";
    if (name.empty() && materials_.size() > 1)
      throw error(key, "missing key; required because there are several materials, expected {}",
                  alternatives(material_names()));
    if (name.empty()) name = *materials_.begin();
    check_reference(name, key);
  }

  void check_cloud(CloudSpec& cloud, const std::string& key) const {
    complete_material(cloud.material, key);
    check_bonds(cloud, key, {".velocity", ".spin_period"});
    double weights = 0.0;
    for (const ShapeChoice& shape : cloud.shapes) weights += shape.weight;
    if (weights <= 0.0) throw error(key + ".shape", "expected a positive sum of weights, found 0");
    const bool single = cloud.distribution == SizeDistribution::single;
    if (single && given(key + ".size_max"))
      throw error(key + ".size_max", "has no effect with the distribution 'single'");
    if (!single && !given(key + ".size_max"))
      throw error(key + ".size_max", "missing key; required unless the distribution is 'single'");
    if (!single && cloud.size_max < cloud.size)
      throw error(key + ".size_max", "expected at least the size of {} m, found {}", show(cloud.size),
                  show(cloud.size_max));
    if (cloud.distribution != SizeDistribution::power_law && given(key + ".exponent"))
      throw error(key + ".exponent", "has no effect unless the distribution is 'power_law'");
    for (const char* name : {".median", ".sigma"})
      if (cloud.distribution == SizeDistribution::log_normal)
        require(key + name, "the distribution is 'log_normal'");
      else if (given(key + name))
        throw error(key + name, "has no effect unless the distribution is 'log_normal'");
  }

  /// Whether keys of a table belong to its kind.
  void belongs(const std::string& key, bool fits, const char* kinds) const {
    if (!fits && given(key)) throw error(key, "has no effect unless the kind is {}", kinds);
  }

  void check_region(RegionSpec& region, const std::string& key) const {
    const bool mesh = region.kind == RegionKind::mesh, ball = region.kind == RegionKind::ball;
    belongs(key + ".radius", ball, "'ball'");
    belongs(key + ".size", !ball, "'ellipsoid', 'box' or 'mesh'");
    belongs(key + ".file", mesh, "'mesh'");
    belongs(key + ".unit", mesh, "'mesh'");
    belongs(key + ".frame", mesh, "'mesh'");
    if (ball) require(key + ".radius", "the kind is 'ball'");
    if (mesh) require(key + ".file", "the kind is 'mesh'");
    if (!ball && !mesh) require(key + ".size", "the kind is 'ellipsoid' or 'box'");
    region.orientation.coeffs() =
        direction<Eigen::Vector4d>(region.orientation.coeffs(), key + ".orientation");
  }

  void check_lattice(LatticeSpec& lattice, const std::string& key) const {
    complete_material(lattice.material, key);
    check_bonds(lattice, key, {});
    check_region(lattice.region, key + ".region");
  }

  void check_body(BodySpec& body, const std::string& key) const {
    complete_material(body.material, key);
    check_one_of(key, {"density", "mass"}, true);
    check_bonds(body, key, {".velocity", ".angular_velocity"});
    body.orientation.coeffs() = direction<Eigen::Vector4d>(body.orientation.coeffs(), key + ".orientation");
  }

  /// Columns of the series are called by these names.
  void check_wall_names() const {
    std::set<std::string> names;
    for (std::size_t i = 0; i < scene_.walls.size(); ++i) {
      const std::string key = fmt::format("wall[{}].name", i), &name = scene_.walls[i].name;
      constexpr const char* digits = "0123456789";
      if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
          name.npos)
        throw error(key, "expected letters, digits, '_' and '-' only, found '{}'", name);
      if (given(key) && name.find_first_not_of(digits) == name.npos)
        throw error(key, "expected more than digits, which stand for walls without a name, found '{}'", name);
      if (given(key) && !names.insert(name).second)
        throw error(key, "expected a name of its own, found '{}' for a second time", name);
    }
    for (std::size_t i = 0; i < scene_.walls.size(); ++i)
      if (const std::string& name = scene_.walls[i].name;
          name.ends_with("_mean") && names.contains(name.substr(0, name.size() - 5)))
        throw error(fmt::format("wall[{}].name", i),
                    "found '{}' beside '{}', whose columns of the series have such names; expected another",
                    name, name.substr(0, name.size() - 5));
  }

  void check_wall(WallSpec& wall, const std::string& key) const {
    complete_material(wall.material, key);
    const bool plane = wall.kind == WallKind::plane, cylinder = wall.kind == WallKind::cylinder,
               mesh = wall.kind == WallKind::mesh, round = cylinder || wall.kind == WallKind::sphere;
    belongs(key + ".normal", plane, "'plane'");
    belongs(key + ".axis", cylinder, "'cylinder'");
    belongs(key + ".radius", round, "'sphere' or 'cylinder'");
    belongs(key + ".side", round, "'sphere' or 'cylinder'");
    belongs(key + ".file", mesh, "'mesh'");
    belongs(key + ".unit", mesh, "'mesh'");
    if (round) require(key + ".radius", "the kind is 'sphere' or 'cylinder'");
    if (mesh) require(key + ".file", "the kind is 'mesh'");
    wall.normal = direction<Vec3>(wall.normal, key + ".normal");
    wall.axis = direction<Vec3>(wall.axis, key + ".axis");

    check_oscillation(key);
    check_load(wall, key);
    if (wall.motion_time && wall.velocity == Vec3::Zero() && wall.angular_velocity == Vec3::Zero() &&
        wall.oscillation_amplitude == Vec3::Zero())
      throw error(key + ".motion_time",
                  "has no effect without a motion that is prescribed; expected velocity, "
                  "oscillation_amplitude or angular_velocity beside it{}",
                  wall.load ? ", a load moves the wall from its place" : "");
    if (!given(key + ".rotation_point")) wall.rotation_point = wall.point;
    for (std::size_t i = 0; i < wall.stages.size(); ++i) {
      std::vector<std::string> names;
      for (const StageSpec& stage : scene_.stages) names.push_back(stage.name);
      if (std::find(names.begin(), names.end(), wall.stages[i]) == names.end())
        throw error(key + ".stages", "no [[stage]] is called '{}'; expected some of {}", wall.stages[i],
                    alternatives(names));
      const auto stage = std::find(names.begin(), names.end(), wall.stages[i]) - names.begin();
      if (!contacts_of(scene_, static_cast<std::size_t>(stage)))
        throw error(key + ".stages", "has no effect in stage '{}', which has no contacts", wall.stages[i]);
    }
  }

  void check_oscillation(const std::string& key) const {
    const bool oscillates = given(key + ".oscillation_amplitude");
    for (const char* name : {".oscillation_frequency", ".oscillation_phase"})
      if (!oscillates && given(key + name))
        throw error(key + name, "has no effect without oscillation_amplitude");
    if (oscillates) require(key + ".oscillation_frequency", "there is an oscillation_amplitude");
  }

  void check_load(WallSpec& wall, const std::string& key) const {
    if (!wall.load) {
      for (const char* name : {".load_axis", ".load_mass", ".load_damping"})
        if (given(key + name)) throw error(key + name, "has no effect without load");
      return;
    }
    require(key + ".load_mass", "there is a load");
    if (wall.kind != WallKind::plane)
      require(key + ".load_axis", "there is a load, and the kind is not 'plane'");
    wall.load_axis =
        given(key + ".load_axis") ? direction<Vec3>(wall.load_axis, key + ".load_axis") : wall.normal;
    constexpr double small = 1e-9;
    const auto across = [&](const char* name, const Vec3& v) {
      if (std::abs(v.dot(wall.load_axis)) > small * v.norm())
        throw error(key + name, "expected a direction across load_axis, along which the load moves the wall");
    };
    across(".velocity", wall.velocity);
    across(".oscillation_amplitude", wall.oscillation_amplitude);
  }

  /// Keys that say what does not act on bodies; `own` are keys of their free motion.
  template <class Spec>
  void check_bonds(const Spec& spec, const std::string& key, std::initializer_list<const char*> own) const {
    if (spec.held) {
      check_oscillation(key + ".held");
      if (spec.held->rotation_point && spec.held->angular_velocity == Vec3::Zero())
        throw error(key + ".held.rotation_point",
                    "has no effect without a rotation; expected angular_velocity beside it");
      for (const char* name : own)
        if (given(key + name))
          throw error(key + name, "has no effect on what is held; expected it in 'held'");
    }
    if (!spec.walls) return;
    std::vector<std::string> names;
    for (std::size_t w = 0; w < scene_.walls.size(); ++w) names.push_back(wall_name(scene_, w));
    for (const std::string& name : *spec.walls)
      if (std::find(names.begin(), names.end(), name) == names.end())
        throw error(key + ".walls", "no [[wall]] is called '{}'; {}", name,
                    names.empty() ? "the scene has none" : "expected some of " + alternatives(names));
  }

  void require(const std::string& key, const char* reason) const {
    if (!given(key)) throw error(key, "missing key; required because {}", reason);
  }

  // A vector so short that its direction may be round-off counts as zero.
  template <class V>
  V direction(const V& vector, const std::string& key) const {
    constexpr double shortest = 1e-9;
    if (vector.norm() < shortest) throw error(key, "expected a vector other than zero");
    return vector.normalized();
  }

  void check_contact() const {
    const ContactSpec& contact = scene_.contact;
    if (contact.overlap_limit < contact.max_overlap)
      throw error(given("contact.overlap_limit") ? "contact.overlap_limit" : "contact.max_overlap",
                  "expected max_overlap <= overlap_limit, found {} and {}", show(contact.max_overlap),
                  show(contact.overlap_limit));
    if (given("contact.stiffness")) check_stiffness_counts("contact.stiffness", {});
    for (std::size_t i = 0; i < scene_.stages.size(); ++i)
      if (!scene_.stages[i].operates() && contacts_of(scene_, i)) return;
    // None of the stages has contacts.
    for (const char* name : {"stiffness", "unsafe_time_step", "steps_per_contact", "max_overlap",
                             "overlap_limit", "damping_mass", "rolling_slip"})
      if (const std::string key = std::string("contact.") + name; given(key))
        throw error(key, "has no effect, because no stage has contacts");
    if (!scene_.walls.empty()) throw error("wall[0]", "has no effect, because no stage has contacts");
  }

  /// That some material takes the stiffness of the key; of walls and of bodies, which may all be of
  /// `material`.
  void check_stiffness_counts(const std::string& key, const std::string& material) const {
    for (const Material& m : scene_.materials) {
      const bool on_walls = std::any_of(scene_.walls.begin(), scene_.walls.end(),
                                        [&](const WallSpec& wall) { return wall.material == m.name; });
      if (!m.stiffness && (material.empty() || m.name == material || on_walls)) return;
    }
    throw error(key, "has no effect, because {} a stiffness of {} own",
                material.empty() ? "every material has" : "the materials of the stage have",
                material.empty() ? "its" : "their");
  }

  /// Keys of a stage that only contacts give a meaning.
  void check_without_contacts(const std::string& key) const {
    for (const char* name : {".material", ".impact_speed", ".stiffness", ".relax"})
      if (given(key + name)) throw error(key + name, "has no effect in a stage without contacts");
  }

  void check_gravity() const {
    if (given("gravity.opening_angle") && given("gravity.error"))
      throw error("gravity.opening_angle", "expected either 'error' or 'opening_angle'");
    if (given("gravity.order") && !given("gravity.opening_angle"))
      throw error("gravity.order", "has no effect without opening_angle; 'error' chooses the order");
  }

  /// At least one, or exactly one, of these keys of the table `owner`.
  void check_one_of(const std::string& owner, const std::vector<std::string>& names, bool needed) const {
    std::vector<std::string> found;
    for (const std::string& name : names)
      if (given(owner + "." + name)) found.push_back(name);
    if (found.size() > 1) throw error(owner + "." + found[1], "expected only one of {}", alternatives(names));
    if (needed && found.empty()) throw error(owner, "expected one of the keys {}", alternatives(names));
  }

  void check_perturber(const PerturberSpec& perturber, const std::string& key) const {
    check_one_of(key, {"mass", "gm"}, true);
    check_one_of(key, {"position", "orbit", "track", "track_file"}, true);
    if (scene_.box) throw error(key, "has no meaning in a periodic box");
    if (perturber.orbit) check_orbit(*perturber.orbit, key + ".orbit");
    if (given(key + ".track"))
      check_track(perturber.track, total_duration(scene_), [&](std::size_t row, const std::string& what) {
        throw error(row < perturber.track.size() ? fmt::format("{}.track[{}]", key, row) : key + ".track",
                    "{}", what);
      });
    if (perturber.tidal && given(key + ".position") && perturber.position == Vec3::Zero())
      throw error(
          key + ".position",
          "expected a place other than the zero, which falls freely in its pull unless tidal = false");
  }

  void check_orbit(const OrbitSpec& orbit, const std::string& key) const {
    check_one_of(key, {"periapsis", "semi_major_axis"}, true);
    check_one_of(key, {"periapsis_time", "mean_anomaly"}, false);
    if (orbit.eccentricity == 1.0)
      for (const char* name : {".semi_major_axis", ".mean_anomaly"})
        if (given(key + name)) throw error(key + name, "a parabola (eccentricity 1) has none");
    if (orbit.semi_major_axis && !(*orbit.semi_major_axis * (1.0 - orbit.eccentricity) > 0.0))
      throw error(key + ".semi_major_axis", "expected {} 0 for the eccentricity {}, found {}",
                  orbit.eccentricity < 1.0 ? "above" : "below", show(orbit.eccentricity),
                  show(*orbit.semi_major_axis));
  }

  /// Keys of an operation, and that nothing else is asked of its stage.
  void check_operation(StageSpec& stage, const std::string& key) const {
    check_one_of(key, {"carve", "scale", "assign"}, false);
    if (!stage.operates()) {
      require(key + ".duration", "the stage does not carve, scale or assign");
      return;
    }
    for (const char* name : {".duration", ".extension", ".material", ".contacts", ".impact_speed",
                             ".stiffness", ".time_step", ".spin", ".relax", ".strain_rate", ".packing",
                             ".gravity", ".field", ".quiet_energy", ".quiet_speed", ".quiet_interval"})
      if (given(key + name))
        throw error(key + name, "has no effect in a stage that carves, scales or assigns");
    if (scene_.box) throw error(key, "a pile in a periodic box cannot be carved, scaled or assigned");
    if (stage.carve) check_region(stage.carve->region, key + ".carve.region");
    if (!stage.assign) return;
    check_region(stage.assign->region, key + ".assign.region");
    check_one_of(key + ".assign", {"density", "density_factor"}, false);
    if (!stage.assign->density && !stage.assign->density_factor && stage.assign->material.empty())
      throw error(key + ".assign", "expected one of the keys {}",
                  alternatives({"density", "density_factor", "material"}));
    if (!stage.assign->material.empty()) check_reference(stage.assign->material, key + ".assign.material");
  }

  void check_quiet(std::size_t index, const std::string& key) const {
    const StageSpec& stage = scene_.stages[index];
    if (stage.quiet_interval && !stage.quiet_energy && !stage.quiet_speed)
      throw error(key + ".quiet_interval", "has no effect without quiet_energy or quiet_speed");
    if (scene_.stages[index].quiet_energy && gravity_of(scene_, index) == GravityMethod::none)
      throw error(key + ".quiet_energy", "has no meaning without self-gravity; expected quiet_speed");
  }

  void check_stages() const {
    std::set<std::string> names;
    bool carved = !scene_.pile.empty();  // its file may know a volume
    for (StageSpec& stage : scene_.stages) {
      const std::string key = fmt::format("stage[{}]", names.size());
      if (!names.insert(stage.name).second)
        throw error(key + ".name", "expected a name of its own, found '{}' for a second time", stage.name);
      check_operation(stage, key);
      if (!contacts_of(scene_, names.size() - 1)) check_without_contacts(key);
      check_quiet(names.size() - 1, key);
      if (stage.carve) carved = !stage.carve->outside;
      carved = carved || (stage.scale && stage.scale->volume);
      if (stage.scale && !stage.scale->volume && !carved)
        throw error(key + ".scale", "no region has been carved whose volume is known; expected 'volume'");
      if (!stage.material.empty()) check_reference(stage.material, key + ".material");
      if (stage.stiffness) check_stiffness_counts(key + ".stiffness", stage.material);
      if (stage.spin) check_path(stage.spin->path, key + ".spin.path");
      check_strain(stage, key);
      check_relax(stage, key);
    }
  }

  void check_box(const Vec3& size) const {
    if (size == Vec3::Zero() && scene_.pile.empty())
      throw error("box.size", "expected an edge above 0 m, or a pile that has a box");
    if (scene_.gravity.method != GravityMethod::none)
      throw error("gravity.method",
                  "self-gravity has no meaning in a periodic box; expected 'none' with [box]");
    for (std::size_t i = 0; i < scene_.stages.size(); ++i)
      if (gravity_of(scene_, i) != GravityMethod::none)
        throw error(fmt::format("stage[{}].gravity", i),
                    "self-gravity has no meaning in a periodic box; expected 'none' with [box]");
    const auto along_box = [&](const Vec3& v) { return (size.array() > 0.0 && v.array() != 0.0).any(); };
    if (along_box(scene_.gravity.field))
      throw error("gravity.field", "expected 0 along the periodic directions of the box");
    for (std::size_t i = 0; i < scene_.stages.size(); ++i)
      if (along_box(field_of(scene_, i)))
        throw error(fmt::format("stage[{}].field", i), "expected 0 along the periodic directions of the box");
    for (std::size_t i = 0; i < scene_.walls.size(); ++i) {
      const WallSpec& wall = scene_.walls[i];
      if (wall.kind != WallKind::plane)
        throw error(fmt::format("wall[{}].kind", i), "expected 'plane' in a periodic box");
      if (along_box(wall.normal))
        throw error(fmt::format("wall[{}].normal", i), "expected 0 along the periodic directions of the box");
    }
  }

  void check_strain(const StageSpec& stage, const std::string& key) const {
    if (stage.strain_rate != Vec3::Zero() && !scene_.box)
      throw error(key + ".strain_rate", "has no effect without a [box]");
    if (scene_.box && scene_.box->size != Vec3::Zero() &&
        (scene_.box->size.array() == 0.0 && stage.strain_rate.array() != 0.0).any())
      throw error(key + ".strain_rate", "expected 0 along the open directions of the box");
    if (stage.packing && stage.strain_rate.sum() == 0.0)
      throw error(key + ".packing", "has no effect unless strain_rate changes the volume of the box");
    if (stage.spin && scene_.box) throw error(key + ".spin", "a periodic box cannot spin");
  }

  void check_relax(const StageSpec& stage, const std::string& key) const {
    if (!stage.relax) return;
    if (stage.spin) throw error(key + ".relax", "a stage either relaxes or is spun; expected no 'spin'");
    if (stage.strain_rate != Vec3::Zero())
      throw error(key + ".relax", "a stage either relaxes or is strained; expected no 'strain_rate'");
  }

  void check_path(const std::vector<SpinPoint>& path, const std::string& key) const {
    if (path.empty()) throw error(key, "expected at least one pair [time, period]");
    for (std::size_t i = 0; i < path.size(); ++i) {
      const std::string point = fmt::format("{}[{}]", key, i);
      if (path[i].period <= 0.0)
        throw error(point, "expected a period above 0 s, found {}", show(path[i].period));
      if (i > 0 && path[i].time <= path[i - 1].time)
        throw error(point, "expected a time after {} s, found {}", show(path[i - 1].time),
                    show(path[i].time));
    }
  }

  Scene& scene_;
  std::set<std::string> materials_;  // their names
};

}  // namespace

Scene parse_scene(const std::string& text, SourceMap sources, const std::filesystem::path& directory) {
  Scene scene;
  scene.sources = read_options(text, std::move(sources), scene_keys(), scene);
  scene.text = text;
  scene.directory = directory;
  scene.files = InputFiles(directory);
  Checks(scene).run();
  return scene;
}

Scene parse_scene(const std::string& text, const std::string& name, const std::filesystem::path& directory) {
  SourceMap sources;
  sources.file = name;
  return parse_scene(text, std::move(sources), directory);
}

Scene load_scene(const std::filesystem::path& path) {
  const std::filesystem::path directory = path.has_parent_path() ? path.parent_path() : ".";
  return parse_scene(read_text_file(path), path.string(), directory);
}

std::string wall_name(const Scene& scene, std::size_t wall) {
  const std::string& name = scene.walls[wall].name;
  return name.empty() ? fmt::format("{}", wall) : name;
}

const std::vector<std::pair<std::string, WallKind>>& wall_kinds() {
  static const std::vector<std::pair<std::string, WallKind>> all{{"plane", WallKind::plane},
                                                                 {"sphere", WallKind::sphere},
                                                                 {"cylinder", WallKind::cylinder},
                                                                 {"mesh", WallKind::mesh}};
  return all;
}

std::string describe_wall(const Scene& scene, std::size_t wall) {
  const WallSpec& spec = scene.walls[wall];
  const auto kind = std::ranges::find(wall_kinds(), spec.kind, &std::pair<std::string, WallKind>::second);
  return fmt::format("wall {} ({}, {})",
                     spec.name.empty() ? fmt::format("{}", wall) : fmt::format("'{}'", spec.name),
                     kind->first, scene.sources.place(fmt::format("wall[{}]", wall)));
}

bool contacts_of(const Scene& scene, std::size_t stage) {
  return scene.stages[stage].contacts.value_or(scene.contact.enabled);
}

bool has_wall(const Scene& scene, std::size_t stage, std::size_t wall) {
  if (!contacts_of(scene, stage)) return false;
  const std::vector<std::string>& names = scene.walls[wall].stages;
  return names.empty() || std::find(names.begin(), names.end(), scene.stages[stage].name) != names.end();
}

GravityMethod gravity_of(const Scene& scene, std::size_t stage) {
  return scene.stages[stage].gravity.value_or(scene.gravity.method);
}

Vec3 field_of(const Scene& scene, std::size_t stage) {
  return scene.stages[stage].field.value_or(scene.gravity.field);
}

double total_duration(const Scene& scene) {
  double duration = 0.0;
  for (const StageSpec& stage : scene.stages) duration += stage.duration + stage.extension;
  return duration;
}

std::string scene_reference() {
  return reference(scene_keys().infos);
}

}  // namespace cairn
