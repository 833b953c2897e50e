// Time of the gravity methods on a uniform ball of loose spheres, with the error against the direct sum as a
// counter.
#include <benchmark/benchmark.h>

#include "core/instruction_set.h"
#include "gravity/direct.h"
#include "gravity/fmm.h"
#include "unit/gravity/clouds.h"

namespace {

using namespace cairn::gravity;

void direct(benchmark::State& state) {
  const Cloud cloud = ball(static_cast<std::size_t>(state.range(0)));
  std::vector<cairn::Vec3> acceleration(cloud.size());
  DirectSum method;
  for (auto _ : state) method.evaluate(cloud.points(), acceleration);
  state.counters["pairs"] = benchmark::Counter(static_cast<double>(state.range(0) * state.range(0)),
                                               benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(direct)->Arg(2000)->Arg(10000)->Arg(40000)->Unit(benchmark::kMillisecond);

// Arguments: points, order, theta in hundredths, spheres of a group.
void fmm(benchmark::State& state) {
  const Cloud cloud =
      ball(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(3)));
  const double theta = 0.01 * static_cast<double>(state.range(2));
  std::vector<cairn::Vec3> acceleration(cloud.size()), reference(cloud.size());
  Fmm method({.theta = theta, .order = static_cast<int>(state.range(1))});
  for (auto _ : state) method.evaluate(cloud.points(), acceleration);
  DirectSum().evaluate(cloud.points(), reference);
  state.counters["rms"] = rms_error(acceleration, reference);
  state.counters["q999"] = quantile_error(acceleration, reference, 0.999);
}
BENCHMARK(fmm)
    ->ArgsProduct({{2000, 10000, 40000}, {4, 5}, {30, 40, 50, 60, 70, 80, 90, 100}, {1}})
    ->ArgsProduct({{40000}, {5}, {70}, {4, 100, 1000}})
    ->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  cairn::obey_environment();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
