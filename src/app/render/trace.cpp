#include "app/render/trace.h"

#include <algorithm>
#include <cmath>

#include "app/render/color.h"
#include "app/render/shade.h"
#include "core/error.h"
#include "core/parallel.h"

namespace cairn::render {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr int kTile = 64;  // pixels
constexpr float kLineWidth =
    0.0011f;  // half width of the lines between bodies, of the picture's smaller side
constexpr float kLineDarkening = 0.72f;  // part of the light that a line takes away

/// From places in the picture to rays.
struct Camera {
  double middle_x, middle_y, scale;  // pixels; pixels per unit of the scene
  float front;
  double eye;  // 0: orthographic

  void ray(double x, double y, Vec3f& origin, Vec3f& direction) const {
    const double u = (x - middle_x) / scale, v = (middle_y - y) / scale;
    if (eye > 0.0) {
      origin = Vec3f(0.0f, 0.0f, static_cast<float>(eye));
      direction = Vec3(u, v, -eye).normalized().cast<float>();
    } else {
      origin = Vec3f(static_cast<float>(u), static_cast<float>(v), front);
      direction = Vec3f(0.0f, 0.0f, -1.0f);
    }
  }
};

/// The pixels on which a ball or facet may lie; the others need no rays.
class Coverage {
 public:
  Coverage(const Scene& scene, const Camera& camera, int width, int height)
      : width_(width), height_(height), covered_(static_cast<std::size_t>(width) * height) {
    for (const Globe& globe : scene.globes()) mark(globe, camera);
    for (const Flat& flat : scene.flats()) {
      const Eigen::Vector3f middle = (flat.corners[0] + flat.corners[1] + flat.corners[2]) / 3.0f;
      float radius = 0.0f;
      for (const Eigen::Vector3f& corner : flat.corners) radius = std::max(radius, (corner - middle).norm());
      mark({middle, flat.albedo, radius, flat.body}, camera);
    }
  }
  /// Outside the picture all is covered: what lies there decides on lines along the border.
  bool operator()(int x, int y) const {
    return x < 0 || y < 0 || x >= width_ || y >= height_ ||
           covered_[static_cast<std::size_t>(y) * width_ + x];
  }

 private:
  /// Marks the picture of the box around a ball, and a pixel around it for rounding.
  void mark(const Globe& globe, const Camera& camera) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int corner = 0; corner < 8; ++corner) {
      const auto at = [&](int axis) {
        return globe.center[axis] + (corner >> axis & 1 ? 1.0 : -1.0) * globe.radius;
      };
      const double enlarged = camera.eye > 0.0 ? camera.eye / (camera.eye - at(2)) : 1.0;
      for (int axis = 0; axis < 2; ++axis) {
        low[axis] = std::min(low[axis], enlarged * at(axis));
        high[axis] = std::max(high[axis], enlarged * at(axis));
      }
    }
    const auto pixel = [](double place, int side) {
      return static_cast<int>(std::floor(std::clamp(place, 0.0, static_cast<double>(side))));
    };
    const int left = pixel(camera.middle_x + camera.scale * low[0] - 1.0, width_);
    const int right = pixel(camera.middle_x + camera.scale * high[0] + 2.0, width_);
    const int top = pixel(camera.middle_y - camera.scale * high[1] - 1.0, height_);
    const int bottom = pixel(camera.middle_y - camera.scale * low[1] + 2.0, height_);
    for (int y = top; y < bottom; ++y)
      std::fill(covered_.begin() + static_cast<std::ptrdiff_t>(y) * width_ + left,
                covered_.begin() + static_cast<std::ptrdiff_t>(y) * width_ + std::max(left, right), char{1});
  }

  int width_, height_;
  std::vector<char> covered_;
};

/// A tile of subpixels with an apron wide enough to look for lines.
class Tile {
 public:
  Tile(const Camera& camera, const Coverage& coverage, const Shader& shader, const Style& style, int line,
       float line_limit)
      : camera_(camera),
        coverage_(coverage),
        shader_(shader),
        style_(style),
        line_(line),
        line_limit_(line_limit) {
    n_ = style.samples;
    // Bundles are squares of 4 x 4 subpixels, so the apron is a multiple of 4.
    apron_ = style.outlines ? (line + 3) / 4 * 4 : 0;
    side_ = kTile * n_ + 2 * apron_;
    light_.resize(static_cast<std::size_t>(side_) * side_);
    body_.resize(light_.size());
    radius_.resize(light_.size());
  }

