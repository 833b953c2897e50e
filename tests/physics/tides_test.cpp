// Bodies in the pull of a planet or of the Sun: closed forms, an inertial frame, and what is conserved.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "physics/report.h"
#include "physics/scenes.h"
#include "sim/observe.h"
#include "sim/warnings.h"

namespace cairn {
namespace {

constexpr double kPlanet = 4e14;  // m^3/s^2
constexpr double kSun = 1.32712440018e20;

std::string perturber(double gm, const std::string& rest) {
  return fmt::format("[[perturber]]\nname = 'P'\ngm = {:.17g}\n{}\n", gm, rest);
}

/// A perturber on a circle of that radius in the plane x y, at -x at time 0; the zero moves along y about it.
std::string circle(double gm, double radius) {
  return perturber(
      gm, fmt::format("[perturber.orbit]\neccentricity = 0\nperiapsis = {:.17g}\nargument = {:.17g}\n"
                      "gm = {:.17g}\n",
                      radius, kPi, gm));
}

std::string step_of(double dt) {
  return fmt::format("stiffness = 1e-3\ntime_step = {:.17g}\nunsafe_time_step = true", dt);
}

/// Greatest distance, over the orbit, of a loose ball from the closed form, relative to its starting
/// distance.
double hill_error(double steps_per_radian) {
  const double radius = 1e10, n = std::sqrt(kPlanet / std::pow(radius, 3));
  const Vec3 x(3.0, -2.0, 1.5), v = n * Vec3(0.5, -1.8, 2.0);  // in the turning frame: out, along, across
  Put ball{.size = 0.1, .position = x, .velocity = v + n * Vec3::UnitZ().cross(x)};
  Experiment e(
      scene_text({}, step_of(1.0 / (n * steps_per_radian)), "", body(ball) + circle(kPlanet, radius), 1e9));
  e.begin();
  double worst = 0.0;
  while (n * e.state.clock.time() < 6.3) {
    e.advance(10);
    const double a = n * e.state.clock.time(), s = std::sin(a), c = std::cos(a);
    const Vec3 hill(
        (4.0 - 3.0 * c) * x.x() + s / n * v.x() + 2.0 / n * (1.0 - c) * v.y(),
        6.0 * (s - a) * x.x() + x.y() - 2.0 / n * (1.0 - c) * v.x() + (4.0 * s - 3.0 * a) / n * v.y(),
        c * x.z() + s / n * v.z());
    const Vec3 place = Eigen::AngleAxisd(a, Vec3::UnitZ()) * hill;
    worst = std::max(worst, (e.state.bodies.position[0] - place).norm() / x.norm());
  }
  return worst;
}

TEST(Tides, ALooseBallFollowsHillsEquations) {
  const double coarse = hill_error(1500.0), fine = hill_error(3000.0);
  report::error("loose ball near the zero on a circular orbit, one turn in 18 900 steps: place, relative",
                "Clohessy-Wiltshire solution", fine, 3e-6);
  report::near("the same: order in the time step", "2", std::log2(coarse / fine), 2.0, 0.1);
}

TEST(Tides, ADumbbellLibratesInTheGravityGradient) {
  const double radius = 1e7, n = std::sqrt(kPlanet / std::pow(radius, 3)), angle = 1e-3, dt = 1.0;
  const Put rod{.shape = "rod4",
                .spin = n * Vec3::UnitZ(),
                .orientation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()))};
  Experiment e(scene_text({}, step_of(dt), "", body(rod) + circle(kPlanet, radius)));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  double spread = 0.0;  // I_B - I_A of the point masses
  for (std::size_t s = 0; s < bodies.spheres.size(); ++s)
    spread += bodies.spheres.mass[s] * bodies.spheres.offset[s].squaredNorm();
  const double rate = n * std::sqrt(3.0 * spread / bodies.inertia[0].z());
  const Vec3 axis = bodies.spheres.offset[3].normalized();
  double before = angle, first = 0.0, last = 0.0, amplitude = 0.0;
  int crossings = 0;
  while (crossings < 21 && e.state.clock.time() < 1e5) {
    e.advance(1);
    const double t = e.state.clock.time();
    const Vec3 now = bodies.orientation[0] * axis;
    const Vec3 out(std::cos(n * t), std::sin(n * t), 0.0);
    double tilt = std::asin(out.cross(now).z());
    if (out.dot(now) < 0.0) tilt = -tilt;
    amplitude = std::max(amplitude, std::abs(tilt));
    if (before * tilt < 0.0) {
      last = t - dt * tilt / (tilt - before);
      if (crossings++ == 0) first = last;
    }
    before = tilt;
  }
  report::close("4-rod on a circular orbit, ten librations in its plane: frequency (rad/s)",
                "sqrt(3 (I_B - I_A)/I_C) n", 20.0 * kPi / (last - first), rate, 1e-6);
  report::close("the same: amplitude (rad)", "as begun", amplitude, angle, 1e-5);
}

