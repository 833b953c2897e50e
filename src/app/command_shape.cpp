#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/arguments.h"
#include "app/commands.h"
#include "app/render/draw.h"
#include "app/status_line.h"
#include "core/error.h"
#include "core/safe_file.h"
#include "shape/fit.h"
#include "shape/library.h"
#include "shape/principal_frame.h"
#include "shape/shape_file.h"
#include "shape/solid_mesh.h"

namespace cairn {

namespace {

struct ListOptions {
  std::string sheet;
};
struct ShowOptions {
  std::string name, picture;
};

struct CheckOptions {
  std::filesystem::path mesh, output;
  double unit = 1.0;
  bool force = false;
};
struct FitCommandOptions {
  std::filesystem::path mesh, output;
  double unit = 1.0;
  bool force = false;
  FitOptions fit;
};

void check_picture(const std::string& name) {
  if (!name.empty() && std::filesystem::path(name).extension() != ".png")
    throw InputError("{}: expected a name that ends in .png", name);
  if (!name.empty()) require_writable(name, true);
}

/// How far a fit is, while it lasts.
class FitLine {
 public:
  FitLine() = default;
  FitLine(const FitLine&) = delete;
  FitLine& operator=(const FitLine&) = delete;
  ~FitLine() {
    if (shown_) line_.end();
  }

  void show(const FitProgress& progress) {
    if (!line_.due()) return;
    shown_ = true;
    const std::string before =
        progress.last > 0 ? fmt::format("  {} came to RMS {:.3g}", progress.last, progress.rms) : "";
    line_.show(fmt::format("{:>4} spheres {} {:3.0f} %{}", progress.spheres, bar(progress.done),
                           100.0 * progress.done, before));
  }

 private:
  StatusLine line_;
  bool shown_ = false;
};

/// A file name as the name of a shape, which is one line.
std::string without_controls(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '_');
  return text;
}

void list_shapes(const ListOptions& options) {
  check_picture(options.sheet);
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

void print_source(const SourceMesh& source) {
  const FitError& e = source.error;
  fmt::print("stands for {}, as large at size = {:.6g} m; errors in sizes, or relative:\n", source.file,
             source.size);
  fmt::print(
      "  distance of the surfaces  RMS {:.3g}; from the mesh RMS {:.3g}, greatest {:.3g}; from the spheres "
      "RMS {:.3g}, greatest {:.3g}\n",
      e.rms, e.rms_from_mesh, e.greatest_from_mesh, e.rms_from_spheres, e.greatest_from_spheres);
  fmt::print(
      "  union of the spheres      volume {:+.3g}, centroid {:.3g}, greatest of a principal moment {:.3g} "
      "(sum of spheres {:.3g})\n",
      e.volume, e.centroid, e.inertia, e.inertia_of_spheres);
}

void check_mesh(const CheckOptions& options) {
  const FileDescriptor old = options.output.empty() ? FileDescriptor{} : claim(options.output, options.force);
  const SolidMesh solid = load_solid(options.mesh, options.unit);
  const TriangleMesh& surface = solid.surface;
  const MassProperties mass = mass_of(surface);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : surface.vertices) box.extend(x);
  double area = 0.0;
  for (const auto& [a, b, c] : surface.triangles)
    area +=
        0.5 *
        (surface.vertices[b] - surface.vertices[a]).cross(surface.vertices[c] - surface.vertices[a]).norm();
  const PrincipalFrame frame = principal_frame(mass.inertia / mass.volume);
  const Vec3 axes = 2.0 * equivalent_ellipsoid(mass);
  const auto triple = [](const Vec3& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z()); };
  fmt::print("{}: the closed surface of one solid, {} facets{}, {} vertices\n", options.mesh.string(),
             solid.facets,
             solid.facets == surface.triangles.size()
                 ? ""
                 : fmt::format(" cut into {} triangles", surface.triangles.size()),
             surface.vertices.size());
  for (const std::string& repair : solid.repairs) fmt::print("  repaired      {}\n", repair);
  for (const std::string& note : solid.notes) fmt::print("  note          {}\n", note);
  if (solid.cavities > 0) fmt::print("  cavities      {}\n", solid.cavities);
  fmt::print("  volume        {:.9g} m^3 (ball of radius {:.9g} m)\n", mass.volume,
             std::cbrt(mass.volume / (4.0 / 3.0 * kPi)));
  fmt::print("  area          {:.9g} m^2\n  extent        {} m\n  centroid      {} m\n", area,
             triple(box.sizes()), triple(mass.centroid));
  fmt::print("  moments/mass  {} m^2, principal\n", triple(frame.moments));
  for (Eigen::Index k = 0; k < 3; ++k) fmt::print("  axis {}        {}\n", k + 1, triple(frame.axes.col(k)));
  fmt::print("  DEEVE         {} m, full axes\n", triple(axes));
  if (options.output.empty()) return;
  write_file(options.output, obj_text(in_principal_frame(surface, mass), options.unit), options.force);
  fmt::print("wrote {}: centroid at the origin, principal axes along x, y, z\n", options.output.string());
}

