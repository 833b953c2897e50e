#include "gravity/self_gravity.h"

#include <gtest/gtest.h>

#include "clouds.h"
#include "gravity/accuracy.h"
#include "gravity/direct.h"

namespace cairn::gravity {
namespace {

// Net force, and net torque about the mass centre, over the sums of magnitudes.
Net net_of(const Cloud& centres, const Wrenches& w) {
  Vec3 centre = Vec3::Zero(), force = Vec3::Zero(), torque = Vec3::Zero();
  double mass = 0.0, forces = 0.0, torques = 0.0;
  for (std::size_t g = 0; g < centres.size(); ++g) {
    centre += centres.mass[g] * centres.x[g];
    mass += centres.mass[g];
  }
  for (std::size_t g = 0; g < centres.size(); ++g) {
    const Vec3 d = centres.x[g] - centre / mass;
    force += w.force[g];
    torque += d.cross(w.force[g]) + w.torque[g];
    forces += w.force[g].norm();
    torques += d.norm() * w.force[g].norm() + w.torque[g].norm();
  }
  return {force.norm() / forces, torque.norm() / torques};
}

Wrenches at(const HeldGravity& held, double time, const Cloud& centres) {
  Wrenches w{std::vector<Vec3>(centres.size()), std::vector<Vec3>(centres.size())};
  const SelfGravity gravity(held, time, centres.x, centres.mass);
  gravity.get(0, centres.size(), w.force, w.torque);
  return w;
}

// Forces of loose spheres in the pile's frame, turned back by `attitude` about the origin.
Wrenches evaluated(const Cloud& cloud, const Quat& attitude = Quat::Identity()) {
  Wrenches w{evaluate(DirectSum(), cloud).acceleration, {}};
  for (std::size_t i = 0; i < cloud.size(); ++i)
    w.force[i] = attitude.conjugate() * (cloud.mass[i] * w.force[i]);
  return w;
}

Quat turned(const Vec3& angle) {
  return Quat(Eigen::AngleAxisd(angle.norm(), angle.normalized()));
}

// An evaluation that counts until it is replaced `steps` steps of 1 s later.
void hold(HeldGravity& held, const Wrenches& w, const Cloud& cloud, const Vec3& omega, std::uint64_t steps) {
  renew(held, w, cloud.mass, 0.0, omega, 1.0, true, [=] { return steps; });
}

TEST(Renewal, AnEvaluationCountsAtItsTime) {
  const Cloud cloud = ball(300);
  const Wrenches w = evaluated(cloud);
  HeldGravity held;
  hold(held, w, cloud, Vec3(0, 0, 1e-3), 10);
  const Wrenches now = at(held, 0.0, cloud);
  EXPECT_LT(rms_error(now.force, w.force), 1e-14);
  for (const Vec3& torque : now.torque) EXPECT_LT(torque.norm(), 1e-20);
}

TEST(Renewal, FollowsARigidRotationExactly) {
  Cloud cloud = ball(300);
  Wrenches w = evaluated(cloud);
  Random random(3, 0);
  Vec3 sum = Vec3::Zero();
  for (std::size_t g = 0; g < cloud.size(); ++g) w.torque.push_back(1e3 * random.in_ball());
  for (const Vec3& torque : w.torque) sum += torque;
  for (Vec3& torque : w.torque) torque -= sum / 300.0;
  const Vec3 omega(1e-4, -2e-4, 7e-4);
  HeldGravity held;
  hold(held, w, cloud, omega, 10);
  const double time = 2000.0;
  const Quat turn = turned(time * omega);
  for (Vec3& x : cloud.x) x = turn * x;
  const Wrenches now = at(held, time, cloud);
  std::vector<Vec3> force, torque;  // what a turned pile feels is what it felt, turned
  for (std::size_t g = 0; g < cloud.size(); ++g) {
    force.push_back(turn * w.force[g]);
    torque.push_back(turn * w.torque[g]);
  }
  EXPECT_LT(rms_error(now.force, force), 1e-12);
  EXPECT_LT(rms_error(now.torque, torque), 1e-12);
  EXPECT_LT(rms_error(now.force, evaluated(cloud).force), 1e-12);
}

// Bodies on circles, each at its own rate: the field changes in the pile's frame as well.
struct Swirl {
  Cloud cloud = ball(200);
  std::vector<double> rate;
  Vec3 omega = Vec3(0, 0, 6e-4);