TEST(Tides, TorqueIsMacCullaghs) {
  double worst = 0.0;
  for (const std::string shape : {"rod4", "diamond", "l_shape", "ellipsoid", "tetrahedron"}) {
    const Vec3 place(5e5, -8e5, 3e5);
    const Put put{.shape = shape, .orientation = Quat(0.8, 0.1, -0.5, 0.3).normalized()};
    Experiment e(
        scene_text({}, step_of(1.0), "", body(put) + perturber(kPlanet, "position = " + toml(place) + "\n")));
    e.begin();
    const Bodies& bodies = e.state.bodies;
    Mat3 second = Mat3::Zero();
    double trace = 0.0;
    for (std::size_t s = 0; s < bodies.spheres.size(); ++s) {
      const Vec3 d = bodies.orientation[0] * bodies.spheres.offset[s];
      second += bodies.spheres.mass[s] * d * d.transpose();
      trace += bodies.spheres.mass[s] * d.squaredNorm();
    }
    const Vec3 direction = place.normalized();
    const double strength = 3.0 * kPlanet / std::pow(place.norm(), 3);
    // 3 gm/D^3 n x (I n) with I = trace - second.
    const Vec3 torque = -strength * direction.cross(second * direction);
    worst = std::max(worst, (bodies.torque[0] - torque).norm() / (strength * trace));
    EXPECT_GT(torque.norm(), shape == "tetrahedron" ? -1.0 : 1e-3 * strength * trace);
  }
  report::error("torque of a planet 1e6 m away on five shapes some metres long, over 3 gm/D^3 sum m d^2",
                "MacCullagh", worst, 1e-5);
}

/// A rigid body of point masses and a fixed planet at the origin of an inertial frame, in long double by the
/// classical Runge-Kutta method.
class Inertial {
 public:
  using Real = long double;
  using Vec = Eigen::Matrix<Real, 3, 1>;
  using Mat = Eigen::Matrix<Real, 3, 3>;
  struct Pose {
    Vec x, v, l;
    Mat r;  ///< principal frame -> space
    Pose plus(Real h, const Pose& rate) const {
      return {x + h * rate.x, v + h * rate.v, l + h * rate.l, r + h * rate.r};
    }
  };

  Inertial(const Bodies& bodies, double gm, const Vec3& from_planet, const Vec3& velocity) : gm_(gm) {
    for (std::size_t s = 0; s < bodies.spheres.size(); ++s) {
      mass_.push_back(bodies.spheres.mass[s]);
      offset_.push_back(bodies.spheres.offset[s].cast<Real>());
    }
    inertia_ = bodies.inertia[0].cast<Real>();
    pose = {from_planet.cast<Real>(), velocity.cast<Real>(), bodies.spin[0].cast<Real>(),
            bodies.orientation[0].toRotationMatrix().cast<Real>()};
  }

  void step(Real h) {
    const Pose a = rate(pose), b = rate(pose.plus(h / 2, a)), c = rate(pose.plus(h / 2, b)),
               d = rate(pose.plus(h, c));
    pose = pose.plus(h / 6, a).plus(h / 3, b).plus(h / 3, c).plus(h / 6, d);
  }

  Pose pose;

