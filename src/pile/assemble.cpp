#include "pile/assemble.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "body/columns.h"
#include "core/error.h"
#include "pile/cloud.h"
#include "pile/lattice.h"
#include "pile/operate.h"
#include "pile/pile_file.h"
#include "shape/library.h"
#include "shape/shape_file.h"
#include "sim/make_walls.h"

namespace cairn {

namespace {

/// Shapes by name, each loaded once. Those of a pile file keep their numbers, and are loaded only when the
/// scene makes more bodies of them.
class Shapes {
 public:
  Shapes(const Scene& scene, std::vector<std::string> names)
      : scene_(scene), names_(std::move(names)), loaded_(names_.size()) {}

  /// `key` names the shape.
  std::uint32_t index(const std::string& name, const std::string& key) {
    const auto k = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
    if (k == names_.size()) {
      loaded_.emplace_back();
      names_.push_back(name);
    }
    if (loaded_[k].radii.empty())
      loaded_[k] = scene_.sources.at(key, [&] { return make_rigid(read(name), scene_.mass_model); });
    return static_cast<std::uint32_t>(k);
  }
  const std::vector<RigidShape>& all() const { return loaded_; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  Shape read(const std::string& name) const {
    constexpr std::uint64_t most = 64'000'000;  // bytes
    const std::filesystem::path path = shape_path(name, scene_.directory);
    const std::string file = is_shape_path(name) ? name : "library:" + name;
    return parse_shape(scene_.files.read(file, path, most), path.string());
  }

  const Scene& scene_;
  std::vector<std::string> names_;
  std::vector<RigidShape> loaded_;
};

std::uint16_t material_index(const Scene& scene, const std::string& name) {
  const auto it = std::find_if(scene.materials.begin(), scene.materials.end(),
                               [&](const Material& m) { return m.name == name; });
  return static_cast<std::uint16_t>(it - scene.materials.begin());
}

/// Radius (m) of the smallest sphere the scene will have.
double smallest_radius(const Scene& scene, const Bodies& pile, Shapes& shapes) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto consider = [&](const std::string& key, const std::string& shape, double size) {
    const std::vector<double>& radii = shapes.all()[shapes.index(shape, key + ".shape")].radii;
    smallest = std::min(smallest, size * *std::min_element(radii.begin(), radii.end()));
  };
  for (std::size_t k = 0; k < scene.clouds.size(); ++k)
    for (std::size_t c = 0; c < scene.clouds[k].shapes.size(); ++c)
      consider(fmt::format("cloud[{}].shape[{}]", k, c), scene.clouds[k].shapes[c].shape,
               scene.clouds[k].size);
  for (std::size_t k = 0; k < scene.lattices.size(); ++k)
    consider(fmt::format("lattice[{}]", k), scene.lattices[k].shape, scene.lattices[k].size);
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    consider(fmt::format("body[{}]", k), scene.bodies[k].shape, scene.bodies[k].size);
  for (const double radius : pile.spheres.radius) smallest = std::min(smallest, radius);
  return smallest;
}

/// A held body's motion; `place` (m) is where its rotation point is unless given.
WallMotion motion_of(const MotionSpec& spec, const Vec3& place) {
  return {.velocity = spec.velocity,
          .amplitude = spec.oscillation_amplitude,
          .frequency = spec.oscillation_frequency,
          .phase = spec.oscillation_phase,
          .spin = spec.angular_velocity,
          .center = spec.rotation_point.value_or(place)};
}

/// Gives the bodies from `begin` on what the scene says of their motion and of walls.
template <class Spec>
void restrain(const Spec& spec, const Vec3& place, std::size_t begin, Setup& setup) {
  Bodies& bodies = setup.bodies;
  const auto give = [&](std::vector<std::uint16_t>& column, std::size_t number, const char* what) {
    if (number > std::numeric_limits<std::uint16_t>::max())
      throw InputError("{}: more than {} in a scene", what, std::numeric_limits<std::uint16_t>::max());
    column.resize(begin, 0);
    column.resize(bodies.size(), static_cast<std::uint16_t>(number));
  };
  if (spec.held) {
    setup.held.motions.push_back(motion_of(*spec.held, place));
    give(bodies.held, setup.held.motions.size(), "held");
  }
  if (spec.walls) {
    const std::string set = set_of_walls(*spec.walls);
    const auto found = std::find(setup.wall_sets.begin(), setup.wall_sets.end(), set);
    const auto number = static_cast<std::size_t>(found - setup.wall_sets.begin()) + 1;
    if (found == setup.wall_sets.end()) setup.wall_sets.push_back(set);
    give(bodies.wall_set, number, "walls");
  }
}

/// The first key by which the scene holds bodies.
std::string key_of_held(const Scene& scene) {
  const auto find = [](const auto& specs, const char* name) -> std::string {
    for (std::size_t k = 0; k < specs.size(); ++k)
      if (specs[k].held) return fmt::format("{}[{}].held", name, k);
    return {};
  };
  for (const std::string& key :
       {find(scene.lattices, "lattice"), find(scene.clouds, "cloud"), find(scene.bodies, "body")})
    if (!key.empty()) return key;
  return "pile";
}

/// Puts held bodies into their motions. Those of the pile are where these have led them; the others, from
/// `begin` on, are displaced from their places by them.
void hold_bodies(const Scene& scene, std::size_t begin, Setup& setup) {
  Bodies& bodies = setup.bodies;
  for (auto* column : {&bodies.held, &bodies.wall_set})
    if (!column->empty()) column->resize(bodies.size(), 0);
  setup.held.find(bodies, 0.0);
  for (std::size_t k = 0; k < setup.held.body.size(); ++k) {
    const std::uint32_t b = setup.held.body[k];
    if (b < begin) continue;
    setup.held.position[k] = bodies.position[b];
    setup.held.orientation[k] = bodies.orientation[b];
  }
  if (setup.held.empty()) return;
  if (setup.held.body.size() == bodies.size())
    throw scene.sources.error(key_of_held(scene), "all bodies are held; expected one that moves");
  setup.held.place(0.0, bodies);
  for (std::size_t k = 0; k < scene.stages.size(); ++k) {
    if (scene.stages[k].spin)
      throw scene.sources.error(fmt::format("stage[{}].spin", k), "a pile with held bodies cannot be spun");
    if (scene.stages[k].strain_rate != Vec3::Zero())
      throw scene.sources.error(fmt::format("stage[{}].strain_rate", k),
                                "a box with held bodies cannot be strained");
  }
}

/// Moves what held bodies turn about, and the motion itself, with the frame.
void displace(const Vec3& by, const Vec3& velocity, std::vector<WallMotion>& motions) {
  for (WallMotion& motion : motions) {
    motion.center += by + motion.since * velocity;
    motion.velocity += velocity;
  }
}

constexpr std::uint64_t kLatticeStreams = std::uint64_t{1} << 32;  // clouds have the lower ones

/// The pile and its box in the frame of the scene.
Setup take_pile(const Scene& scene, const std::vector<Wall>& walls) {
  const std::filesystem::path path = scene.directory / scene.pile;
  Setup setup = read_pile(path, scene, walls);
  displace(setup.bodies, setup.frame.position - scene.frame.position,
           setup.frame.velocity - scene.frame.velocity);
  displace(setup.frame.position - scene.frame.position, setup.frame.velocity - scene.frame.velocity,
           setup.held.motions);
  if (setup.box.periodic() && !scene.box)
    throw InputError("{}: this pile was made in a periodic box; expected a [box]", path.string());
  if (scene.box && scene.box->size == Vec3::Zero() && !setup.box.periodic())
    throw InputError("box.size: expected an edge above 0 m, because the pile in {} has no box",
                     path.string());
  return setup;
}

}  // namespace

Setup assemble(const Scene& scene) {
  check_operations(scene);
  Setup setup;
  if (!scene.pile.empty()) {
    const std::vector<Wall> walls = make_walls(scene);
    setup = scene.sources.at("pile", [&] { return take_pile(scene, walls); });
  }
  const std::size_t of_pile = setup.bodies.size();
  setup.frame = scene.frame;
  if (scene.box && scene.box->size != Vec3::Zero()) setup.box.edge = scene.box->size;
  Shapes shapes(scene, std::move(setup.shapes));
  // Walls, boxes and held bodies stay where they are: no frame of the bodies' own, no cells.
  const auto holds = [](const auto& spec) { return spec.held.has_value(); };
  const bool free = scene.walls.empty() && !scene.box && setup.held.motions.empty() &&
                    std::ranges::none_of(scene.lattices, holds) &&
                    std::ranges::none_of(scene.clouds, holds) && std::ranges::none_of(scene.bodies, holds);
  set_cell_edge(setup.bodies, free ? cell_edge(smallest_radius(scene, setup.bodies, shapes)) : 0.0);
  for (std::size_t k = 0; k < scene.lattices.size(); ++k) {
    const LatticeSpec& lattice = scene.lattices[k];
    const std::size_t begin = setup.bodies.size();
    const std::uint32_t index = shapes.index(lattice.shape, fmt::format("lattice[{}].shape", k));
    scene.sources.at(fmt::format("lattice[{}]", k), [&] {
      add_lattice(lattice, Region(lattice.region, scene.files), shapes.all()[index], index,
                  material_index(scene, lattice.material), scene.seed, kLatticeStreams + k, setup.bodies);
    });
    restrain(lattice, lattice.region.position, begin, setup);
  }
  for (std::size_t k = 0; k < scene.clouds.size(); ++k) {
    const CloudSpec& cloud = scene.clouds[k];
    const std::size_t begin = setup.bodies.size();
    std::vector<std::uint32_t> index;
    for (std::size_t c = 0; c < cloud.shapes.size(); ++c)
      index.push_back(shapes.index(cloud.shapes[c].shape, fmt::format("cloud[{}].shape[{}].shape", k, c)));
    scene.sources.at(fmt::format("cloud[{}]", k), [&] {
      add_cloud(cloud, shapes.all(), index, material_index(scene, cloud.material), scene.seed, k,
                setup.bodies);
    });
    restrain(cloud, cloud.position, begin, setup);
  }
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const BodySpec& body = scene.bodies[k];
    const std::uint32_t index = shapes.index(body.shape, fmt::format("body[{}].shape", k));
    const double volume = shapes.all()[index].volume * cubed(body.size);
    add_body(setup.bodies, shapes.all()[index], index, body.size,
             body.density ? *body.density : *body.mass / volume, material_index(scene, body.material),
             {.orientation = body.orientation,
              .velocity = body.velocity,
              .angular_velocity = body.angular_velocity,
              .origin = body.position});
    restrain(body, body.position, setup.bodies.size() - 1, setup);
  }
  hold_bodies(scene, of_pile, setup);
  if (free) {
    setup.shift = take_frame(setup.bodies);
    setup.frame.position += setup.shift.position;
    setup.frame.velocity += setup.shift.velocity;
  }
  place_spheres(setup.bodies);
  const auto fit = [](auto& column) { column.shrink_to_fit(); };
  for_each_body_column(fit, setup.bodies);
  for_each_sphere_column(fit, setup.bodies.spheres);
  setup.shapes = shapes.names();
  return setup;
}

}  // namespace cairn
