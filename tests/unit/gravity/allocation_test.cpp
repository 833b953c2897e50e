// After its first evaluation gravity allocates nothing.
#include <gtest/gtest.h>
#include <omp.h>

#include "allocations.h"
#include "clouds.h"
#include "gravity/direct.h"
#include "gravity/fmm.h"
#include "gravity/self_gravity.h"

namespace cairn::gravity {
namespace {

template <class Work>
long allocations(Work&& work) {
  work();
  work();
  const long before = g_allocations;
  work();
  return g_allocations - before;
}

TEST(Allocation, NoneAfterWarmUp) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // of several, one may meet its largest task late
  const Cloud cloud = ball(3000, 3);
  std::vector<Vec3> acceleration(cloud.size()), centres, force(cloud.first.size() - 1), torque(force.size());
  for (std::size_t g = 0; g < force.size(); ++g) centres.push_back(cloud.x[cloud.first[g]]);
  const std::vector<double> masses(force.size(), 1e9);
  DirectSum direct;
  Fmm fmm;
  HeldGravity held;
  Wrenches wrenches;
  double time = 0.0;
  EXPECT_EQ(allocations([&] { direct.evaluate(cloud.points(), acceleration); }), 0);
  EXPECT_EQ(allocations([&] { fmm.evaluate(cloud.points(), acceleration); }), 0);
  EXPECT_EQ(allocations([&] {
              sum_groups(cloud.x, cloud.mass, cloud.first, acceleration, centres, wrenches);
              renew(held, wrenches, masses, time, Vec3(0, 0, 1e-4), 1.0, true,
                    [] { return std::uint64_t{5}; });
              const SelfGravity gravity(held, time + 1.0, centres, masses);
              gravity.get(0, centres.size(), force, torque);
              time += 5.0;
            }),
            0);
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace cairn::gravity