  void render(int left, int top, Image& image) {
    for (int y = 0; y < side_; y += 4)
      for (int x = 0; x < side_; x += 4) shoot(left * n_ - apron_, top * n_ - apron_, x, y);
    const Vec3 paper(to_linear(style_.paper().x()), to_linear(style_.paper().y()),
                     to_linear(style_.paper().z()));
    for (int y = top; y < std::min(top + kTile, image.height); ++y)
      for (int x = left; x < std::min(left + kTile, image.width); ++x)
        resolve(x - left, y - top, paper, image.pixel(x, y));
  }

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * side_ + x; }

  void shoot(int left, int top, int x, int y) {
    Bundle bundle;
    const int last = apron_ + kTile * n_;
    bundle.lit = x >= apron_ && x < last && y >= apron_ && y < last;
    bundle.samples = static_cast<std::uint32_t>(n_ * n_);
    bool covered = false;
    for (int i = 0; i < kLanes; ++i) {
      const int sx = left + x + i % 4, sy = top + y + i / 4;
      // Subpixels of the apron may lie outside the picture: the offset keeps the division a rounding down.
      const int offset = kTile * n_;
      const int px = (sx + offset) / n_, py = (sy + offset) / n_;
      covered = covered || coverage_(px - kTile, py - kTile);
      bundle.pixel_x[i] = static_cast<std::uint32_t>(px);
      bundle.pixel_y[i] = static_cast<std::uint32_t>(py);
      bundle.sample[i] = static_cast<std::uint32_t>((sy + offset) % n_ * n_ + (sx + offset) % n_);
      camera_.ray((sx + 0.5) / n_, (sy + 0.5) / n_, bundle.origin[i], bundle.direction[i]);
    }
    if (!covered) {
      for (int i = 0; i < kLanes; ++i) body_[at(x + i % 4, y + i / 4)] = Seen::kNothing;
      return;
    }
    Seen seen;
    shader_(bundle, seen);
    for (int i = 0; i < kLanes; ++i) {
      const std::size_t k = at(x + i % 4, y + i / 4);
      light_[k] = seen.light[i];
      body_[k] = seen.body[i];
      radius_[k] = seen.radius[i];
    }
  }

  /// Part of the neighbours at the distance of a line that belong to another body.
  float foreign(int x, int y) const {
    const std::size_t k = at(x, y);
    // A line must not swallow small balls.
    const int reach = std::min(line_, static_cast<int>(line_limit_ * radius_[k]));
    if (reach < 1) return 0.0f;
    const int near = std::max(1, reach * 7 / 10);
    const std::uint64_t own = body_[k];
    int count = 0;
    count += body_[at(x - reach, y)] != own;
    count += body_[at(x + reach, y)] != own;
    count += body_[at(x, y - reach)] != own;
    count += body_[at(x, y + reach)] != own;
    count += body_[at(x - near, y - near)] != own;
    count += body_[at(x + near, y - near)] != own;
    count += body_[at(x - near, y + near)] != own;
    count += body_[at(x + near, y + near)] != own;
    return std::min(1.0f, static_cast<float>(count) / 3.0f);
  }

  void resolve(int px, int py, const Vec3& paper, std::uint8_t* pixel) const {
    Vec3 sum = Vec3::Zero();
    for (int y = apron_ + py * n_; y < apron_ + (py + 1) * n_; ++y) {
      for (int x = apron_ + px * n_; x < apron_ + (px + 1) * n_; ++x) {
        const std::size_t k = at(x, y);
        if (body_[k] == Seen::kNothing) {
          sum += paper;
        } else {
          const float line = style_.outlines ? kLineDarkening * foreign(x, y) : 0.0f;
          sum += ((1.0f - line) * light_[k]).cwiseMin(1.0f).cast<double>();
        }
      }
    }
    for (int c = 0; c < 3; ++c)
      pixel[c] = static_cast<std::uint8_t>(std::lround(255.0 * to_srgb(sum[c] / (n_ * n_))));
  }

  const Camera& camera_;
  const Coverage& coverage_;
  const Shader& shader_;
  const Style& style_;
  int n_, line_;      // subpixels per pixel and axis; half width of a line in subpixels
  float line_limit_;  // subpixels per unit of the scene, times the part of a ball's radius a line may take
  int apron_, side_;  // subpixels
  std::vector<Vec3f> light_;
  std::vector<std::uint64_t> body_;
  std::vector<float> radius_;
};

}  // namespace

double pixels_per_metre(const View& view, const Rectangle& room) {
  return std::min(room.width / view.width, room.height / view.height);
}

Image trace(const std::vector<Ball>& balls, const View& view, int width, int height, const Rectangle& room,
            const Style& style, const std::vector<Facet>& facets) {
  const int n = style.samples;
  if (n != 1 && n != 2 && n != 4 && n != 8)
    throw InputError("samples per pixel and axis must be 1, 2, 4 or 8, not {}", n);
  if (style.sky_rays < 1 || style.sky_rays > 64)
    throw InputError("sky rays per sample must be in 1..64, not {}", style.sky_rays);
  Image image = Image::filled(width, height, style.paper());
  const Scene scene(balls, facets, view);
  const Shader shader(scene, view.sun.cast<float>(), style.sky_rays);
  const double unit = 0.5 * std::max(view.width, view.height);
  const Camera camera{room.left + 0.5 * room.width, room.top + 0.5 * room.height,
                      unit * pixels_per_metre(view, room), scene.front(), eye_distance(view)};
  const Coverage coverage(scene, camera, width, height);
  const auto line = static_cast<int>(std::lround(
      std::max(0.5f, kLineWidth * static_cast<float>(std::min(width, height))) * static_cast<float>(n)));
  const auto line_limit = static_cast<float>(0.12 * camera.scale * n);
  const auto columns = static_cast<std::size_t>((width + kTile - 1) / kTile);
  const auto rows = static_cast<std::size_t>((height + kTile - 1) / kTile);
  parallel_blocks(columns * rows, 1, [&](std::size_t begin, std::size_t end) {
    Tile tile(camera, coverage, shader, style, line, line_limit);
    for (std::size_t i = begin; i < end; ++i)
      tile.render(static_cast<int>(i % columns) * kTile, static_cast<int>(i / columns) * kTile, image);
  });
  return image;
}

}  // namespace cairn::render
