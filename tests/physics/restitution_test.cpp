// Central blows of two spheres and of a sphere on a wall against the damped oscillator, over the phases of
// the step at first touch: the first curve of speed against accuracy that a user meets.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/law/pair.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kStiffness = 1e7;  // N/m
constexpr double kSpeed = 0.1;      // m/s
constexpr int kPhases = 20;

enum class Partner { sphere, wall };

struct Blow {
  double restitution, duration, overlap;  ///< s, m
};

/// A unit sphere falls on its partner; first touch is `phase` of a step after a step begins.
Blow blow(Partner partner, double restitution, double steps_per_contact, double phase) {
  const bool on_wall = partner == Partner::wall;
  Experiment e(
      scene_text({.restitution = restitution},
                 fmt::format("stiffness = {}\nsteps_per_contact = {}", kStiffness, steps_per_contact), "",
                 body({.position = {0, 0, 1.1}, .velocity = {0, 0, -kSpeed}}) +
                     (on_wall ? wall() : body({.position = {0, 0, -1}})),
                 1e3));
  e.begin();
  const double dt = e.physics.contacts.dt;
  Bodies& bodies = e.state.bodies;
  bodies.position[0].z() = 1.0 + kSpeed * dt * (1.0 + phase);
  place_spheres(bodies);
  e.begin();
  const auto overlap = [&] {
    return on_wall ? 1.0 - bodies.position[0].z() : 2.0 - (bodies.position[0] - bodies.position[1]).norm();
  };
  const auto speed = [&] { return bodies.velocity[0].z() - (on_wall ? 0.0 : bodies.velocity[1].z()); };
  while (!e.touching()) e.advance(1);
  // Times of touch and parting between the steps, by straight lines through the overlaps.
  Blow out{0.0, overlap() / kSpeed, 0.0};
  while (e.touching()) {
    out.overlap = std::max(out.overlap, overlap());
    e.advance(1);
    out.duration += dt;
  }
  out.duration += overlap() / speed();
  out.restitution = speed() / kSpeed;
  return out;
}

std::string name(Partner partner) {
  return partner == Partner::wall ? "sphere on wall" : "two spheres";
}

TEST(Restitution, ComesOutAsAskedForAtEveryPhaseOfTheStep) {
  for (const Partner partner : {Partner::sphere, Partner::wall})
    for (const double asked : {0.05, 0.2, 0.55, 0.9}) {
      double mean = 0.0, worst = 0.0, duration = 0.0, overlap = 0.0;
      const double mass = 2000.0 * 4.0 / 3.0 * kPi * (partner == Partner::wall ? 1.0 : 0.5);
      const double zeta = 0.5 * damping_ratio(asked), omega = std::sqrt(kStiffness / mass),
                   damped = omega * std::sqrt(1.0 - zeta * zeta);
      const double time = kPi / damped;
      const double depth = kSpeed / omega * std::exp(-zeta * omega / damped * std::acos(zeta));
      for (int k = 0; k < kPhases; ++k) {
        const Blow b = blow(partner, asked, 50, (k + 0.5) / kPhases);
        mean += b.restitution / kPhases;
        worst = std::max(worst, std::abs(b.restitution - asked));
        duration = std::max(duration, std::abs(b.duration / time - 1.0));
        overlap = std::max(overlap, std::abs(b.overlap / depth - 1.0));
      }
      const std::string what = fmt::format("{}, e = {}", name(partner), asked);
      report::close(what + ": mean over 20 phases, 50 steps per contact", "value asked for", mean, asked,
                    asked < 0.1 ? 0.01 : 0.005);
      report::error(what + ": worst phase, relative", "value asked for", worst / asked,
                    asked < 0.1 ? 0.01 : 0.005);
      report::error(what + ": duration, worst phase, relative", "damped oscillator", duration, 0.01);
      report::error(what + ": greatest overlap, worst phase, relative", "damped oscillator", overlap, 0.005);
    }
}

