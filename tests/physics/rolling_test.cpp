// Rolling and twisting resistance: threshold couples, free oscillations, and spheres that stay, slide or
// roll.
#include <gtest/gtest.h>

#include <functional>

#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kStiffness = 1e7, kOverlap = 1e-6, kBeta = 0.5;
constexpr double kFriction = 0.8, kRolling = 1.05, kTwisting = 1.3;
const double kHalf = 1.0 + std::sqrt(0.75);                     // half the length of a dumbbell
const Quat kUpright(std::sqrt(0.5), 0.0, std::sqrt(0.5), 0.0);  // dumbbell along z

enum class Pairing { spheres, wall, dumbbells, dumbbell_on_wall };
constexpr Pairing kAllPairings[] = {Pairing::spheres, Pairing::wall, Pairing::dumbbells};

std::string name(Pairing pairing) {
  switch (pairing) {
    case Pairing::spheres:
      return "two spheres";
    case Pairing::wall:
      return "sphere on wall";
    case Pairing::dumbbells:
      return "two dumbbells end to end";
    case Pairing::dumbbell_on_wall:
      return "upright dumbbell on wall";
  }
  return "";
}

bool on_wall(Pairing pairing) {
  return pairing == Pairing::wall || pairing == Pairing::dumbbell_on_wall;
}

/// Effective radius of the contact (m).
double effective_radius(Pairing pairing) {
  return on_wall(pairing) ? 1.0 : 0.5;
}

/// From the contact to the centre of a body (m).
double height(Pairing pairing) {
  return pairing == Pairing::spheres || pairing == Pairing::wall ? 1.0 : kHalf;
}

/// Body 0 above body 1 or a wall, on the z axis.
std::string stack(Pairing pairing) {
  switch (pairing) {
    case Pairing::spheres:
      return body({.position = {0.0, 0.0, 2.0 - kOverlap}}) + body({});
    case Pairing::wall:
      return body({.position = {0.0, 0.0, 1.0 - kOverlap}}) + wall();
    case Pairing::dumbbells:
      return body({.shape = "dumbbell",
                   .position = {0.0, 0.0, 2.0 * kHalf - kOverlap},
                   .orientation = kUpright}) +
             body({.shape = "dumbbell", .orientation = kUpright});
    case Pairing::dumbbell_on_wall:
      return body({.shape = "dumbbell", .position = {0.0, 0.0, kHalf - kOverlap}, .orientation = kUpright}) +
             wall();
  }
  return "";
}

TEST(RollingAndTwisting, CouplesStopAtTheirThresholdsAndOpposeTheMotionOfBothBodies) {
  const double press = kStiffness * kOverlap;
  for (const Pairing pairing : kAllPairings)
    for (const bool twist : {true, false}) {
      Experiment e(scene_text({.restitution = 0.5,
                               .friction = kFriction,
                               .rolling = kRolling,
                               .twisting = kTwisting,
                               .beta = kBeta},
                              fmt::format("stiffness = {}", kStiffness), "", stack(pairing)));
      e.begin();
      const Bodies& bodies = e.state.bodies;
      const Vec3 axis = twist ? Vec3::UnitZ() : Vec3(0.6, 0.8, 0.0);
      const double radius = effective_radius(pairing);
      const double limit =
          twist ? kTwisting * kBeta * radius * kFriction * press : kRolling * kBeta * radius * press;
      const double spring = (twist ? 2.0 * 2.0 / 7.0 : 1.0) * kStiffness * std::pow(kBeta * radius, 2);
      // Three times the angle that loads the spring to its limit.
      const int steps = 1000;
      const double rate = 3.0 * limit / spring / (steps * e.physics.contacts.dt);
      for (int k = 0; k < steps; ++k) {
        // In rolling, the lower body counter-rotates so that nothing slides; on the wall the sphere rolls.
        const bool single = pairing == Pairing::wall;
        lead(e, 0, (single && !twist ? rate * (1.0 - kOverlap) : 0.0) * axis.cross(Vec3::UnitZ()),
             (single ? 1.0 : 0.5) * rate * axis);
        if (!single) lead(e, 1, Vec3::Zero(), -0.5 * rate * axis);
        e.advance(1);
      }
      const std::string what = name(pairing) + (twist ? ": twisting" : ": rolling");
      const std::string form = twist ? "mu_T beta R mu_S N" : "mu_R beta R N";
      report::close(what + " couple on the upper body, N m", form + ", against its spin",
                    -bodies.torque[0].dot(axis), limit, 1e-4);
      if (bodies.size() > 1)
        report::close(what + " couple on the lower body, N m", form + ", against its own spin",
                      bodies.torque[1].dot(axis), limit, 1e-4);
    }
}

