// Bodies in free flight against the closed solution of the free top.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "body/bodies.h"
#include "free_top.h"
#include "motion/drift.h"
#include "physics/report.h"
#include "shape/library.h"

namespace cairn {
namespace {

struct Case {
  std::string name;
  Vec3 inertia;  ///< kg m^2
  double share;  ///< p_1^2 / L^2 when p_2 = 0
};

/// Moments of unit mass of every shape of the library and of three artificial bodies.
std::vector<Case> tops() {
  std::vector<Case> out;
  for (const std::string& name : library_names())
    out.push_back({name, make_rigid(load_shape(name, "."), MassModel::union_volume).inertia, 0.3});
  out.push_back({"thin needle", {0.01, 1.0, 1.001}, 0.4});
  out.push_back({"flat plate", {1.0, 1.3, 2.3}, 0.35});
  // The separatrix is where L^2 = 2 E I2: both tumble about the unstable middle axis.
  const Vec3 inertia(1.0, 2.0, 2.7);
  const double at = (1.0 / inertia[1] - 1.0 / inertia[2]) / (1.0 / inertia[0] - 1.0 / inertia[2]);
  out.push_back({"middle axis, long side", inertia, at + 1e-3});
  out.push_back({"middle axis, flat side", inertia, at - 1e-3});
  return out;
}

bool round_top(const Vec3& inertia) {
  return inertia[2] - inertia[0] < 1e-9 * inertia[2];
}

/// A top of unit angular momentum along the space axis z.
class Flight {
 public:
  explicit Flight(const Case& top)
      : inertia_(top.inertia), energy_(0.5 * (top.share / inertia_[0] + (1.0 - top.share) / inertia_[2])) {
    if (!round_top(inertia_)) exact_.emplace(inertia_, 1.0, energy_);
    attitude_ = attitude(0.0);
  }

  void advance(double dt, std::uint64_t steps) {
    for (std::uint64_t k = 0; k < steps; ++k) step(dt);
  }
  void step(double dt) { attitude_ = rotate_free_top(attitude_, Vec3::UnitZ(), inertia_, dt); }

  Quat attitude(double t) const {
    return exact_ ? exact_->attitude(t, 400)
                  : Quat(Eigen::AngleAxisd(t / inertia_[0], Vec3::UnitZ())) *
                        Quat(0.7, 0.1, -0.5, 0.5).normalized();
  }
  Vec3 body_momentum() const { return attitude_.conjugate() * Vec3::UnitZ(); }
  double energy_error() const {
    const Vec3 p = body_momentum();
    return 0.5 * p.dot(p.cwiseQuotient(inertia_)) / energy_ - 1.0;
  }
  /// Angle (rad) between the attitude and the exact one.
  double attitude_error(double t) const { return attitude_.angularDistance(attitude(t)); }
  /// Angle (rad) between the directions of the momentum in the body frame.
  double momentum_error(double t) const {
    return (body_momentum() - attitude(t).conjugate() * Vec3::UnitZ()).norm();
  }

