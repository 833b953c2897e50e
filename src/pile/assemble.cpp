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

  std::uint32_t index(const std::string& name) {
    const auto k = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
    if (k == names_.size()) {
      loaded_.emplace_back();
      names_.push_back(name);
    }
    if (loaded_[k].radii.empty()) loaded_[k] = make_rigid(read(name), scene_.mass_model);
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

/// Does work of which an error is told with the place of this key in the scene.
template <class Work>
auto at_key(const Scene& scene, const std::string& key, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw scene.sources.error(key, error.what());
  }
}

/// Radius (m) of the smallest sphere the scene will have.
double smallest_radius(const Scene& scene, const Bodies& pile, Shapes& shapes) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto consider = [&](const std::string& key, const std::string& shape, double size) {
    const std::uint32_t index = at_key(scene, key + ".shape", [&] { return shapes.index(shape); });
    const std::vector<double>& radii = shapes.all()[index].radii;
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

constexpr std::uint64_t kLatticeStreams = std::uint64_t{1} << 32;  // clouds have the lower ones

/// The pile and its box in the frame of the scene.
Setup take_pile(const Scene& scene, const std::vector<Wall>& walls) {
  const std::filesystem::path path = scene.directory / scene.pile;
  Setup setup = read_pile(path, scene, walls);
  displace(setup.bodies, setup.frame.position - scene.frame.position,
           setup.frame.velocity - scene.frame.velocity);
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
    setup = at_key(scene, "pile", [&] { return take_pile(scene, walls); });
  }
  setup.frame = scene.frame;
  if (scene.box && scene.box->size != Vec3::Zero()) setup.box.edge = scene.box->size;
  Shapes shapes(scene, std::move(setup.shapes));
  // Walls and boxes stay where they are: no frame of the bodies' own, no cells.
  const bool free = scene.walls.empty() && !scene.box;
  set_cell_edge(setup.bodies, free ? cell_edge(smallest_radius(scene, setup.bodies, shapes)) : 0.0);
  for (std::size_t k = 0; k < scene.lattices.size(); ++k) {
    const LatticeSpec& lattice = scene.lattices[k];
    at_key(scene, fmt::format("lattice[{}]", k), [&] {
      const std::uint32_t index = shapes.index(lattice.shape);
      add_lattice(lattice, Region(lattice.region, scene.files), shapes.all()[index], index,
                  material_index(scene, lattice.material), scene.seed, kLatticeStreams + k, setup.bodies);
    });
  }
  for (std::size_t k = 0; k < scene.clouds.size(); ++k) {
    const CloudSpec& cloud = scene.clouds[k];
    std::vector<std::uint32_t> index;
    for (const ShapeChoice& choice : cloud.shapes) index.push_back(shapes.index(choice.shape));
    at_key(scene, fmt::format("cloud[{}]", k), [&] {
      add_cloud(cloud, shapes.all(), index, material_index(scene, cloud.material), scene.seed, k,
                setup.bodies);
    });
  }
  for (const BodySpec& body : scene.bodies) {
    const std::uint32_t index = shapes.index(body.shape);
    const double volume = shapes.all()[index].volume * std::pow(body.size, 3);
    add_body(setup.bodies, shapes.all()[index], index, body.size,
             body.density ? *body.density : *body.mass / volume, material_index(scene, body.material),
             {.orientation = body.orientation,
              .velocity = body.velocity,
              .angular_velocity = body.angular_velocity,
              .origin = body.position});
  }
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