TEST(RollingAndTwisting, SpheresTwistingOnEachOtherEndWithOneSpin) {
  Experiment e(scene_text(
      {.restitution = 0.5, .friction = kFriction, .twisting = kTwisting, .cohesion = 22.5},
      fmt::format("stiffness = {}", kStiffness), "",
      body({.size = 2.0, .position = {0.0, 0.0, 3.0 - kOverlap}, .spin = {0.0, 0.0, 0.001}}) + body({})));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  const double momentum = bodies.spin[0].z();
  const double common = momentum / (bodies.inertia[0].x() + bodies.inertia[1].x());
  double drift = 0.0;
  for (int k = 0; k < 40; ++k) {
    e.advance(1000);
    drift = std::max(drift, std::abs((bodies.spin[0] + bodies.spin[1]).z() / momentum - 1.0));
  }
  report::close("spin of the larger sphere, rad/s", "L / (I_1 + I_2)", angular_velocity(bodies, 0).z(),
                common, 1e-3);
  report::close("spin of the smaller sphere, rad/s", "L / (I_1 + I_2)", angular_velocity(bodies, 1).z(),
                common, 1e-3);
  report::error("drift of the angular momentum, relative", "conserved: opposite couples", drift, 1e-13);
  report::note(
      "A twist couple of one sign on both bodies, as one published code has it, would drive both spheres of "
      "the pair that ends with one spin the same way, and lose its angular momentum. Coefficients twice too "
      "large, as another code has them, would show in the threshold couples (factor 2) and in the "
      "frequencies (factor sqrt 2).");
}

/// A free oscillation of a contact that cohesion holds together without any other force. On a wall a body
/// that rolls would slip as well: there the mode is that without friction.
struct Mode {
  Pairing pairing;
  bool twist;
  double inertia;  ///< 1 / (1/I_0 + 1/I_1) about the axis, kg m^2
  double stiffness, damping;
  Vec3 axis;

  double omega0() const { return std::sqrt(stiffness / inertia); }
  double decay() const { return 0.5 * damping / inertia; }
  double omega() const { return std::sqrt(stiffness / inertia - decay() * decay()); }
  std::string name() const { return cairn::name(pairing) + (twist ? ", torsion" : ", rolling"); }
};

/// Bodies held by cohesion at kOverlap, where it balances the spring; friction never slips, or there is none.
Experiment bound(Pairing pairing, bool rough, double restitution, double time_step, double beta = kBeta) {
  const double radius = effective_radius(pairing);
  Experiment e(scene_text(
      {.restitution = restitution,
       .friction = rough ? 1e3 : 0.0,
       .rolling = 1e3,
       .twisting = rough ? 1e3 : 0.0,
       .beta = beta,
       .cohesion = kStiffness * kOverlap / std::pow(2.0 * beta * radius, 2)},
      fmt::format("stiffness = {}\ntime_step = {:.17g}\nunsafe_time_step = true", kStiffness, time_step), "",
      stack(pairing), 1e6 * time_step));
  e.begin();
  return e;
}