 private:
  Pose rate(const Pose& p) const {
    Vec force = Vec::Zero(), torque = Vec::Zero();
    Real mass = 0;
    for (std::size_t s = 0; s < mass_.size(); ++s) {
      const Vec arm = p.r * offset_[s], x = p.x + arm;
      const Vec f = -gm_ * mass_[s] / (x.squaredNorm() * x.norm()) * x;
      force += f;
      torque += arm.cross(f);
      mass += mass_[s];
    }
    const Vec w = p.r * Vec((p.r.transpose() * p.l).cwiseQuotient(inertia_));
    Mat turning;
    for (int k = 0; k < 3; ++k) turning.col(k) = w.cross(p.r.col(k));
    return {p.v, force / mass, torque, turning};
  }

  Real gm_;
  std::vector<Real> mass_;
  std::vector<Vec> offset_;
  Vec inertia_;
};

struct Flyby {
  Vec3 spin_change, spin_error;
  double attitude_error, place_error;
};

Flyby fly_past(double dt) {
  constexpr double hours = 6.0;
  const Put rod{.shape = "rod4",
                .size = 80.0,
                .spin = {1e-5, -2e-5, 2e-4},
                .orientation = Quat(0.9, 0.2, 0.3, -0.1).normalized()};
  const gravity::KeplerOrbit orbit{.gm = kPlanet,
                                   .periapsis = 1.5e7,
                                   .eccentricity = 2.2,
                                   .inclination = 0.4,
                                   .node = 0.7,
                                   .argument = -0.9,
                                   .periapsis_time = 0.5 * hours * 3600.0};
  Experiment e(scene_text(
      {}, step_of(dt), "",
      body(rod) + perturber(kPlanet, fmt::format("radius = 6e6\n[perturber.orbit]\nperiapsis = 1.5e7\n"
                                                 "eccentricity = 2.2\ninclination = 0.4\nnode = 0.7\n"
                                                 "argument = -0.9\nperiapsis_time = {}\ngm = {:.17g}\n",
                                                 0.5 * hours * 3600.0, kPlanet))));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  const Vec3 spin = bodies.spin[0];
  const gravity::Motion start = motion(orbit, 0.0);
  Inertial direct(bodies, kPlanet, -start.position, -start.velocity);
  const auto steps = static_cast<std::uint64_t>(std::llround(hours * 3600.0 / dt));
  e.advance(steps);
  for (int k = 0; k < 21600; ++k) direct.step(1.0L);
  // The zero falls freely: it has gone from -D(0) to -D(t).
  const Vec3 place =
      (direct.pose.x + motion(orbit, e.state.clock.time()).position.cast<long double>()).cast<double>();
  const Vec3 final_spin = direct.pose.l.cast<double>();
  return {final_spin - spin, bodies.spin[0] - final_spin,
          (bodies.orientation[0].toRotationMatrix() - direct.pose.r.cast<double>()).norm(),
          (bodies.position[0] - place).norm()};
}

TEST(Tides, AHyperbolicFlybyTurnsARodAsAnInertialFrameSays) {
  const Flyby coarse = fly_past(8.0), fine = fly_past(4.0);
  EXPECT_GT(fine.spin_change.norm(), 0.0);
  report::error("hyperbolic flyby of a 4-rod at 1.5e7 m: change of its angular momentum, relative",
                "rigid body and planet in an inertial frame, Runge-Kutta in long double",
                fine.spin_error.norm() / fine.spin_change.norm(), 1e-4);
  report::error("the same: attitude (rad)", "the same", fine.attitude_error, 1e-4);
  report::error("the same: centre of mass from the falling zero (m)", "the same", fine.place_error, 1e-4);
  report::near("the same: order in the time step", "2",
               std::log2(coarse.spin_error.norm() / fine.spin_error.norm()), 2.0, 0.2);
}

/// Balls and rods that touch, at the zero or wherever the frame is, with their own gravity.
std::string heap(const Vec3& from, const Vec3& velocity) {
  std::string text;
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1.9999, 0, 0), Vec3(1.0, 1.732, 0), Vec3(1.0, 0.577, 1.633)})
    text += body({.position = x + from, .velocity = velocity});
  text += body({.shape = "rod4", .position = Vec3(1.0, -2.0, 0.4) + from, .velocity = velocity});
  return text;
}