void fit_shape(const FitCommandOptions& options) {
  namespace fs = std::filesystem;
  fs::path output = options.output;
  if (output.empty())
    output = options.fit.spheres > 0
                 ? fmt::format("{}-{}.toml", options.mesh.stem().string(), options.fit.spheres)
                 : fmt::format("{}.toml", options.mesh.stem().string());
  const FileDescriptor old = claim(output, options.force);
  const SolidMesh solid = load_solid(options.mesh, options.unit);
  for (const std::string& repair : solid.repairs) fmt::print("repaired: {}\n", repair);
  for (const std::string& note : solid.notes) spdlog::warn("{}: {}", options.mesh.string(), note);
  Shape shape = naming(options.mesh.string(), [&] {
    FitLine line;
    FitOptions fit = options.fit;
    fit.progress = [&](const FitProgress& progress) { line.show(progress); };
    return fit_spheres(solid, fit);
  });
  shape.name = without_controls(output.stem().string());
  shape.source->file =
      fs::absolute(options.mesh).lexically_relative(fs::absolute(output).parent_path()).string();
  shape.source->unit = options.unit;
  shape.description =
      fmt::format("{} spheres for {}, RMS distance of the surfaces {:.3g} reference radii",
                  shape.radii.size(), options.mesh.filename().string(), shape.source->error.rms);
  naming(options.mesh.string(), [&] { save_shape(shape, output, options.force); });
  fmt::print("{}: {} spheres\n", output.string(), shape.radii.size());
  print_source(*shape.source);
  constexpr double kAstray = 0.5;
  if (const double off = shape.source->error.volume; std::abs(off) > kAstray)
    spdlog::warn(
        "the spheres cover {:.3g} times the volume of the mesh, which they hardly stand for: it may be too "
        "thin for so few",
        1.0 + off);
}

/// The mesh that a shape file names; empty: none, or not there, which is said.
std::filesystem::path find_mesh(const Shape& shape, const ShowOptions& options) {
  if (!shape.source) return {};
  const std::filesystem::path file = std::filesystem::path(options.name).parent_path() / shape.source->file;
  std::error_code none;
  if (std::filesystem::exists(file, none)) return file;
  spdlog::warn("{}: no such mesh file{}", file.string(),
               options.picture.empty() ? "" : ", only the spheres are drawn");
  return {};
}

void draw_beside_mesh(const Shape& shape, const std::filesystem::path& file, const std::string& picture) {
  const SourceMesh& source = *shape.source;
  TriangleMesh mesh = load_mesh(file, source.unit);
  for (Vec3& x : mesh.vertices) x = (x - source.origin) / source.size;
  render::render_beside_mesh(shape, mesh, picture);
}