/// The mode as the masses and the law of physics.md give it.
Mode make_mode(Pairing pairing, bool twist, double restitution) {
  const Experiment e = bound(pairing, true, restitution, 1e-4);
  const Bodies& bodies = e.state.bodies;
  const double radius = effective_radius(pairing), patch2 = std::pow(kBeta * radius, 2);
  Mode mode{pairing, twist, 0.0, 0.0, 0.0, twist ? Vec3::UnitZ() : Vec3(0.6, 0.8, 0.0)};
  double mobility = 0.0, normal = 0.0, tangential = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vec3& i = bodies.inertia[b];  // of a dumbbell: the axis has the least
    mobility += 1.0 / (twist ? i[0] : i[2]);
    normal += 1.0 / bodies.mass[b];
    tangential += 1.0 / bodies.mass[b] + std::pow(height(pairing), 2) / i[2];
  }
  mode.inertia = 1.0 / mobility;
  const double k_s = 2.0 / 7.0 * kStiffness, log_e = std::log(restitution);
  const double ratio = -2.0 * log_e / std::sqrt(kPi * kPi + log_e * log_e);
  mode.stiffness = (twist ? 2.0 * k_s : kStiffness) * patch2;
  mode.damping =
      ratio * patch2 * (twist ? 2.0 * std::sqrt(k_s / tangential) : std::sqrt(kStiffness / normal));
  return mode;
}

/// Starts the mode from a relaxed spring with relative spin `rate`.
Experiment start(const Mode& mode, double restitution, double steps_per_period, double rate) {
  const bool rough = mode.twist || !on_wall(mode.pairing);
  Experiment e = bound(mode.pairing, rough, restitution, 2.0 * kPi / mode.omega() / steps_per_period);
  Bodies& bodies = e.state.bodies;
  if (bodies.size() == 1) {
    lead(e, 0, Vec3::Zero(), rate * mode.axis);
  } else {
    const double first = mode.inertia / (mode.twist ? bodies.inertia[0][0] : bodies.inertia[0][2]);
    lead(e, 0, Vec3::Zero(), first * rate * mode.axis);
    lead(e, 1, Vec3::Zero(), -(1.0 - first) * rate * mode.axis);
  }
  e.begin();
  return e;
}

double relative_spin(const Experiment& e, const Vec3& axis) {
  const Bodies& bodies = e.state.bodies;
  const double first = angular_velocity(bodies, 0).dot(axis);
  return bodies.size() > 1 ? first - angular_velocity(bodies, 1).dot(axis) : first;
}

constexpr int kPerPeriod = 300;

/// Angular frequency and decay rate over some periods: from the zeros of the relative spin, and its slopes
/// there.
struct Measured {
  double omega, decay;
};
Measured measure(Experiment e, const Vec3& axis, int periods) {
  const double dt = e.physics.contacts.dt;
  double before = relative_spin(e, axis), first = 0.0, last = 0.0, first_slope = 0.0, last_slope = 0.0;
  int zeros = 0;
  for (int k = 0; k < periods * kPerPeriod; ++k) {
    e.advance(1);
    const double now = relative_spin(e, axis);
    if (before * now < 0.0) {
      last = (k + before / (before - now)) * dt;
      last_slope = std::abs(now - before);
      if (zeros++ == 0) {
        first = last;
        first_slope = last_slope;
      }
    }
    before = now;
  }
  return {kPi * (zeros - 1) / (last - first), std::log(first_slope / last_slope) / (last - first)};
}

int periods(double restitution) {
  return restitution < 1.0 ? 4 : 10;
}

/// What an undamped oscillation loses of its energy.
void report_loss(const std::string& what, Experiment e) {
  const double before = e.kinetic_energy(), stored = e.spring_energy();
  e.advance(2 * kPerPeriod);
  report::error(what + ", undamped: energy lost in two periods at 300 steps a period, relative", "conserved",
                std::abs(mechanical_energy(e) - stored - before) / before, 1e-5);
}

