#include <fmt/core.h>

#include "app/commands.h"
#include "app/render/draw.h"
#include "core/error.h"
#include "shape/library.h"

namespace cairn {

namespace {

struct ListOptions {
  std::string sheet;
};
struct ShowOptions {
  std::string name, picture;
};

void list_shapes(const ListOptions& options) {
  std::vector<Shape> shapes;
  fmt::print("{:<14}{:>8}{:>10}{:>10}{:>10}{:>10}{:>12}  {}\n", "shape", "spheres", "I1/m", "I2/m", "I3/m",
             "volume", "sum/union", "description");
  for (const std::string& name : library_names()) {
    shapes.push_back(load_shape(name));
    const RigidShape rigid = make_rigid(shapes.back(), MassModel::union_volume);
    fmt::print("{:<14}{:>8}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}{:>12.4f}  {}\n", name, rigid.radii.size(),
               rigid.inertia[0], rigid.inertia[1], rigid.inertia[2], rigid.volume,
               sum_of_spheres(shapes.back()).volume / rigid.volume, shapes.back().description);
  }
  if (!options.sheet.empty()) {
    render::render_shape_sheet(shapes, options.sheet);
    fmt::print("wrote {}\n", options.sheet);
  }
}

void show_shape(const ShowOptions& options) {
  const Shape shape = load_shape(options.name);
  fmt::print("{}: {}\n", shape.name, shape.description);
  fmt::print("{:<10}{:>12}{:>12}{:>12}{:>12}{:>12}{:>14}\n", "mass model", "volume", "I1/m", "I2/m", "I3/m",
             "bound", "moment error");
  for (const auto& [name, model] :
       {std::pair{"union", MassModel::union_volume}, std::pair{"spheres", MassModel::spheres}}) {
    const RigidShape rigid = make_rigid(shape, model);
    fmt::print("{:<10}{:>12.6f}{:>12.6f}{:>12.6f}{:>12.6f}{:>12.6f}{:>14.3e}\n", name, rigid.volume,
               rigid.inertia[0], rigid.inertia[1], rigid.inertia[2], rigid.bounding_radius,
               rigid.moment_error);
  }
  const RigidShape rigid = make_rigid(shape, MassModel::union_volume);
  fmt::print("{:<8}{:>12}{:>12}{:>12}{:>12}{:>16}\n", "sphere", "x", "y", "z", "radius", "gravity mass");
  for (std::size_t s = 0; s < shape.radii.size(); ++s)
    fmt::print("{:<8}{:>12.6f}{:>12.6f}{:>12.6f}{:>12.6f}{:>16.6f}\n", s, shape.centers[s].x(),
               shape.centers[s].y(), shape.centers[s].z(), shape.radii[s], rigid.mass_fractions[s]);
  if (!options.picture.empty()) {
    render::render_shape_sheet({shape}, options.picture);
    fmt::print("wrote {}\n", options.picture);
  }
}

}  // namespace

void add_shape_commands(CLI::App& app) {
  CLI::App* shape = app.add_subcommand("shape", "the library of glued-sphere shapes");
  shape->require_subcommand(1);
  auto list = std::make_shared<ListOptions>();
  CLI::App* list_command =
      shape->add_subcommand("list", "list the library; lengths in sphere radii, unit mass");
  list_command->add_option("--sheet", list->sheet, "draw all shapes to this PNG");
  list_command->callback([list] { list_shapes(*list); });
  auto show = std::make_shared<ShowOptions>();
  CLI::App* show_command = shape->add_subcommand("show", "mass properties and spheres of one shape");
  show_command->add_option("shape", show->name, "library name or shape file")->required();
  show_command->add_option("-o,--output", show->picture, "draw the shape to this PNG");
  show_command->callback([show] { show_shape(*show); });
}

}  // namespace cairn