  Swirl() {
    Random random(5, 0);
    for (std::size_t i = 0; i < cloud.size(); ++i) rate.push_back(6e-4 + 2e-4 * random.uniform());
  }
  Cloud at(double time) const {
    Cloud now = cloud;
    for (std::size_t i = 0; i < now.size(); ++i) now.x[i] = turned(rate[i] * time * Vec3::UnitZ()) * now.x[i];
    return now;
  }
};

// Worst error of the force between renewals `steps` s apart, and the largest jump where one follows another.
struct Course {
  double error = 0.0, jump = 0.0, miss = 0.0;
};
Course follow(const Swirl& swirl, std::uint64_t steps) {
  Course course;
  HeldGravity held;
  for (int renewal = 0; renewal < 6; ++renewal) {
    const double time = static_cast<double>(steps) * renewal;
    const Cloud now = swirl.at(time);
    const Wrenches before = renewal > 0 ? at(held, time, now) : Wrenches{};
    renew(held, evaluated(now, attitude_at(held, time)), now.mass, time, swirl.omega, 1.0, true,
          [=] { return steps; });
    if (renewal > 0) course.jump = std::max(course.jump, rms_error(at(held, time, now).force, before.force));
    if (renewal < 2) continue;  // no forecast yet, or none to go on from
    course.miss = std::max(course.miss, held.miss);
    for (int part = 0; part < 4; ++part) {
      const double later = time + 0.25 * part * static_cast<double>(steps);
      const Cloud then = swirl.at(later);
      course.error = std::max(course.error, rms_error(at(held, later, then).force, evaluated(then).force));
    }
  }
  return course;
}

TEST(Renewal, IsContinuousAndOfSecondOrder) {
  const Swirl swirl;
  const Course coarse = follow(swirl, 40), fine = follow(swirl, 20);
  EXPECT_LT(coarse.jump, 1e-4 * coarse.error);  // the attitude and the balance are rounded
  EXPECT_NEAR(std::log2(coarse.error / fine.error), 2.0, 0.3);
  EXPECT_NEAR(std::log2(coarse.miss / fine.miss), 2.0, 0.3);
  EXPECT_LT(fine.error, 3.0 * fine.miss);
}

TEST(Renewal, AnIntervalOfOneStepTakesEachEvaluation) {
  const Swirl swirl;
  for (const bool forecasts : {false, true}) {
    HeldGravity held;
    for (int step = 0; step < 4; ++step) {
      const Cloud now = swirl.at(10.0 * step);
      renew(held, evaluated(now, attitude_at(held, 10.0 * step)), now.mass, 10.0 * step, swirl.omega, 10.0,
            forecasts, [] { return std::uint64_t{1}; });
      EXPECT_LT(rms_error(at(held, 10.0 * step, now).force, evaluated(now).force), 1e-12);
    }
    EXPECT_EQ(held.to.force.empty(), !forecasts);
  }
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
      Wrenches w = evaluated(cloud, attitude_at(held, time));
      for (std::size_t g = 0; g < cloud.size(); ++g) w.torque.push_back(1e3 * random.in_ball());
      renew(held, w, cloud.mass, time, 0.9 * omega, dt, true, [] { return std::uint64_t{100}; });
    }
    const Wrenches w = at(held, time, cloud);
    ASSERT_LT(net_of(cloud, w).force, 1e-14);
    ASSERT_LT(net_of(cloud, w).torque, 1e-14);
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] += dt / cloud.mass[i] * w.force[i];
      spin[i] += dt * w.torque[i];
      cloud.x[i] += dt * v[i];
    }
  }
  EXPECT_LT((momenta() - start).tail<3>().norm(), 1e-12 * start.tail<3>().norm());
  EXPECT_LT((momenta() - start).head<3>().norm(), 1e-12 * 200 * 1.5e9 * omega.norm() * 400);
}

TEST(AutomaticSteps, GrowsShrinksAndIsBounded) {
  HeldGravity held;
  EXPECT_EQ(automatic_steps(held, 1e-4, 1000), 2u);  // 1 step, and twice that
  held.steps = 100;
  held.miss = 1e-4;
  EXPECT_EQ(automatic_steps(held, 1e-4, 1000), 200u);
  EXPECT_EQ(automatic_steps(held, 1e-4, 120), 120u);
  EXPECT_EQ(most_steps(1e-4, 1000.0, 0.1), 100u);  // sqrt(error) x 1000 s
  EXPECT_EQ(most_steps(1e-4, 0.01, 0.1), 1u);
  held.miss = 2e-4;  // evaluations of that error differ by as much
  EXPECT_EQ(automatic_steps(held, 1e-4, 1000), 100u);
  held.miss = 4e-4;
  EXPECT_EQ(automatic_steps(held, 1e-4, 1000), 70u);
  held.miss = 1.0;
  EXPECT_EQ(automatic_steps(held, 1e-4, 1000), 50u);
}

