#include "gravity/conserve.h"

#include <gtest/gtest.h>
#include <omp.h>

#include "clouds.h"
#include "gravity/direct.h"
#include "gravity/fmm.h"

namespace cairn::gravity {
namespace {

TEST(Conserve, NothingIsLeftOfNetForceAndTorque) {
  const Cloud cloud = ball(5000, 4);
  Field f = evaluate(Fmm({.theta = 1.0, .order = 4}), cloud);
  EXPECT_GT(net(cloud, f.acceleration).torque, 1e-8);
  const std::vector<Vec3> before = f.acceleration;
  remove_net(cloud.x, cloud.mass, f.acceleration);
  EXPECT_LT(net(cloud, f.acceleration).force, 1e-14);
  EXPECT_LT(net(cloud, f.acceleration).torque, 1e-14);
  EXPECT_LT(rms_error(f.acceleration, before), 1e-3);  // a small change
}

TEST(Conserve, ALargeNetIsRemovedToo) {
  Cloud cloud = ball(500);
  for (Vec3& x : cloud.x) x += Vec3(1e7, -3e6, 0.0);
  Field f = evaluate(DirectSum(), cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    f.acceleration[i] += Vec3(1.0, 2.0, 3.0) + Vec3(0, 0, 1e-3).cross(cloud.x[i]);
  const std::vector<Vec3> reference = evaluate(DirectSum(), cloud).acceleration;
  remove_net(cloud.x, cloud.mass, f.acceleration);
  EXPECT_LT(rms_error(f.acceleration, reference), 1e-6);
}

TEST(Conserve, ALargeNetIsRemovedToTheRoundOffOfTheRest) {
  const Cloud cloud = ball(500);
  Field f = evaluate(DirectSum(), cloud);
  double largest = 0.0;
  for (const Vec3& a : f.acceleration) largest = std::max(largest, a.norm());
  for (Vec3& a : f.acceleration) a += 1e6 * largest * Vec3(0.1, 0.7, -0.3);
  remove_net(cloud.x, cloud.mass, f.acceleration);
  EXPECT_LT(net(cloud, f.acceleration).force, 1e-14);
  EXPECT_LT(net(cloud, f.acceleration).torque, 1e-14);
}

TEST(Conserve, LinesAndPlacesHaveNoFalseTurn) {
  Cloud line, place;
  for (int i = 0; i < 50; ++i) {
    line.add_group({Vec3(0.3, 0.5, 0.7) * i}, 1.0);
    place.add_group({Vec3(2.0, 0.0, 0.0)}, 1.0);
  }
  for (const Cloud* cloud : {&line, &place}) {
    std::vector<Vec3> a(cloud->size());
    for (std::size_t i = 0; i < a.size(); ++i) a[i] = Vec3(std::sin(i), std::cos(2.0 * i), std::sin(3.0 * i));
    remove_net(cloud->x, cloud->mass, a);
    for (const Vec3& v : a) EXPECT_LT(v.norm(), 5.0);
    EXPECT_LT(net(*cloud, a).force, 1e-14);
  }
  std::vector<Vec3> across(50);
  for (std::size_t i = 0; i < across.size(); ++i) across[i] = Vec3(0.7, 0.0, -0.3) * std::sin(2.0 * i);
  remove_net(line.x, line.mass, across);
  EXPECT_LT(net(line, across).torque, 1e-14);
  std::vector<Vec3> nothing(50, Vec3::UnitX());
  remove_net(line.x, std::vector<double>(50, 0.0), nothing);
  EXPECT_EQ(nothing[0], Vec3(Vec3::UnitX()));
}

TEST(Conserve, SameBitsForAnyNumberOfThreads) {
  const Cloud cloud = ball(3000);
  const Field f = evaluate(Fmm(), cloud);
  const int threads = omp_get_max_threads();
  std::vector<std::vector<Vec3>> results;
  for (const int t : {1, 2}) {
    omp_set_num_threads(t);
    results.push_back(f.acceleration);
    remove_net(cloud.x, cloud.mass, results.back());
  }
  omp_set_num_threads(threads);
  EXPECT_EQ(results[0], results[1]);
}

TEST(Conserve, GroupForcesAndTorques) {
  const std::vector<Vec3> x{{1, 0, 0}, {-1, 0, 0}, {5, 5, 5}}, a{{0, 1, 0}, {0, -1, 0}, {1, 2, 3}};
  const std::vector<double> mass{2, 2, 3};
  const std::vector<std::uint32_t> first{0, 2, 3};
  const std::vector<Vec3> centres{{0, 0, 0}, {5, 5, 5}};
  std::vector<Vec3> force(2), torque(2);
  sum_groups(x, mass, first, a, centres, force, torque);
  EXPECT_EQ(force[0], Vec3(0, 0, 0));
  EXPECT_EQ(torque[0], Vec3(0, 0, 4));
  EXPECT_EQ(force[1], Vec3(3, 6, 9));
  EXPECT_EQ(torque[1], Vec3(0, 0, 0));
}

}  // namespace
}  // namespace cairn::gravity
