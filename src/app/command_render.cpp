#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "app/commands.h"
#include "app/render/color.h"
#include "app/render/draw.h"
#include "app/render/film.h"
#include "app/result_view.h"
#include "app/summary.h"
#include "core/error.h"
#include "core/random.h"
#include "core/safe_file.h"

namespace cairn {

namespace {

using render::Ball;

enum class ColorBy { shape, body, speed, contacts };

struct Options {
  std::vector<std::filesystem::path> results;
  std::filesystem::path output;
  std::vector<std::string> at{"last"};
  std::string color = "shape";
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
double quantity(const SnapshotView& snapshot, const Vec3& drift, ColorBy by, std::size_t s) {
  if (by == ColorBy::contacts) return snapshot.contacts[s];
  return (snapshot.velocity[snapshot.bodies->spheres.body[s]] - drift).norm();
}

Vec3 mean_velocity(const SnapshotView& snapshot) {
  Vec3 momentum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t b = 0; b < snapshot.bodies->size(); ++b) {
    momentum += snapshot.bodies->mass[b] * snapshot.velocity[b];
    mass += snapshot.bodies->mass[b];
  }
  return momentum / mass;
}

ColorBy color_by(const std::string& name) {
  return name == "shape"   ? ColorBy::shape
         : name == "body"  ? ColorBy::body
         : name == "speed" ? ColorBy::speed
                           : ColorBy::contacts;
}

Coloring coloring(const std::vector<SnapshotView>& snapshots, ColorBy by) {
  Coloring out{by};
  if (by == ColorBy::shape || by == ColorBy::body) return out;
  std::vector<double> values;
  for (const SnapshotView& snapshot : snapshots) {
    const Vec3 drift = mean_velocity(snapshot);
    for (std::size_t s = 0; s < snapshot.positions.size(); ++s)
      values.push_back(quantity(snapshot, drift, by, s));
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

std::vector<Ball> balls_of(const SnapshotView& snapshot, const Coloring& coloring) {
  const Bodies& bodies = *snapshot.bodies;
  const Vec3 drift = mean_velocity(snapshot);
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
        color = render::scalar_color(quantity(snapshot, drift, coloring.by, s) / coloring.high);
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
  std::string line = fmt::format("{}   t = {}", snapshot.stage, duration_text(snapshot.time));
  if (snapshot.period > 0.0 && snapshot.period < 3.6e6) line += "   T = " + duration_text(snapshot.period);
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

/// The cameras of one file's pictures: each about its own pile, all with one region, so that sizes compare.
std::vector<render::View> cameras(const Options& options, const std::vector<SnapshotView>& snapshots,
                                  const Coloring& colors) {
  render::View from;
  from.direction = {options.direction[0], options.direction[1], options.direction[2]};
  std::vector<render::View> out;
  double width = 0.0, height = 0.0;
  for (const SnapshotView& s : snapshots) {
    out.push_back(render::frame(balls_of(s, colors), from, {.fraction = 0.97, .margin = 0.12}));
    width = std::max(width, out.back().width);
    height = std::max(height, out.back().height);
  }
  for (render::View& v : out) {
    v.width = options.region > 0.0 ? options.region : width;
    v.height = options.region > 0.0 ? options.region : height;
  }
  return out;
}

/// Draws the snapshots of one file and hands the pictures on, one after the other.
template <class Take>
void draw_snapshots(const Options& options, const ResultView& view,
                    const std::vector<SnapshotView>& snapshots, const render::Style& style, Take&& take) {
  const Coloring colors = coloring(snapshots, color_by(options.color));
  const std::vector<render::View> views = cameras(options, snapshots, colors);
  for (std::size_t k = 0; k < snapshots.size(); ++k)
    take(render::draw(balls_of(snapshots[k], colors), views[k], annotation(view, snapshots[k], colors),
                      options.width, options.height, style));
}

void draw_film(const Options& options, const ResultView& view, const render::Style& style) {
  render::Film film(options.output, options.width, options.height, options.fps);
  draw_snapshots(options, view, selected(view, {"all"}), style,
                 [&](const render::Image& picture) { film.add(picture); });
  film.finish();
}

void draw_picture(const Options& options, const std::vector<ResultView>& views, const render::Style& style) {
  require_writable(options.output, true);
  std::vector<render::Image> panels;
  std::size_t columns = 1;
  for (const ResultView& view : views) {
    const std::vector<SnapshotView> snapshots = selected(view, options.at);
    columns = std::max(columns, snapshots.size());
    draw_snapshots(options, view, snapshots, style,
                   [&](render::Image picture) { panels.push_back(std::move(picture)); });
  }
  render::write_png(render::grid(panels, static_cast<int>(columns), 0, style.paper()), options.output);
}

void render_results(const Options& options) {
  if (!(options.region >= 0.0 && options.region <= 1e15))
    throw InputError("--region: expected a length up to 1e15 m, found {:g}", options.region);
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
  command->add_option("-o,--output", o->output, "FILE.png or FILE.mp4, replaced if it is there")->required();
  command
      ->add_option("--at", o->at,
                   "snapshots, one panel each: a number, first, last, failure, all, or a stage")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--color", o->color, "quantity shown as colour")
      ->check(CLI::IsMember({"shape", "body", "speed", "contacts"}))
      ->capture_default_str();
  command->add_option("--width", o->width, "pixels of a panel")
      ->check(CLI::Range(16, 16384))
      ->capture_default_str();
  command->add_option("--height", o->height, "pixels of a panel")
      ->check(CLI::Range(16, 16384))
      ->capture_default_str();
  command->add_option("--from", o->direction, "x y z: from the pile towards the viewer")->expected(3);
  command->add_option("--region", o->region, "width of what is seen (m); chosen to fit when absent");
  command->add_option("--fps", o->fps, "frames per second of a film")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  command->add_flag("--dark", o->dark, "dark ground");
  command->add_flag("--draft", o->draft, "fewer rays: faster, grainier");
  command->callback([o] { render_results(*o); });
}

}  // namespace cairn
