#include "gravity/renewal.h"

#include <gtest/gtest.h>

#include "clouds.h"
#include "gravity/conserve.h"
#include "gravity/direct.h"

namespace cairn::gravity {
namespace {

struct Wrenches {
  std::vector<Vec3> force, torque;
};

// Net force, and net torque about the mass centre, over the sums of magnitudes.
Net net_of(const Cloud& centres, const Wrenches& w) {
  const MassCentre all = mass_centre(centres.x, centres.mass);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double forces = 0.0, torques = 0.0;
  for (std::size_t g = 0; g < centres.size(); ++g) {
    const Vec3 d = centres.x[g] - all.centre;
    force += w.force[g];
    torque += d.cross(w.force[g]) + w.torque[g];
    forces += w.force[g].norm();
    torques += d.norm() * w.force[g].norm() + w.torque[g].norm();
  }
  return {force.norm() / forces, torque.norm() / torques};
}

Wrenches held_at(const HeldGravity& held, double time, const Cloud& centres) {
  Wrenches w{std::vector<Vec3>(centres.size()), std::vector<Vec3>(centres.size())};
  extrapolate(held, time, centres.x, centres.mass, w.force, w.torque);
  return w;
}

Wrenches evaluated(const Cloud& cloud) {
  return {[&] {
            std::vector<Vec3> force = evaluate(DirectSum(), cloud).acceleration;
            for (std::size_t i = 0; i < cloud.size(); ++i) force[i] *= cloud.mass[i];
            return force;
          }(),
          std::vector<Vec3>(cloud.size(), Vec3::Zero())};
}

TEST(Renewal, ReturnsTheEvaluationAtItsTime) {
  const Cloud cloud = ball(300);
  const Wrenches w = evaluated(cloud);
  HeldGravity held;
  renew(held, cloud.x, cloud.mass, w.force, w.torque, 12.5, Vec3(0, 0, 1e-3));
  EXPECT_LT(rms_error(held.force, w.force), 1e-13);
  const Wrenches now = held_at(held, 12.5, cloud);
  EXPECT_EQ(now.force, held.force);
  EXPECT_EQ(now.torque, held.torque);
}

TEST(Renewal, FollowsARigidRotationExactly) {
  Cloud cloud = ball(300);
  Wrenches w = evaluated(cloud);
  Random random(3, 0);
  for (Vec3& torque : w.torque) torque = 1e3 * random.in_ball();
  const Vec3 omega(1e-4, -2e-4, 7e-4);
  HeldGravity held;
  renew(held, cloud.x, cloud.mass, w.force, w.torque, 0.0, omega);
  const double time = 2000.0;
  const Quat turn(Eigen::AngleAxisd(omega.norm() * time, omega.normalized()));
  for (Vec3& x : cloud.x) x = turn * x;
  const Wrenches now = held_at(held, time, cloud);
  std::vector<Vec3> force, torque;  // what a turned pile feels is what it felt, turned
  for (std::size_t g = 0; g < cloud.size(); ++g) {
    force.push_back(turn * held.force[g]);
    torque.push_back(turn * held.torque[g]);
  }
  EXPECT_LT(rms_error(now.force, force), 1e-12);
  EXPECT_LT(rms_error(now.torque, torque), 1e-12);
  // The torques have been balanced by forces, small against those of gravity.
  EXPECT_LT(rms_error(now.force, evaluated(cloud).force), 1e-2);
}

// The pile turns, its bodies creep, and it turns at another rate than the hold supposes: nothing leaks.
TEST(Renewal, AngularMomentumStaysOverManySteps) {
  Cloud cloud = ball(200);
  Random random(2, 0);
  const double dt = 5.0;
  const Vec3 omega(0.0, 0.0, 6e-4);
  std::vector<Vec3> v(cloud.size()), spin(cloud.size(), Vec3::Zero());
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = omega.cross(cloud.x[i]) + 2e-3 * random.in_ball();
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sums = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < v.size(); ++i) {
      sums.head<3>() += cloud.mass[i] * v[i];
      sums.tail<3>() += cloud.mass[i] * cloud.x[i].cross(v[i]) + spin[i];
    }
    return sums;
  };
  const auto start = momenta();
  HeldGravity held;
  for (int step = 0; step < 4000; ++step) {
    const double time = step * dt;
    if (step % 100 == 0) {
      Wrenches w = evaluated(cloud);
      for (Vec3& torque : w.torque) torque = 1e3 * random.in_ball();
      renew(held, cloud.x, cloud.mass, w.force, w.torque, time, 0.9 * omega);
    }
    const Wrenches w = held_at(held, time, cloud);
    ASSERT_LT(net_of(cloud, w).torque, 1e-13);
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] += dt / cloud.mass[i] * w.force[i];
      spin[i] += dt * w.torque[i];
      cloud.x[i] += dt * v[i];
    }
  }
  EXPECT_LT((momenta() - start).tail<3>().norm(), 1e-11 * start.tail<3>().norm());
  EXPECT_LT((momenta() - start).head<3>().norm(), 1e-9 * 200 * 1.5e9 * omega.norm() * 400);
}