/// Greatest difference of the overlaps of two runs of the heap, in radii; `deepest` of the first.
double overlap_difference(const Experiment& a, const Experiment& b, double& deepest) {
  const auto overlap = [](const Bodies& c, std::size_t i, std::size_t j) {
    const Spheres& s = c.spheres;
    const Vec3 d = separation(c, s.body[i], s.body[j]) + (s.position[j] - c.position[s.body[j]]) -
                   (s.position[i] - c.position[s.body[i]]);
    return s.radius[i] + s.radius[j] - d.norm();
  };
  double worst = 0.0;
  const std::size_t n = a.state.bodies.spheres.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const double depth = overlap(a.state.bodies, i, j);
      if (a.state.bodies.spheres.body[i] == a.state.bodies.spheres.body[j] || depth < -0.01) continue;
      deepest = std::max(deepest, depth);
      worst = std::max(worst, std::abs(depth - overlap(b.state.bodies, i, j)));
    }
  return worst;
}

TEST(Tides, APileOnItsOrbitAboutTheSunKeepsItsOverlaps) {
  // The falling frame against an inertial one, in which the Sun rests 1.5e11 m away and the pile moves.
  const double q = 1.5e11, speed = std::sqrt(kSun * 1.1 / q);
  const Surface surface{.restitution = 0.3, .friction = 0.5};
  const std::string contact = "stiffness = 0.3", gravity = "method = 'direct'";
  Experiment falling(scene_text(
      surface, contact, gravity,
      heap(Vec3::Zero(), Vec3::Zero()) +
          perturber(kSun, fmt::format("[perturber.orbit]\neccentricity = 0.1\nperiapsis = {:.17g}\n"
                                      "argument = {:.17g}\ngm = {:.17g}\n",
                                      q, kPi, kSun)))),
      inertial(
          scene_text(surface, contact, gravity,
                     heap(Vec3::Zero(), {0.0, speed, 0.0}) +
                         perturber(kSun, fmt::format("tidal = false\nposition = [{:.17g}, 0, 0]\n", -q))));
  falling.begin();
  inertial.begin();
  EXPECT_EQ(falling.physics.contacts.dt, inertial.physics.contacts.dt);
  double worst = 0.0, deepest = 0.0;
  const auto steps = static_cast<std::uint64_t>(5e4 / falling.physics.contacts.dt) / 50;
  for (int k = 0; k < 50; ++k) {
    falling.advance(steps);
    inertial.advance(steps);
    worst = std::max(worst, overlap_difference(falling, inertial, deepest));
  }
  EXPECT_GT(falling.state.ledger.dissipated, 0.0);
  EXPECT_GT(deepest, 1e-5);
  EXPECT_GT((inertial.state.bodies.velocity[0]).norm(), 200.0);
  report::error(fmt::format("heap 1.5e11 m from the Sun, {:.3g} s ({} steps): overlaps, in radii",
                            falling.state.clock.time(), 50 * steps),
                "the same heap followed in an inertial frame", worst, 1e-9);
}

struct Ledgers {
  double momentum = 0.0, angular = 0.0, energy = 0.0, given = 0.0;
};