TEST(RollingAndTwisting, SmallOscillationsHaveTheFrequencyAndDecayOfTheLaw) {
  std::vector<report::Curve> curves;
  for (const auto& [pairing, twist] : {std::pair(Pairing::spheres, true),
                                       {Pairing::spheres, false},
                                       {Pairing::wall, true},
                                       {Pairing::wall, false},
                                       {Pairing::dumbbells, true},
                                       {Pairing::dumbbells, false},
                                       {Pairing::dumbbell_on_wall, true},
                                       {Pairing::dumbbell_on_wall, false}}) {
    for (const double restitution : {1.0, 0.8, 0.55}) {
      const Mode mode = make_mode(pairing, twist, restitution);
      const Measured m = measure(start(mode, restitution, kPerPeriod, 1e-6), mode.axis, periods(restitution));
      const std::string what = fmt::format("{}, e = {}", mode.name(), restitution);
      report::close(what + ": frequency, rad/s", "sqrt(k/J - (C/2J)^2)", m.omega, mode.omega(), 1e-3);
      if (restitution < 1.0) report::close(what + ": decay, 1/s", "C / 2J", m.decay, mode.decay(), 1e-3);
    }
    const Mode mode = make_mode(pairing, twist, 1.0);
    report_loss(mode.name(), start(mode, 1.0, kPerPeriod, 1e-6));
    if (on_wall(pairing)) continue;
    const Mode damped = make_mode(pairing, twist, 0.8);
    Experiment run = start(damped, 0.8, kPerPeriod, 1e-6);
    report::Curve curve{mode.name(), {}, {}};
    for (int k = 0; k <= 3 * kPerPeriod; k += 10, run.advance(10)) {
      curve.x.push_back(k / static_cast<double>(kPerPeriod));
      curve.y.push_back(relative_spin(run, damped.axis) / 1e-6);
    }
    curves.push_back(curve);
  }
  report::plot("torsion-rolling", "Free torsion and rolling of bodies bound by cohesion, e = 0.8.",
               {"periods", "relative spin / start"}, curves);
}

TEST(RollingAndTwisting, ASphereRocksOnARoughWallAsItsTwoSpringsSay) {
  // Displacements x of the centre and y = r theta of the surface: M x'' = -k_S (x - y),
  // I / r^2 y'' = k_S (x - y) - k_R / r^2 y. All dashpots are one multiple of their springs, so each mode
  // decays alone. In the slow one the sphere rolls, x = y but for the little that the spring k_S gives way.
  const Vec3 axis(0.6, 0.8, 0.0);
  const double mass = 2000.0 * 4.0 / 3.0 * kPi, inertia = 0.4 * mass, k_s = 2.0 / 7.0 * kStiffness;
  for (const double beta : {kBeta, 0.03})
    for (const bool rolls : {true, false})
      for (const double restitution : {1.0, 0.8, 0.55}) {
        const double k_r = kStiffness * beta * beta;
        // M I square^2 - middle square + k_S k_R = 0 for square = omega^2, r = 1
        const double middle = mass * (k_s + k_r) + inertia * k_s;
        const double root = std::sqrt(middle * middle - 4.0 * mass * inertia * k_s * k_r);
        const double square =
            rolls ? 2.0 * k_s * k_r / (middle + root) : (middle + root) / (2.0 * mass * inertia);
        const double log_e = std::log(restitution);
        const double decay =
            -log_e / std::sqrt(kPi * kPi + log_e * log_e) * std::sqrt(mass / kStiffness) * square;
        const double omega = std::sqrt(square - decay * decay);
        const auto start_rocking = [&] {
          Experiment e = bound(Pairing::wall, true, restitution, 2.0 * kPi / omega / kPerPeriod, beta);
          const double rate = 1e-7, speed = rate * k_s / (k_s - mass * square);
          lead(e, 0, speed * axis.cross(Vec3::UnitZ()), rate * axis);
          e.begin();
          return e;
        };
        const std::string what =
            fmt::format("sphere {} a rough wall, beta = {}", rolls ? "rolling on" : "shaking against", beta);
        const Measured m = measure(start_rocking(), axis, periods(restitution));
        const std::string damped = fmt::format("{}, e = {}", what, restitution);
        const char* const form = "mode of the springs k_S and k_R, damped";
        report::close(damped + ": frequency, rad/s", form, m.omega, omega, 1e-3);
        if (restitution < 1.0)
          report::close(damped + ": decay, 1/s", form, m.decay, decay, 1e-3);
        else
          report_loss(what, start_rocking());
        if (rolls && beta < kBeta && restitution == 1.0)
          report::close(what + ": frequency, rad/s", "rolling without slip, sqrt(k_R / (I + M r^2))", m.omega,
                        std::sqrt(k_r / (inertia + mass)), 1e-3);
      }
}

