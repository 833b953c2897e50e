#include "pile/assemble.h"

#include <algorithm>

#include "pile/cloud.h"
#include "pile/pile_file.h"
#include "shape/library.h"

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
    if (loaded_[k].radii.empty())
      loaded_[k] = make_rigid(load_shape(name, scene_.directory), scene_.mass_model);
    return static_cast<std::uint32_t>(k);
  }
  const std::vector<RigidShape>& all() const { return loaded_; }
  const std::vector<std::string>& names() const { return names_; }

 private:
  const Scene& scene_;
  std::vector<std::string> names_;
  std::vector<RigidShape> loaded_;
};

std::uint16_t material_index(const Scene& scene, const std::string& name) {
  const auto it = std::find_if(scene.materials.begin(), scene.materials.end(),
                               [&](const Material& m) { return m.name == name; });
  return static_cast<std::uint16_t>(it - scene.materials.begin());
}

}  // namespace

Setup assemble(const Scene& scene) {
  Setup setup;
  if (!scene.pile.empty()) setup = read_pile(scene.directory / scene.pile, scene.materials);
  Shapes shapes(scene, std::move(setup.shapes));
  std::uint64_t stream = 0;
  for (const CloudSpec& cloud : scene.clouds) {
    std::vector<std::uint32_t> index;
    for (const ShapeChoice& choice : cloud.shapes) index.push_back(shapes.index(choice.shape));
    add_cloud(cloud, shapes.all(), index, material_index(scene, cloud.material), scene.seed, stream++,
              setup.bodies);
  }
  for (const BodySpec& body : scene.bodies) {
    const std::uint32_t index = shapes.index(body.shape);
    add_body(setup.bodies, shapes.all()[index], index, body.size, body.density,
             material_index(scene, body.material),
             {body.position, body.orientation, body.velocity, body.angular_velocity});
  }
  setup.shapes = shapes.names();
  return setup;
}

}  // namespace cairn
