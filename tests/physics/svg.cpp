#include "physics/svg.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace cairn::report {

namespace {

constexpr double kWidth = 640.0, kHeight = 400.0, kLeft = 80.0, kRight = 20.0, kTop = 16.0, kBottom = 56.0;
constexpr const char* kColors[] = {"#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"};

/// One axis: from values to 0 ... 1, with its ticks.
class Scale {
 public:
  Scale(bool log, const std::vector<Curve>& curves, std::vector<double> Curve::*values) : log_(log) {
    for (const Curve& c : curves)
      for (const double v : c.*values) {
        if (!shows(v)) continue;
        low_ = std::min(low_, at(v));
        high_ = std::max(high_, at(v));
      }
    if (!(high_ > low_)) {
      low_ -= 0.5;
      high_ = low_ + 1.0;
    }
    const double margin = 0.04 * (high_ - low_);
    low_ -= margin;
    high_ += margin;
  }

  bool shows(double v) const { return std::isfinite(v) && (!log_ || v > 0.0); }
  double operator()(double v) const { return (at(v) - low_) / (high_ - low_); }

  std::vector<double> ticks() const {
    std::vector<double> out;
    if (log_) {
      const int stride = std::max(1, static_cast<int>((high_ - low_) / 8.0) + (high_ - low_ > 8.0));
      for (int p = static_cast<int>(std::ceil(low_)); p <= high_; p += stride)
        out.push_back(std::pow(10.0, p));
      if (out.size() >= 2) return out;
      out.clear();
      for (int p = static_cast<int>(std::floor(low_)); p <= high_; ++p)
        for (const double m : {1.0, 2.0, 5.0})
          if (const double v = m * std::pow(10.0, p); at(v) >= low_ && at(v) <= high_) out.push_back(v);
      return out;
    }
    const double raw = (high_ - low_) / 6.0, power = std::pow(10.0, std::floor(std::log10(raw)));
    const double step = power * (raw / power < 1.5   ? 1.0
                                 : raw / power < 3.5 ? 2.0
                                 : raw / power < 7.5 ? 5.0
                                                     : 10.0);
    for (double k = std::ceil(low_ / step); k * step <= high_; ++k) out.push_back(k * step);
    return out;
  }

 private:
  double at(double v) const { return log_ ? std::log10(v) : v; }

  bool log_;
  double low_ = 1e300, high_ = -1e300;
};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return out;
}

/// Where the legend's first line begins: in the corner that hides the fewest points.
Eigen::Vector2d free_corner(const std::vector<Eigen::Vector2d>& points, const std::vector<Curve>& curves) {
  std::size_t longest = 0;
  for (const Curve& c : curves) longest = std::max(longest, c.label.size());
  const double wide = 18.0 + 7.0 * static_cast<double>(longest),
               high = 18.0 * static_cast<double>(curves.size());
  Eigen::Vector2d best;
  std::ptrdiff_t fewest = static_cast<std::ptrdiff_t>(points.size()) + 1;
  for (const double y : {kTop + 18.0, kHeight - kBottom - high + 6.0})
    for (const double x : {kLeft + 12.0, kWidth - kRight - wide - 6.0}) {
      const auto hidden = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector2d& p) {
        return p.x() > x - 12.0 && p.x() < x + wide + 12.0 && p.y() > y - 20.0 && p.y() < y + high;
      });
      if (hidden >= fewest) continue;
      fewest = hidden;
      best = {x, y};
    }
  return best;
}

}  // namespace

std::string svg(const Axes& axes, const std::vector<Curve>& curves) {
  const Scale x(axes.log_x, curves, &Curve::x), y(axes.log_y, curves, &Curve::y);
  const double wide = kWidth - kLeft - kRight, high = kHeight - kTop - kBottom;
  const auto px = [&](double v) { return kLeft + wide * x(v); };
  const auto py = [&](double v) { return kTop + high * (1.0 - y(v)); };
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      kWidth, kHeight);
  for (const double t : x.ticks())
    out += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\" "
        "text-anchor=\"middle\">{4:.4g}</text>\n",
        px(t), kTop, kTop + high, kTop + high + 18, std::abs(t) < 1e-12 ? 0.0 : t);
  for (const double t : y.ticks())
    out += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}H{2:.1f}\" stroke=\"#ddd\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5:.4g}</text>\n",
        kLeft, py(t), kLeft + wide, kLeft - 6, py(t) + 4,
        std::abs(t) < 1e-12 * std::abs(y.ticks().back()) ? 0.0 : t);
  out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#333\"/>\n",
                     kLeft, kTop, wide, high);
  out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", kLeft + 0.5 * wide,
                     kHeight - 14, escaped(axes.x));
  out +=
      fmt::format("<text transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                  kTop + 0.5 * high, escaped(axes.y));
  std::vector<Eigen::Vector2d> points;
  for (const Curve& c : curves)
    for (std::size_t p = 0; p < c.x.size(); ++p)
      if (x.shows(c.x[p]) && y.shows(c.y[p])) points.emplace_back(px(c.x[p]), py(c.y[p]));
  const Eigen::Vector2d legend = free_corner(points, curves);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const Curve& c = curves[k];
    const char* color = kColors[k % std::size(kColors)];
    std::string path, marks;
    const bool few = c.x.size() <= 60;
    for (std::size_t p = 0; p < c.x.size(); ++p) {
      if (!x.shows(c.x[p]) || !y.shows(c.y[p])) continue;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', px(c.x[p]), py(c.y[p]));
      if (few || !c.line)
        marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>", px(c.x[p]), py(c.y[p]),
                             few ? 3 : 1.5);
    }
    if (c.line)
      out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", path, color);
    out += fmt::format("<g fill=\"{}\">{}</g>\n", color, marks);
    if (!c.label.empty()) {
      const double at = legend.y() + 18 * static_cast<double>(k);
      out += fmt::format(
          "<rect x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"12\" height=\"4\" fill=\"{2}\"/><text x=\"{3:.1f}\" "
          "y=\"{4:.1f}\">"
          "{5}</text>\n",
          legend.x(), at - 6, color, legend.x() + 18, at, escaped(c.label));
    }
  }
  return out + "</svg>\n";
}

}  // namespace cairn::report
