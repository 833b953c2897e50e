#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "app/commands.h"
#include "app/render/color.h"
#include "app/render/draw.h"
#include "app/render/film.h"
#include "app/result_view.h"
#include "core/error.h"
#include "core/random.h"

namespace cairn {

namespace {

using render::Ball;

enum class ColorBy { shape, body, speed, contacts };

struct Options {
  std::vector<std::filesystem::path> results;
  std::filesystem::path output;
  std::vector<std::string> at{"last"};
  ColorBy color = ColorBy::shape;
  int width = 1200, height = 900;
  std::vector<double> direction{1.0, -1.4, 0.7};
  double region = 0.0;
  double fps = 12.0;
  bool dark = false, draft = false;
};

/// Colours of one file's pictures, the same in all of its snapshots.
struct Coloring {
  ColorBy by;
  double high = 1.0;  ///< value of the last colour, for speed and contacts
};

/// Quantity shown for a sphere: speed of its body against the pile (m/s), or its number of contacts.
double quantity(const ResultView& view, const SnapshotView& snapshot, const Vec3& drift, ColorBy by,
                std::size_t s) {
  if (by == ColorBy::contacts) return snapshot.contacts[s];
  return (snapshot.velocity[view.bodies().spheres.body[s]] - drift).norm();
}

Vec3 mean_velocity(const ResultView& view, const SnapshotView& snapshot) {
  Vec3 momentum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t b = 0; b < view.bodies().size(); ++b) {
    momentum += view.bodies().mass[b] * snapshot.velocity[b];
    mass += view.bodies().mass[b];
  }
  return momentum / mass;
}

Coloring coloring(const ResultView& view, const std::vector<SnapshotView>& snapshots, ColorBy by) {
  Coloring out{by};
  if (by == ColorBy::shape || by == ColorBy::body) return out;
  std::vector<double> values;
  for (const SnapshotView& snapshot : snapshots) {
    const Vec3 drift = mean_velocity(view, snapshot);
    for (std::size_t s = 0; s < snapshot.positions.size(); ++s)
      values.push_back(quantity(view, snapshot, drift, by, s));
  }
  // The fastest hundredth would take all the colours.
  const std::size_t rank = values.size() * 99 / 100;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  out.high = values[rank] > 0.0 ? values[rank] : 1.0;
  return out;
}

/// The colour of a shape, a little lighter or darker from body to body so that neighbours stay apart.
Vec3 grain_color(std::uint32_t shape, std::uint32_t body) {
  const double shade = 0.24 * (Random(body, 0).uniform() - 0.5);
  const Vec3 color = render::category_color(shape);
  return shade > 0.0 ? Vec3(color + shade * (Vec3::Ones() - color)) : Vec3((1.0 + shade) * color);
}

std::vector<Ball> balls_of(const ResultView& view, const SnapshotView& snapshot, const Coloring& coloring) {
  const Bodies& bodies = view.bodies();
  const Vec3 drift = mean_velocity(view, snapshot);
  std::vector<Ball> balls(bodies.spheres.size());
  for (std::size_t s = 0; s < balls.size(); ++s) {
    const std::uint32_t b = bodies.spheres.body[s];
    Vec3 color;
    switch (coloring.by) {
      case ColorBy::shape:
        color = grain_color(bodies.shape[b], b);
        break;
      case ColorBy::body:
        color = render::id_color(b);
        break;
      default:
        color = render::scalar_color(quantity(view, snapshot, drift, coloring.by, s) / coloring.high);
    }
    balls[s] = {snapshot.positions[s].cast<double>(), bodies.spheres.radius[s], color, b};
  }
  return balls;
}

std::vector<render::Swatch> shape_key(const ResultView& view) {
  std::vector<render::Swatch> key;
  for (std::size_t k = 0; k < view.shapes().size(); ++k) {
    const std::string stem = std::filesystem::path(view.shapes()[k]).stem().string();
    key.push_back({stem, render::category_color(k)});
  }
  return key;
}

render::Annotation annotation(const ResultView& view, const SnapshotView& snapshot,
                              const Coloring& coloring) {
  render::Annotation note;
  note.title = view.title();
  std::string line = fmt::format("{}   t = {:.2f} h", snapshot.stage, snapshot.time / 3600.0);
  if (snapshot.period > 0.0 && snapshot.period < 3.6e6)
    line += fmt::format("   T = {:.2f} h", snapshot.period / 3600.0);
  note.lines = {line};
  if (coloring.by == ColorBy::shape) note.key = shape_key(view);
  if (coloring.by == ColorBy::speed) note.color_bar = render::ColorBar{"speed (m/s)", 0.0, coloring.high};
  if (coloring.by == ColorBy::contacts)
    note.color_bar = render::ColorBar{"contacts per sphere", 0.0, coloring.high};
  return note;
}

std::vector<SnapshotView> selected(const ResultView& view, const std::vector<std::string>& at) {
  std::vector<SnapshotView> out;
  for (const std::string& which : at)
    for (std::size_t k : view.select(which)) out.push_back(view.snapshot(k));
  return out;
}

render::View camera(const Options& options, const std::vector<Ball>& balls) {
  render::View view;
  view.direction = {options.direction[0], options.direction[1], options.direction[2]};
  view = render::frame(balls, view, {.fraction = 0.97, .margin = 0.12});
  if (options.region > 0.0) view.width = view.height = options.region;
  return view;
}

void draw_film(const Options& options, const ResultView& view, const render::Style& style) {
  const std::vector<SnapshotView> snapshots = selected(view, {"all"});
  const Coloring colors = coloring(view, snapshots, options.color);
  // One region for all frames: the largest any of them needs, about its own pile.
  double region = 0.0;
  for (const SnapshotView& s : snapshots) {
    const render::View v = camera(options, balls_of(view, s, colors));
    region = std::max({region, v.width, v.height});
  }
  render::Film film(options.output, options.width, options.height, options.fps);
  for (const SnapshotView& s : snapshots) {
    const std::vector<Ball> balls = balls_of(view, s, colors);
    render::View v = camera(options, balls);
    v.width = v.height = options.region > 0.0 ? options.region : region;
    film.add(render::draw(balls, v, annotation(view, s, colors), options.width, options.height, style));
  }
  film.finish();
}

void draw_picture(const Options& options, const std::vector<ResultView>& views, const render::Style& style) {
  std::vector<render::Image> panels;
  std::size_t columns = 1;
  for (const ResultView& view : views) {
    const std::vector<SnapshotView> snapshots = selected(view, options.at);
    const Coloring colors = coloring(view, snapshots, options.color);
    columns = std::max(columns, snapshots.size());
    for (const SnapshotView& s : snapshots) {
      const std::vector<Ball> balls = balls_of(view, s, colors);
      panels.push_back(render::draw(balls, camera(options, balls), annotation(view, s, colors), options.width,
                                    options.height, style));
    }
  }
  render::write_png(render::grid(panels, static_cast<int>(columns), 0, style.paper()), options.output);
}

void render_results(const Options& options) {
  std::vector<ResultView> views;
  for (const auto& path : options.results) views.emplace_back(path);
  const auto ground = options.dark ? render::Background::dark : render::Background::white;
  render::Style style;
  style.background = ground;
  if (options.draft) style = render::Style::draft(ground);
  if (options.output.extension() == ".mp4") {
    if (views.size() != 1) throw InputError("{}: a film shows one result file", options.output.string());
    draw_film(options, views[0], style);
  } else if (options.output.extension() == ".png") {
    draw_picture(options, views, style);
  } else {
    throw InputError("{}: expected a name that ends in .png or .mp4", options.output.string());
  }
  fmt::print("wrote {}\n", options.output.string());
}

}  // namespace

