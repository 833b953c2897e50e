#include "gravity/conserve-inl.h"

#include <gtest/gtest.h>

#include "clouds.h"
#include "gravity/direct.h"

namespace cairn::gravity {
namespace {

using namespace HWY_NAMESPACE;

// Wrenches on groups, cleared of what is net.
Wrenches cleared(const Cloud& groups, const Wrenches& w) {
  Wrenches out{std::vector<Vec3>(groups.size()), std::vector<Vec3>(groups.size())};
  const auto at = [&](std::size_t g, std::size_t count) -> PackWrench {
    return {load(&w.force[g], count), load(&w.torque[g], count)};
  };
  const Vec3& origin = groups.x[0];
  const Balance change = balance(net_wrench(groups.x, groups.mass, origin, at), origin);
  for (std::size_t g = 0; g < groups.size(); g += kPack) {
    const std::size_t count = groups.size() - g;
    const PackWrench b =
        balanced(change, load(&groups.x[g], count), load_masses(groups.mass, g, count), at(g, count));
    store(&out.force[g], b.force, count);
    store(&out.torque[g], b.torque, count);
  }
  return out;
}

// Net force, and net torque about the first group, over the sums of magnitudes.
Net net_of(const Cloud& groups, const Wrenches& w) {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double forces = 0.0, torques = 0.0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Vec3 d = groups.x[g] - groups.x[0];
    force += w.force[g];
    torque += d.cross(w.force[g]) + w.torque[g];
    forces += w.force[g].norm();
    torques += d.norm() * w.force[g].norm() + w.torque[g].norm();
  }
  return {force.norm() / forces, torque.norm() / torques};
}

Wrenches evaluated(const Cloud& cloud) {
  Wrenches w{evaluate(DirectSum(), cloud).acceleration, std::vector<Vec3>(cloud.size(), Vec3::Zero())};
  for (std::size_t i = 0; i < cloud.size(); ++i) w.force[i] *= cloud.mass[i];
  return w;
}

TEST(Conserve, NothingIsLeftOfNetForceAndTorque) {
  Cloud cloud = ball(2000);
  for (Vec3& x : cloud.x) x += Vec3(1e7, -3e6, 0.0);
  const Wrenches exact = evaluated(cloud);
  Wrenches w = exact;
  Random random(1, 0);
  for (Vec3& f : w.force) f += 1e-3 * f.norm() * (random.in_ball() + Vec3(0.3, 0, 0));
  for (Vec3& t : w.torque) t = 1e4 * random.in_ball();
  EXPECT_GT(net_of(cloud, w).force, 1e-5);
  EXPECT_GT(net_of(cloud, w).torque, 1e-6);
  const Wrenches b = cleared(cloud, w);
  EXPECT_LT(net_of(cloud, b).force, 1e-15);
  EXPECT_LT(net_of(cloud, b).torque, 1e-15);
  EXPECT_LT(rms_error(b.force, w.force), 3e-3);  // a small change
  for (std::size_t g = 0; g < cloud.size(); ++g)
    EXPECT_LT((b.torque[g] - w.torque[g]).norm(), 1e-6);  // none is spun
}

// A heavy pile that does not quite balance itself, and a moon of it ten pile radii away: the moon's path is
// its own affair.
TEST(Conserve, AMoonFeelsLessOfThePilesBalanceThanThePile) {
  Cloud cloud = ball(1000);
  cloud.add_group({{4000, 0, 0}}, 1e10);
  const Wrenches exact = evaluated(cloud);
  Wrenches w = exact;
  for (std::size_t g = 0; g < 1000; ++g)
    w.force[g] += 1e-3 * cloud.mass[g] * Vec3(0, 0, 1e-6).cross(cloud.x[g]);  // a torque on the pile
  const double pull = exact.force[1000].norm();
  const double astray = rms_error(w.force, exact.force);
  EXPECT_GT(astray, 1e-4);
  EXPECT_LT((cleared(cloud, w).force[1000] - exact.force[1000]).norm(), 0.3 * astray * pull);
}

TEST(Conserve, LinesPlacesAndSingleGroupsAreBalancedByTheirTorques) {
  Cloud line, place, one;
  for (int i = 0; i < 50; ++i) {
    line.add_group({Vec3(0.3, 0.5, 0.7) * i}, 1.0);
    place.add_group({Vec3(2.0, 0.0, 0.0)}, 1.0);
  }
  one.add_group({{1, 2, 3}}, 4.0);
  for (const Cloud* cloud : {&line, &place, &one}) {
    Wrenches w;
    for (std::size_t i = 0; i < cloud->size(); ++i) {
      w.force.push_back(Vec3(std::sin(i), std::cos(2.0 * i), std::sin(3.0 * i)));
      w.torque.push_back(Vec3(1.0, std::sin(5.0 * i), 0.0));
    }
    const Wrenches b = cleared(*cloud, w);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t i = 0; i < cloud->size(); ++i) {
      EXPECT_LT(b.force[i].norm(), 10.0);
      force += b.force[i];
      torque += cloud->x[i].cross(b.force[i]) + b.torque[i];
    }
    EXPECT_LT(force.norm(), 1e-13);
    EXPECT_LT(torque.norm(), 1e-10);
  }
}

TEST(Conserve, ABinaryFarApartIsBalancedByALittleForce) {
  Cloud cloud;
  cloud.add_group({{1e9, 0, 0}}, 5e11);
  cloud.add_group({{0, 0, 0}}, 1e10);
  const Wrenches w = cleared(cloud, {{Vec3(-3, 0.2, 0), Vec3(3.1, 0, 0)}, {Vec3(5, 1, 0), Vec3(2, 0, 7)}});
  EXPECT_LT(net_of(cloud, w).force, 1e-15);
  EXPECT_LT(net_of(cloud, w).torque, 1e-15);
  EXPECT_LT(w.force[0].norm(), 4.0);
}

TEST(Conserve, WithoutForcesThereIsNothingToDo) {
  const Cloud cloud = ball(10);
  const std::vector<Vec3> none(10, Vec3::Zero());
  const Wrenches w = cleared(cloud, {none, none});
  for (std::size_t g = 0; g < 10; ++g) EXPECT_EQ(w.force[g].norm() + w.torque[g].norm(), 0.0);
}

TEST(Conserve, GroupForcesAndTorques) {
  const std::vector<Vec3> x{{1, 0, 0}, {-1, 0, 0}, {5, 5, 5}}, a{{0, 1, 0}, {0, -1, 0}, {1, 2, 3}};
  const std::vector<double> mass{2, 2, 3};
  const std::vector<std::uint32_t> first{0, 2, 3}, alone{0, 1, 2, 3};
  const std::vector<Vec3> centres{{0, 0, 0}, {5, 5, 5}};
  Wrenches w;
  sum_groups(x, mass, first, a, centres, w);
  EXPECT_EQ(w.force[0], Vec3(0, 0, 0));
  EXPECT_EQ(w.torque[0], Vec3(0, 0, 4));
  EXPECT_EQ(w.force[1], Vec3(3, 6, 9));
  EXPECT_EQ(w.torque[1], Vec3(0, 0, 0));
  sum_groups(x, mass, alone, a, x, w);
  EXPECT_EQ(w.force[2], Vec3(3, 6, 9));
  EXPECT_TRUE(w.torque.empty());
}

}  // namespace
}  // namespace cairn::gravity