/// Two rods and a ball with their own gravity pass a planet; energies relative to the kinetic one at the end.
Ledgers pass(double dt, bool tidal) {
  std::string content;
  content += body({.shape = "rod4", .size = 10, .position = {0, 0, 0}, .spin = {0, 1e-4, 1e-4}});
  content += body({.shape = "rod4", .size = 10, .position = {300, 30, 0}, .spin = {1e-4, 0, -1e-4}});
  content += body({.size = 20, .position = {-90, 260, 130}});
  content +=
      perturber(kPlanet, fmt::format("tidal = {}\n[perturber.orbit]\nperiapsis = 8e6\neccentricity = 1.4\n"
                                     "periapsis_time = 3000\ninclination = 0.3\n",
                                     tidal));
  Experiment e(scene_text({}, step_of(dt), "method = 'direct'", content));
  e.begin();
  e.state.ledger.start_momentum = budget(e.state.bodies).momentum;
  e.state.ledger.start_angular_momentum = budget(e.state.bodies).angular_momentum_about_center;
  const auto energy = [&](const Observation& o) {
    return o.kinetic + o.rotational + o.gravitational - o.perturber_work;
  };
  const Observation start = observe(e.physics, e.state, e.scratch, 0.1);
  Ledgers out;
  for (int k = 0; k < 20; ++k) {
    e.advance(static_cast<std::uint64_t>(std::llround(300.0 / dt)));
    const Observation now = observe(e.physics, e.state, e.scratch, 0.1);
    EXPECT_EQ(now.contacts, 0.0);
    out.momentum = std::max(out.momentum, now.momentum_drift);
    out.angular = std::max(out.angular, now.angular_drift);
    out.energy = std::max(out.energy, std::abs(energy(now) - energy(start)) / (now.kinetic + now.rotational));
    out.given = std::abs(now.perturber_work) / (now.kinetic + now.rotational);
    EXPECT_GT(now.perturber_distance, tidal ? 7.9e6 : 6e6);
  }
  return out;
}

TEST(Tides, WhatThePlanetGivesIsBooked) {
  for (const bool tidal : {true, false}) {
    const std::string frame = tidal ? "falling frame" : "inertial frame";
    const Ledgers coarse = pass(4.0, tidal), fine = pass(2.0, tidal);
    EXPECT_GT(fine.given, 0.3);
    report::error("three bodies pass a planet, " + frame + ": drift of the momentum less what it gave",
                  "conserved", fine.momentum, 1e-13);
    // In the inertial frame the bodies reach 8 km/s, and their mutual 0.03 m/s are known to 1e-12 m/s.
    report::error("the same: drift of the angular momentum less what it gave", "conserved", fine.angular,
                  tidal ? 1e-13 : 3e-9);
    report::error("the same: energy less the planet's work, over the kinetic energy", "conserved",
                  fine.energy, 1e-4);
    report::near("the same: order of the energy in the time step", "2",
                 std::log2(coarse.energy / fine.energy), 2.0, 0.2);
  }
}

TEST(Tides, AFramedPileFeelsTheSameTide) {
  // A run frame of its own, cells, and bodies far apart: the tide is that of the places in the scene.
  const double radius = 1e9;
  const std::string orbit =
      perturber(kPlanet, fmt::format("[perturber.orbit]\neccentricity = 0.2\nperiapsis = {}\n", radius));
  const Vec3 far(3e7, -2e7, 1e6), fast(700.0, -300.0, 64.0);
  Experiment e(scene_text({}, step_of(1.0), "",
                          body({.shape = "rod4", .position = far, .velocity = fast}) +
                              body({.position = Vec3(-4e7, 1e7, 0.0)}) +
                              body({.position = far + Vec3(9, 0, 0), .velocity = fast}) + orbit));
  ASSERT_NE(e.state.shift.velocity, Vec3(Vec3::Zero()));
  ASSERT_FALSE(e.state.bodies.cell.empty());
  e.begin();
  for (const double time : {0.0, 1e4}) {
    e.state.clock.stage_start = time;
    for (std::size_t b = 0; b < 3; ++b) e.state.bodies.force[b].setZero();
    add_perturbers(e.physics, 0.0, e.state, e.scratch.perturbers);
    const Vec3 planet = motion(e.physics.perturbers[0].orbit, time).position;
    for (std::size_t b = 0; b < 3; ++b) {
      const Vec3 x = place(e.state.bodies, b) + e.state.shift.position + time * e.state.shift.velocity;
      const Vec3 r = planet - x;
      const Vec3 tide = kPlanet * (r / std::pow(r.norm(), 3) - planet / std::pow(planet.norm(), 3));
      EXPECT_LT((e.state.bodies.force[b] / e.state.bodies.mass[b] - tide).norm(), 1e-8 * tide.norm()) << b;
    }
  }
}