void add_render_command(CLI::App& app) {
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "draw snapshots to PNG, or all of them to an MP4 film");
  command->add_option("results", o->results, "result files, one row of panels each")->required();
  command->add_option("-o,--output", o->output, "FILE.png or FILE.mp4")->required();
  command
      ->add_option("--at", o->at,
                   "snapshots, one panel each: a number, first, last, failure, all, or a stage")
      ->delimiter(',')
      ->capture_default_str();
  const std::map<std::string, ColorBy> colors{{"shape", ColorBy::shape},
                                              {"body", ColorBy::body},
                                              {"speed", ColorBy::speed},
                                              {"contacts", ColorBy::contacts}};
  command->add_option("--color", o->color, "shape, body, speed or contacts")
      ->transform(CLI::CheckedTransformer(colors, CLI::ignore_case));
  command->add_option("--width", o->width, "pixels of a panel")
      ->check(CLI::Range(16, 16384))
      ->capture_default_str();
  command->add_option("--height", o->height, "pixels of a panel")
      ->check(CLI::Range(16, 16384))
      ->capture_default_str();
  command->add_option("--from", o->direction, "x y z: from the pile towards the viewer")->expected(3);
  command->add_option("--region", o->region, "width of what is seen (m); chosen to fit when absent")
      ->check(CLI::PositiveNumber);
  command->add_option("--fps", o->fps, "frames per second of a film")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  command->add_flag("--dark", o->dark, "dark ground");
  command->add_flag("--draft", o->draft, "fewer rays: faster, grainier");
  command->callback([o] { render_results(*o); });
}

}  // namespace cairn