TEST(Renewal, ABinaryFarApartKeepsItsAngularMomentum) {
  Cloud cloud;
  cloud.add_group({{1e9, 0, 0}}, 5e11);
  cloud.add_group({{0, 0, 0}}, 1e10);
  HeldGravity held;
  const Wrenches w{{Vec3(-3, 0.2, 0), Vec3(3.1, 0, 0)}, {Vec3(5, 1, 0), Vec3(2, 0, 7)}};
  renew(held, cloud.x, cloud.mass, w.force, w.torque, 0.0, Vec3(0, 0, 1e-6));
  for (const double time : {0.0, 1e3, 1e6}) {
    cloud.x[0] += Vec3(0.0, time, 0.1 * time);
    const Wrenches now = held_at(held, time, cloud);
    EXPECT_LT(net_of(cloud, now).force, 1e-14);
    EXPECT_LT(net_of(cloud, now).torque, 1e-14);
    EXPECT_LT(now.force[0].norm(), 4.0);
  }
}

// A net torque goes into forces on the centres, not into spins, wherever these have a lever.
TEST(Renewal, LooseSpheresAreNotSpun) {
  const Cloud cloud = ball(100);
  Wrenches w = evaluated(cloud);
  for (std::size_t g = 0; g < cloud.size(); ++g) w.force[g] += 1e-3 * w.force[g].cross(Vec3::UnitZ());
  double force = 0.0;
  for (const Vec3& f : w.force) force += f.norm();
  remove_net_wrench(cloud.x, cloud.mass, w.force, w.torque);
  for (const Vec3& torque : w.torque) EXPECT_LT(torque.norm(), 1e-14 * 400.0 * force);
}

TEST(Renewal, ALargeNetIsRemovedToTheRoundOffOfTheRest) {
  const Cloud cloud = ball(300);
  Wrenches w = evaluated(cloud);
  double largest = 0.0;
  for (const Vec3& f : w.force) largest = std::max(largest, f.norm());
  for (std::size_t g = 0; g < cloud.size(); ++g)
    w.force[g] += 1e6 * largest * (cloud.mass[g] / cloud.mass[0]) * Vec3(0.1, 0.7, -0.3);
  remove_net_wrench(cloud.x, cloud.mass, w.force, w.torque);
  EXPECT_LT(net_of(cloud, w).force, 1e-14);
  EXPECT_LT(net_of(cloud, w).torque, 1e-14);
}

TEST(Renewal, OneGroupFeelsNothingOfItself) {
  Cloud cloud;
  cloud.add_group({{1, 2, 3}}, 4.0);
  HeldGravity held;
  renew(held, cloud.x, cloud.mass, std::vector<Vec3>{{1, 0, 0}}, std::vector<Vec3>{{0, 1, 0}}, 0.0,
        Vec3::Zero());
  EXPECT_LT(held.force[0].norm() + held.torque[0].norm(), 1e-15);
}

}  // namespace
}  // namespace cairn::gravity