TEST(Restitution, ErrorFallsWithTheSquareOfTheStep) {
  const std::vector<double> steps{5, 7, 10, 14, 20, 30, 50, 100, 200};
  std::vector<report::Curve> curves;
  for (const double asked : {0.2, 0.55, 0.9}) {
    report::Curve worst{fmt::format("e = {}, worst phase", asked), {}, {}};
    for (const double n : steps) {
      double error = 0.0;
      for (int k = 0; k < kPhases; ++k)
        error = std::max(
            error, std::abs(blow(Partner::sphere, asked, n, (k + 0.5) / kPhases).restitution / asked - 1.0));
      worst.x.push_back(n);
      worst.y.push_back(error);
    }
    const std::size_t last = steps.size() - 1;
    const double slope =
        std::log(worst.y[last - 2] / worst.y[last]) / std::log(steps[last] / steps[last - 2]);
    report::near(fmt::format("e = {}: order of the error in the step, 50 to 200 steps per contact", asked),
                 "second order", slope, 2.0, 0.3);
    curves.push_back(worst);
  }
  report::plot("restitution", "Relative error of the restitution of two spheres against steps per contact.",
               {"steps per contact", "relative error", true, true}, curves);
  report::note(
      "Default: 50 steps per contact. 20 give the restitution to 1 % at 0.55 and are stable for two bodies; "
      "a light body between several stiff contacts needs the rest.");
}

/// Change of the energy of elastic bodies that fly to and fro, with what the ledger says is lost, over their
/// energy, after a hundred thousand steps.
double energy_drift(const Surface& surface, double steps_per_contact, const std::string& content) {
  Experiment e(scene_text(
      surface, fmt::format("stiffness = {}\nsteps_per_contact = {}", kStiffness, steps_per_contact), "",
      content));
  e.begin();
  const double start = e.kinetic_energy();
  e.advance(100000);
  while (e.touching()) e.advance(1);
  return (e.kinetic_energy() + e.state.ledger.dissipated) / start - 1.0;
}

std::string lid(double height) {
  return wall(-Vec3::UnitZ(), {0, 0, height});
}

TEST(Restitution, ElasticContactsKeepTheirEnergyHoweverManyTheyAre) {
  const auto ball = [](double z, double speed, double size = 1.0) {
    return body({.size = size, .position = {0, 0, z}, .velocity = {0, 0, speed}});
  };
  const std::string rod = body({.shape = "dumbbell",
                                .position = {0, 0, 2},
                                .velocity = {0, 0, kSpeed},
                                .orientation = Quat(0.9, 0.3, 0.1, 0.2).normalized()});
  struct Case {
    std::string name, content;
    double tolerance;
  };
  // Two spheres also touch a plate and each other at once.
  const Case cases[] = {{"a sphere between two plates", ball(1.005, kSpeed) + wall() + lid(2.02), 1e-10},
                        {"a sphere between a plate and a sphere of 27000 times its mass",
                         ball(1.005, kSpeed) + ball(32.02, 0.0, 30.0) + wall(), 1e-9},
                        {"a dumbbell that tumbles between two plates", rod + wall() + lid(4.0), 1e-4},
                        {"two spheres between two plates",
                         ball(1.005, kSpeed) + ball(3.017, -0.3 * kSpeed) + wall() + lid(4.03), 3e-2}};
  constexpr double cohesion = 4.6e3;  // Pa; the pull is 0.16 of the force at the greatest overlap
  for (const Case& c : cases)
    for (const bool sticky : {false, true})
      for (const double n : {20.0, 50.0})
        report::error(
            fmt::format("{}, e = 1{}, {} steps per contact: change of the energy in 1e5 steps, relative",
                        c.name, sticky ? ", cohesive" : "", n),
            "conserved", std::abs(energy_drift({.cohesion = sticky ? cohesion : 0.0}, n, c.content)),
            c.tolerance);
}

TEST(Restitution, WhatElasticContactsLoseToFrictionIsInTheLedger) {
  const std::string skew = body({.position = {0, 0, 1.005},
                                 .velocity = {0.4 * kSpeed, 0.7 * kSpeed, kSpeed},
                                 .spin = {3.0 * kSpeed, -kSpeed, 5.0 * kSpeed}}) +
                           wall() + lid(2.02);
  for (const double n : {20.0, 50.0, 100.0}) {
    const double drift = energy_drift({.friction = 0.2, .rolling = 0.1, .twisting = 0.1}, n, skew);
    report::error(
        fmt::format("a spinning sphere between two rough plates, e = 1, {} steps per contact: energy and "
                    "what the ledger says is lost, change in 1e5 steps, relative",
                    n),
        "conserved", std::abs(drift), 2e-3 / (n * n));
  }
}

}  // namespace
}  // namespace cairn