 private:
  Vec3 inertia_;
  double energy_;
  std::optional<FreeTop> exact_;
  Quat attitude_;
};

struct Errors {
  double attitude, momentum, energy;
};

Errors errors_after(const Case& top, double time, std::uint64_t steps) {
  Flight flight(top);
  const double dt = time / static_cast<double>(steps);
  Errors e{0.0, 0.0, 0.0};
  for (std::uint64_t k = 0; k < steps; ++k) {
    flight.step(dt);
    e.energy = std::max(e.energy, std::abs(flight.energy_error()));
  }
  e.attitude = flight.attitude_error(time);
  e.momentum = flight.momentum_error(time);
  return e;
}

TEST(Jacobi, AgreesWithTabulatedValues) {    // Abramowitz & Stegun, table 17.1 and 16.5
  const double quarter = 1.854074677301372;  // K(1/2)
  const Elliptic half = jacobi(0.5 * quarter, 0.5), end = jacobi(quarter, 0.5);
  EXPECT_NEAR(half.sn, 1.0 / std::sqrt(1.0 + std::sqrt(0.5)), 1e-14);
  EXPECT_NEAR(half.dn, std::pow(0.5, 0.25), 1e-14);
  EXPECT_NEAR(end.sn, 1.0, 1e-14);
  EXPECT_NEAR(end.cn, 0.0, 1e-14);
  EXPECT_NEAR(jacobi(0.7, 1.0).sn, std::sin(0.7), 1e-15);
  EXPECT_NEAR(jacobi(0.7, 1e-14).sn, std::tanh(0.7), 1e-13);
}

TEST(FreeTop, ClosedSolutionObeysEulersEquations) {
  for (const Case& top : tops()) {
    if (round_top(top.inertia)) continue;
    const FreeTop exact(top.inertia, 1.0,
                        0.5 * (top.share / top.inertia[0] + (1.0 - top.share) / top.inertia[2]));
    const double unit = top.inertia[0], h = 1e-3 * unit, t = 2.3 * unit;
    const Vec3 p = exact.body_momentum(t), w = p.cwiseQuotient(top.inertia);
    const Vec3 rate = (exact.body_momentum(t + h) - exact.body_momentum(t - h)) / (2.0 * h);
    EXPECT_LT((rate - p.cross(w)).norm() * unit, 1e-6) << top.name;
    const Quat turn = exact.attitude(t - h, 100).conjugate() * exact.attitude(t + h, 100);
    EXPECT_LT((turn.vec() / h - w).norm() * unit, 2e-6) << top.name;
    EXPECT_LT((exact.attitude(t, 100) * p - Vec3::UnitZ()).norm(), 1e-13) << top.name;
  }
}

TEST(FreeFlight, AttitudeAndEnergyAreSecondOrderForEveryShape) {
  for (const Case& top : tops()) {
    const double time = 20.0 * top.inertia[1];  // a few turns
    const double dt = top.inertia[0] / 16.0;
    const auto steps = static_cast<std::uint64_t>(time / dt);
    const Errors coarse = errors_after(top, time, steps), fine = errors_after(top, time, 2 * steps);
    const auto order = [&](const char* of, double ratio, double tolerance) {
      report::near(fmt::format("{}: order of the {}", top.name, of), "second order", std::log2(ratio), 2.0,
                   tolerance);
    };
    report::error(top.name + ": attitude after a few turns, 32 steps per I_1 / L, rad",
                  "closed solution of the free top", fine.attitude, 2e-3);
    order("attitude error", coarse.attitude / fine.attitude, 0.07);
    if (round_top(top.inertia)) continue;  // every direction of momentum has the same energy
    order("body-frame momentum error", coarse.momentum / fine.momentum, 0.1);
    order("energy error", coarse.energy / fine.energy, 0.04);
  }
}

TEST(FreeFlight, EnergyDoesNotDriftInAMillionSteps) {
  for (const Case& top : tops()) {
    if (top.name != "rod4" && top.name != "l_shape" && !top.name.starts_with("middle") &&
        top.name != "thin needle")
      continue;
    Flight flight(top);
    const double dt = top.inertia[0] / 8.0;
    double first = 0.0, last = 0.0, length = 0.0;
    constexpr int steps = 1'000'000;
    for (int k = 0; k < steps; ++k) {
      flight.step(dt);
      if (k < steps / 5) first = std::max(first, std::abs(flight.energy_error()));
      if (k >= steps - steps / 5) last = std::max(last, std::abs(flight.energy_error()));
      if (k % 1000 == 0) length = std::max(length, std::abs(flight.body_momentum().norm() - 1.0));
    }
    report::error(top.name + ": energy error in the first 2e5 steps, relative", "conserved", first, 2e-4);
    report::close(top.name + ": energy error in the last 2e5 of 1e6 steps", "the first: no drift", last,
                  first, 0.02);
    report::error(top.name + ": length of the angular momentum, 1e6 steps, relative", "conserved", length,
                  1e-14);
  }
}

TEST(FreeFlight, AngularMomentumInSpaceIsExact) {
  const RigidShape shape = make_rigid(load_shape("l_shape", "."), MassModel::union_volume);
  Bodies bodies;
  add_body(
      bodies, shape, 0, 2.0, 3000.0, 0,
      {.position = {1.0, 2.0, 3.0}, .velocity = {0.5, 0.25, -1.0}, .angular_velocity = {0.3, -0.2, 0.5}});
  const Vec3 spin = bodies.spin[0];
  std::vector<Vec3> spin_mid;
  for (int k = 0; k < 10'000; ++k) {
    kick(bodies, 0.005);
    drift(bodies, 0.01, spin_mid);
    kick(bodies, 0.005);
  }
  EXPECT_EQ(bodies.spin[0], spin);
  EXPECT_LT((bodies.position[0] - Vec3(51.0, 27.0, -97.0)).norm(), 1e-10);
  const Vec3 again = inverse_inertia(bodies, 0).inverse() * angular_velocity(bodies, 0);  // I w
  EXPECT_LT((again - spin).norm(), 1e-14 * spin.norm());
}

TEST(FreeFlight, DriftReportsTheAngularVelocityOfMidStep) {
  const RigidShape shape = make_rigid(load_shape("l_shape", "."), MassModel::union_volume);
  const auto error = [&](double dt) {
    Bodies half, whole;
    for (Bodies* b : {&half, &whole})
      add_body(*b, shape, 0, 1.0, 1.0, 0, {.angular_velocity = {0.3, -0.2, 0.5}});
    std::vector<Vec3> mid;
    for (int k = 0; k < 100; ++k) drift(half, 0.005 * dt, mid);
    drift(whole, dt, mid);
    return (mid[0] - angular_velocity(half, 0)).norm();
  };
  EXPECT_NEAR(error(0.2) / error(0.1), 4.0, 0.2);
}

}  // namespace
}  // namespace cairn