void show_shape(const ShowOptions& options) {
  check_picture(options.picture);
  const Shape shape = load_shape(options.name);
  fmt::print("{}: {}\n", shape.name, shape.description);
  fmt::print("{:<10}{:>12}{:>12}{:>12}{:>12}{:>12}{:>14}\n", "mass model", "volume", "I1/m", "I2/m", "I3/m",
             "bound", "gravity off");
  for (const auto& [name, model] :
       {std::pair{"mesh", MassModel::mesh}, std::pair{"union", MassModel::union_volume},
        std::pair{"spheres", MassModel::spheres}}) {
    if (model == MassModel::mesh && !shape.source) continue;
    const RigidShape rigid = make_rigid(shape, model);
    fmt::print("{:<10}{:>12.6f}{:>12.6f}{:>12.6f}{:>12.6f}{:>12.6f}{:>14.3e}\n", name, rigid.volume,
               rigid.inertia[0], rigid.inertia[1], rigid.inertia[2], rigid.bounding_radius,
               rigid.moment_error);
  }
  fmt::print("gravity off: moments of the spheres with their gravity masses against these, relative\n");
  if (shape.source) print_source(*shape.source);
  const std::filesystem::path mesh = find_mesh(shape, options);
  const RigidShape rigid = make_rigid(shape, MassModel::mesh);
  fmt::print("{:<8}{:>12}{:>12}{:>12}{:>12}{:>16}\n", "sphere", "x", "y", "z", "radius", "gravity mass");
  for (std::size_t s = 0; s < shape.radii.size(); ++s)
    fmt::print("{:<8}{:>12.6f}{:>12.6f}{:>12.6f}{:>12.6f}{:>16.6f}\n", s, shape.centers[s].x(),
               shape.centers[s].y(), shape.centers[s].z(), shape.radii[s], rigid.mass_fractions[s]);
  if (options.picture.empty()) return;
  if (mesh.empty())
    render::render_shape_sheet({shape}, options.picture);
  else
    draw_beside_mesh(shape, mesh, options.picture);
  fmt::print("wrote {}\n", options.picture);
}

}  // namespace

void add_shape_commands(CLI::App& app) {
  CLI::App* shape = app.add_subcommand("shape", "glued-sphere shapes: the library, and shapes from meshes");
  shape->require_subcommand(1);
  const CLI::Validator unit = number_from(1e-12, 1e12);
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

  auto check = std::make_shared<CheckOptions>();
  CLI::App* check_command =
      shape->add_subcommand("check", "is a mesh the surface of a solid; its volume, moments and axes");
  check_command
      ->add_option("mesh", check->mesh, "mesh file: OBJ, STL, PLY, OFF, a table of facets or radii, others")
      ->required();
  check_command->add_option("--unit", check->unit, "metres of one unit of the file")->check(unit);
  check_command->add_option("-o,--output", check->output,
                            "write the mesh to this OBJ file, centred and turned to its principal axes");
  check_command->add_flag("--force", check->force, "replace that file if it exists");
  check_command->callback([check] { check_mesh(*check); });

  auto fit = std::make_shared<FitCommandOptions>();
  CLI::App* fit_command =
      shape->add_subcommand("fit", "glue spheres to stand for a mesh; writes a shape file");
  fit_command
      ->add_option("mesh", fit->mesh, "mesh file: OBJ, STL, PLY, OFF, a table of facets or radii, others")
      ->required();
  fit_command->add_option("--unit", fit->unit, "metres of one unit of the file")->check(unit);
  CLI::Option_group* goal = fit_command->add_option_group("goal", "one of");
  goal->add_option("--spheres", fit->fit.spheres, "how many")->check(whole_from(1, kMostFitSpheres));
  goal->add_option(
          "--error", fit->fit.error,
          "RMS distance of the surfaces, in radii of the ball of equal volume; the fewest spheres found")
      ->check(number_from(1e-4, 1.0));
  goal->require_option(1);
  fit_command->add_option("-o,--output", fit->output, "shape file; MESH-SPHERES.toml if absent");
  fit_command->add_flag("--force", fit->force, "replace the shape file if it exists");
  fit_command->add_option("--seed", fit->fit.seed, "of what is left to chance")
      ->check(whole_from(0, std::numeric_limits<std::int64_t>::max()));  // as the shape file keeps it
  fit_command
      ->add_option("--strategy", fit->fit.strategy,
                   "best: least squares; greedy: inscribed balls, one by one")
      ->transform(one_of(kStrategyNames));
  fit_command
      ->add_option(
          "--mass", fit->fit.mass,
          "mass_model of the scenes: mesh or union; spheres fits the moments of their sum too, which costs "
          "accuracy of the surface")
      ->transform(one_of(kMassModelNames));
  fit_command->callback([fit] { fit_shape(*fit); });
}

}  // namespace cairn