/// Deviation of the relative spin from the damped oscillator after 2.3 periods, over the first amplitude.
double spin_error(const Mode& mode, double restitution, int per_period) {
  constexpr double rate = 1e-6;
  Experiment e = start(mode, restitution, per_period, rate);
  e.advance(static_cast<std::uint64_t>(2.3 * per_period));
  const double t = e.state.clock.time(), phase = mode.omega() * t;
  const double exact =
      std::exp(-mode.decay() * t) * (std::cos(phase) - mode.decay() / mode.omega() * std::sin(phase));
  return std::abs(relative_spin(e, mode.axis) / rate - exact);
}

/// The same for the normal and the tangential spring of a sphere on a wall, from its contact velocity.
double slip_error(bool normal, double restitution, int per_period) {
  const double mass = 2000.0 * 4.0 / 3.0 * kPi, log_e = std::log(restitution), lever = 1.0 - kOverlap;
  const double zeta = -log_e / std::sqrt(kPi * kPi + log_e * log_e);
  const double mobility = 1.0 + lever * lever / 0.4;  // of the contact point along the wall, times the mass
  const double omega0 = std::sqrt((normal ? kStiffness : 2.0 / 7.0 * kStiffness * mobility) / mass);
  const double omega = omega0 * std::sqrt(1.0 - zeta * zeta), decay = zeta * omega0;
  Experiment e(scene_text({.restitution = restitution,
                           .friction = 1e3,
                           .beta = kBeta,
                           .cohesion = kStiffness * kOverlap / std::pow(2.0 * kBeta, 2)},
                          fmt::format("stiffness = {}\ntime_step = {:.17g}\nunsafe_time_step = true",
                                      kStiffness, 2.0 * kPi / omega / per_period),
                          "", stack(Pairing::wall), 1e6 * 2.0 * kPi / omega / per_period));
  e.begin();
  constexpr double speed = 1e-7;
  // As an impulse at the contact would set it off.
  if (normal)
    lead(e, 0, {0.0, 0.0, speed}, Vec3::Zero());
  else
    lead(e, 0, {speed / mobility, 0.0, 0.0}, {0.0, -lever / 0.4 * speed / mobility, 0.0});
  e.begin();
  e.advance(static_cast<std::uint64_t>(2.3 * per_period));
  const Bodies& bodies = e.state.bodies;
  const double t = e.state.clock.time(), phase = omega * t;
  const double slip =
      normal ? bodies.velocity[0].z() : bodies.velocity[0].x() - lever * angular_velocity(bodies, 0).y();
  return std::abs(slip / speed - std::exp(-decay * t) * (std::cos(phase) - decay / omega * std::sin(phase)));
}

TEST(Springs, EveryKindConvergesAtSecondOrder) {
  const std::vector<double> steps{40, 80, 160, 320};
  std::vector<report::Curve> curves;
  const auto study = [&](const std::string& what, const std::function<double(int)>& error) {
    report::Curve curve{what, steps, {}};
    for (const double n : steps) curve.y.push_back(error(static_cast<int>(n)));
    report::near(what + ": order of the error after 2.3 periods, 40 to 320 steps a period", "second order",
                 -order_of(curve.x, curve.y), 2.0, 0.1);
    curves.push_back(curve);
  };
  for (const double restitution : {1.0, 0.55}) {
    const std::string e = fmt::format(", e = {}", restitution);
    study("normal" + e, [&](int n) { return slip_error(true, restitution, n); });
    study("tangential" + e, [&](int n) { return slip_error(false, restitution, n); });
    for (const bool twist : {false, true}) {
      const Mode mode = make_mode(Pairing::spheres, twist, restitution);
      study((twist ? "twisting" : "rolling") + e, [&](int n) { return spin_error(mode, restitution, n); });
    }
  }
  report::plot("spring-order", "Error of the velocity after 2.3 periods of each spring, over its amplitude.",
               {"steps per period", "error", true, true}, curves);
}

