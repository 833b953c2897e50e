// Error against cost of gravity, as a section of BENCHMARKS.md on the standard output and a plot
// FOLDER/gravity.svg. Times are processor seconds of one thread, the least of several runs.
//   gravity_report FOLDER
#include <fmt/core.h>
#include <omp.h>

#include <ctime>
#include <fstream>

#include "gravity/accuracy.h"
#include "gravity/direct.h"
#include "physics/svg.h"
#include "unit/gravity/clouds.h"

namespace cairn::gravity {
namespace {

double processor_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Equal points in a uniform ball.
Cloud uniform(std::size_t n, std::uint64_t seed) {
  Cloud cloud = ball(n, 1, seed);
  std::fill(cloud.mass.begin(), cloud.mass.end(), 1e9);
  return cloud;
}

/// At most a thousand points, and the exact field there.
struct Reference {
  std::vector<std::size_t> points;
  std::vector<Vec3> field;

  explicit Reference(const Cloud& cloud) {
    const std::size_t stride = std::max<std::size_t>(1, cloud.size() / 1000);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
      Vec3 a = Vec3::Zero();
      for (std::size_t j = 0; j < cloud.size(); ++j) {
        const Vec3 d = cloud.x[j] - cloud.x[i];
        const double r2 = d.squaredNorm();
        if (j != i) a += cloud.mass[j] / (r2 * std::sqrt(r2)) * d;
      }
      points.push_back(i);
      field.push_back(kGravitationalConstant * a);
    }
  }
};

struct Result {
  double rms = 0.0, tail = 0.0, seconds = 0.0;  ///< tail: 99.9 %
};

Result measure(Fmm& method, const Cloud& cloud, const Reference& reference, int runs) {
  std::vector<Vec3> all(cloud.size()), sample;
  Result out{.seconds = 1e9};
  for (int k = 0; k < runs; ++k) {
    const double start = processor_seconds();
    method.evaluate(cloud.points(), all);
    out.seconds = std::min(out.seconds, processor_seconds() - start);
  }
  for (const std::size_t i : reference.points) sample.push_back(all[i]);
  out.rms = rms_error(sample, reference.field);
  out.tail = quantile_error(sample, reference.field, 0.999);
  return out;
}

std::string text(const Result& r) {
  return fmt::format("{:.1e} / {:.1e} / {:.3g}", r.rms, r.tail, 1e3 * r.seconds);
}

void by_request() {
  constexpr double kErrors[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
  fmt::print(
      "By the error asked for: RMS error / 99.9 % / milliseconds, equal points in a uniform ball, the worst "
      "of five "
      "seeds (one from 100 000 points on).\n\n| N | direct sum, ms |");
  for (const double error : kErrors) fmt::print(" {:.0e} |", error);
  fmt::print("\n|---|---|---|---|---|---|---|\n");
  for (const std::size_t n : {1000u, 10000u, 40000u, 100000u, 1000000u}) {
    const int runs = n > 40000 ? 2 : 5, seeds = n > 40000 ? 1 : 5;
    double direct = 0.0;
    std::vector<Result> worst(std::size(kErrors));
    for (int seed = 1; seed <= seeds; ++seed) {
      const Cloud cloud = uniform(n, static_cast<std::uint64_t>(seed));
      const Reference reference(cloud);
      if (seed == 1 && n <= 40000) {
        std::vector<Vec3> field(n);
        DirectSum method;
        const double start = processor_seconds();
        method.evaluate(cloud.points(), field);
        direct = processor_seconds() - start;
      }
      for (std::size_t k = 0; k < std::size(kErrors); ++k) {
        const Accuracy found = choose_accuracy(cloud.points(), kErrors[k]);
        Fmm method(found.settings);
        method.set_tolerance(found.factor * found.scale);
        const Result r = measure(method, cloud, reference, runs);
        worst[k] = {std::max(worst[k].rms, r.rms), std::max(worst[k].tail, r.tail),
                    std::max(worst[k].seconds, r.seconds)};
      }
    }
    fmt::print("| {} | {} |", n, direct > 0.0 ? fmt::format("{:.3g}", 1e3 * direct) : "-");
    for (const Result& r : worst) fmt::print(" {} |", text(r));
    fmt::print("\n");
    std::fflush(stdout);
  }
}

void by_hand(const std::string& folder) {
  constexpr double kAngles[] = {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
  const Cloud cloud = uniform(40000, 1);
  const Reference reference(cloud);
  std::vector<report::Curve> curves;
  fmt::print("\nBy opening angle and order, N = 40 000.\n\n| order |");
  for (const double angle : kAngles) fmt::print(" {} |", angle);
  fmt::print("\n|---|---|---|---|---|---|---|---|\n");
  for (int order = 4; order <= 7; ++order) {
    report::Curve curve{fmt::format("order {}, by angle", order), {}, {}};
    fmt::print("| {} |", order);
    for (const double angle : kAngles) {
      Fmm method({.theta = angle, .order = order});
      const Result r = measure(method, cloud, reference, 3);
      fmt::print(" {} |", text(r));
      curve.x.push_back(r.seconds);
      curve.y.push_back(r.rms);
    }
    fmt::print("\n");
    curves.push_back(curve);
  }
  report::Curve request{"by the error asked for", {}, {}};
  for (const double error : {3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7}) {
    const Accuracy found = choose_accuracy(cloud.points(), error);
    Fmm method(found.settings);
    method.set_tolerance(found.factor * found.scale);
    const Result r = measure(method, cloud, reference, 3);
    request.x.push_back(r.seconds);
    request.y.push_back(r.rms);
  }
  curves.push_back(request);
  std::ofstream(folder + "/gravity.svg")
      << report::svg({"seconds of one core, 40 000 points", "RMS error of the field", true, true}, curves);
  fmt::print("\n![Error against cost of gravity](validation/gravity.svg)\n");
}

}  // namespace
}  // namespace cairn::gravity

int main(int count, char** arguments) {
  if (count != 2) {
    fmt::print(stderr, "usage: gravity_report FOLDER\n");
    return 2;
  }
  omp_set_num_threads(1);
  cairn::gravity::by_request();
  cairn::gravity::by_hand(arguments[1]);
}