// A pile that rests in its turning frame, and one grain that starts to move.
TEST(Rest, EndsWhereOneGrainHasMovedTooFarForTheErrorAskedFor) {
  Cloud cloud = ball(500);
  const double density = 3000.0, radius = std::cbrt(cloud.mass[7] / (4.0 / 3.0 * kPi * density));
  const double fall = 1.0 / std::sqrt(4.0 / 3.0 * kPi * kGravitationalConstant * density);
  const Wrenches before = evaluated(cloud);
  std::vector<Vec3> acceleration = before.force;
  for (std::size_t i = 0; i < cloud.size(); ++i) acceleration[i] /= cloud.mass[i];
  const double error = 1e-3, reach = reach_at_rest(error, rms(acceleration), fall);
  HeldGravity held;
  EXPECT_FALSE(rests(held, cloud.x, 1e9));
  hold(held, before, cloud, Vec3::Zero(), 10);
  held.places = cloud.x;
  EXPECT_TRUE(rests(held, cloud.x, 0.0));
  // Two grains in touch, the closest that sources can be: that far they change the pull by a twentieth of the
  // error.
  const double touch = 2.0 * radius, gm = kGravitationalConstant * cloud.mass[7];
  const double change = gm / (touch * touch) - gm / ((touch + reach) * (touch + reach));
  EXPECT_LT(change, 0.05 * error * rms(acceleration));
  cloud.x[7] += Vec3(0.0, 0.99 * reach, 0.0);
  EXPECT_TRUE(rests(held, cloud.x, reach));
  EXPECT_LT(rms_error(evaluated(cloud).force, before.force), 0.1 * error);
  cloud.x[7] += Vec3(0.0, 0.02 * reach, 0.0);
  EXPECT_FALSE(rests(held, cloud.x, reach));
  cloud.x[7].x() = std::nan("");
  EXPECT_FALSE(rests(held, cloud.x, reach));
}

// A forecast of a motion that has stopped is not held for ever.
TEST(Rest, GoesFromTheForecastToTheLastEvaluationAndTurnsOn) {
  const Cloud cloud = ball(300);
  const Wrenches first = evaluated(cloud);
  Wrenches second = first;
  const Vec3 omega(0.0, 0.0, 1e-3);
  HeldGravity held;
  hold(held, first, cloud, omega, 10);
  for (Vec3& f : second.force) f *= 1.001;
  renew(held, second, cloud.mass, 10.0, omega, 1.0, true, [] { return std::uint64_t{10}; });
  // Over the forces of the first evaluation, which all keep their directions in the pile.
  const auto strength = [&](double time) {
    Cloud then = cloud;
    for (std::size_t i = 0; i < cloud.size(); ++i) then.x[i] = turned(time * omega) * cloud.x[i];
    const Wrenches w = at(held, time, then);
    double least = 1e9, most = 0.0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double s = (turned(time * omega) * first.force[i]).dot(w.force[i]) / first.force[i].squaredNorm();
      least = std::min(least, s);
      most = std::max(most, s);
    }
    EXPECT_LT(most - least, 1e-10);
    return most;
  };
  EXPECT_NEAR(strength(20.0), 1.002, 1e-9);
  hold_on(held, 20.0, omega, 1.0, 20);
  EXPECT_NEAR(strength(20.0), 1.002, 1e-9);
  EXPECT_NEAR(strength(30.0), 1.0015, 1e-9);
  EXPECT_NEAR(strength(40.0), 1.001, 1e-9);
  EXPECT_FALSE(held.to.force.empty());
  hold_on(held, 40.0, omega, 1.0, 40);
  EXPECT_TRUE(held.to.force.empty());  // nothing changes any more, and nothing is read twice
  EXPECT_NEAR(strength(60.0), 1.001, 1e-9);
  hold_on(held, 80.0, omega, 1.0, 20);
  EXPECT_NEAR(strength(90.0), 1.001, 1e-9);
  // From there the next evaluation goes on, with a trend of the time since the last one.
  Wrenches third = first;
  for (Vec3& f : third.force) f *= 1.010;
  renew(held, third, cloud.mass, 100.0, omega, 1.0, true, [] { return std::uint64_t{10}; });
  EXPECT_NEAR(strength(100.0), 1.001, 1e-9);
  EXPECT_NEAR(held.miss, 0.009 / 1.010, 1e-9);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_NEAR(held.to.force[i].norm() / first.force[i].norm(), 1.011, 1e-9);
}

}  // namespace
}  // namespace cairn::gravity