TEST(Tides, AnyNumberOfThreadsGivesTheSameBits) {
  const auto run = [](int threads) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    Experiment e(scene_text({}, "stiffness = 1e5", "method = 'direct'\ninterval = 10",
                            cloud("rod4", 300, 2.0, 2000.0) + circle(kPlanet, 8e6)));
    e.begin();
    e.advance(40);
    omp_set_num_threads(before);
    return e;
  };
  const Experiment one = run(1), two = run(2);
  EXPECT_EQ(one.state.bodies.velocity, two.state.bodies.velocity);
  EXPECT_EQ(one.state.bodies.spin, two.state.bodies.spin);
  EXPECT_EQ(one.state.ledger.perturbers.work, two.state.ledger.perturbers.work);
  EXPECT_EQ(one.state.ledger.perturbers.angular_momentum, two.state.ledger.perturbers.angular_momentum);
  EXPECT_NE(one.state.ledger.perturbers.work, 0.0);
}

TEST(Tides, APlanetAmongTheBodiesStopsTheRun) {
  const auto message = [](const std::string& planet) -> std::string {
    Experiment e(scene_text({}, step_of(1.0), "", heap(Vec3::Zero(), Vec3::Zero()) + planet));
    try {
      e.begin();
      e.advance(100);
    } catch (const UnstableError& error) {
      return std::string("unstable: ") + error.what();
    } catch (const InputError& error) {
      return std::string("input: ") + error.what();
    }
    return "";
  };
  const auto fixed = [](const std::string& rest) { return perturber(1e3, rest); };
  EXPECT_EQ(message(fixed("position = [3.5, 0.5, 0]\n")), "");
  EXPECT_EQ(message(fixed("position = [2.5, 0.5, 0]\n")),
            "input: perturber 'P' is 0.7072 m from the centre of sphere 1 of body 1; expected more than 1 m");
  EXPECT_TRUE(message(fixed("radius = 5\ntidal = false\nposition = [6, 0, 0]\n"))
                  .ends_with("of sphere 0 of body 0; expected more than 6 m"));
  EXPECT_EQ(message(fixed("radius = 5\nposition = [4, 0, 0]\n")),
            "input: perturber 'P' is at the zero of the frame, which falls freely in its pull");
  const std::string moving = message(
      perturber(1e-6, "radius = 5\ntrack = [[0, 100, 0, 0, -1, 0, 0], [1e6, -999900, 0, 0, -1, 0, 0]]\n"));
  EXPECT_TRUE(moving.starts_with("unstable: t = 9") && moving.find("perturber 'P' is") != std::string::npos)
      << moving;
}

TEST(Tides, AStepTooLongForTheEncounterIsWarnedOf) {
  for (const double dt : {1.0, 50.0}) {
    Experiment e(scene_text({}, step_of(dt), "", body({}) + circle(kPlanet, 1e7)));
    e.begin();
    const std::vector<std::string> found = warnings(e.physics, e.state.bodies, {});
    if (dt == 1.0)
      EXPECT_TRUE(found.empty());
    else
      EXPECT_EQ(found,
                std::vector<std::string>{
                    "the time step of 50 s is long for perturber 'P', which passes in about 1.58e+03 s"});
  }
}

TEST(Tides, AUniformFieldIsTakenOffTheDrift) {
  Experiment e(
      scene_text({}, step_of(1.0), field({0.0, 1e-3, -2e-3}), heap(Vec3(5e8, 0, 0), {0.1, 0.2, 0.3})));
  e.begin();
  e.state.ledger.start_momentum = budget(e.state.bodies).momentum;
  const Observation before = observe(e.physics, e.state, e.scratch, 0.1);
  e.advance(2000);
  const Observation after = observe(e.physics, e.state, e.scratch, 0.1);
  EXPECT_LT(after.momentum_drift, 1e-13);
  const double gained = after.kinetic + after.rotational + after.elastic - before.kinetic - before.elastic;
  EXPECT_NEAR(after.field - before.field, -gained, 1e-3 * std::abs(gained));
}

}  // namespace
}  // namespace cairn