/// Largest spin (rad/s) of a sphere sent sliding without friction over a wall or a larger sphere.
double spin_of_sliding_sphere(bool on_wall, const std::string& rolling_slip) {
  const std::string below = on_wall ? wall() : body({.size = 3.0, .position = {0.0, 0.0, -3.0}});
  Experiment e(scene_text({.restitution = 0.5, .rolling = kRolling, .beta = kBeta},
                          fmt::format("stiffness = {}\nrolling_slip = '{}'", kStiffness, rolling_slip),
                          field({0.0, 0.0, -1.0}),
                          body({.position = {0.0, 0.0, 1.0 - 1e-4}, .velocity = {0.05, 0.02, 0.0}}) + below));
  e.begin();
  double spin = 0.0;
  for (int k = 0; k < 2000; ++k) {
    e.advance(1);
    spin = std::max(spin, angular_velocity(e.state.bodies, 0).norm());
  }
  return spin;
}

TEST(RollingAndTwisting, SphereSlidingWithoutFrictionNeverStartsToSpin) {
  report::error("spin of a smooth sphere sliding on a wall with rolling resistance, rad/s",
                "exactly 0: no work without a spring", spin_of_sliding_sphere(true, "none"), 0.0);
  report::error("the same on a larger sphere", "0 to round-off", spin_of_sliding_sphere(false, "none"),
                1e-20);
  report::within("with rolling_slip = zhang2017, on the wall", "spun up, as eq. 8 is printed",
                 spin_of_sliding_sphere(true, "zhang2017"), 1e-3, 1.0);
}

TEST(RollingAndTwisting, SphereOnAnInclineStaysOrRollsAsTheLawSays) {
  constexpr double g = 10.0, rolling = 0.4;
  const double threshold = rolling * kBeta;  // R = r on a wall
  report::Curve law{"(5/7) g (sin - mu_R beta cos)", {}, {}}, sphere{"sphere", {}, {}, false};
  for (const double ratio : {0.5, 0.9, 0.99, 1.01, 1.1, 1.5, 2.0}) {
    const double angle = std::atan(ratio * threshold);
    Experiment e(scene_text({.restitution = 0.1, .friction = 1.0, .rolling = rolling, .beta = kBeta},
                            "stiffness = 1e9", field({0.0, 0.0, -g}),
                            body({.position = {0.0, 0.0, 1.0}}) + wall()));
    const double sunk = e.state.bodies.mass[0] * g / 1e9, lever = 1.0 - sunk * std::cos(angle);
    e.state.bodies.position[0].z() -= sunk;
    const double measured = acceleration_after_tilting(e, g, angle);
    const double expected = std::max(
        0.0, lever * g * (lever * std::sin(angle) - threshold * std::cos(angle)) / (0.4 + lever * lever));
    report::near(fmt::format("sphere at tan(theta) = {} mu_R beta: acceleration over g", ratio),
                 "max(0, (5/7)(sin - mu_R beta cos)) at the true lever r - x", measured / g, expected / g,
                 1e-5);
    law.x.push_back(ratio);
    law.y.push_back(expected);
    sphere.x.push_back(ratio);
    sphere.y.push_back(measured);
  }
  report::plot("rolling-incline", "A sphere on an incline with rolling resistance.",
               {"tan(theta) / (mu_R beta)", "acceleration (m/s^2)"}, {law, sphere});
}

}  // namespace
}  // namespace cairn
