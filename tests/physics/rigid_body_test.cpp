// Aggregates as rigid bodies: gravity torques, a precessing top, blows on a floor, stacks at rest.
#include <gtest/gtest.h>

#include <cstdlib>

#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kG = kGravitationalConstant;

/// Torque on body b (N m) by every sphere of the others, summed naively.
Vec3 direct_torque(const Bodies& bodies, std::size_t b) {
  const Spheres& s = bodies.spheres;
  Vec3 torque = Vec3::Zero();
  for (std::size_t i = 0; i < s.size(); ++i)
    for (std::size_t j = 0; j < s.size(); ++j) {
      if (s.body[i] != b || s.body[j] == b) continue;
      const Vec3 d = s.position[j] - s.position[i];
      torque +=
          (s.position[i] - bodies.position[b]).cross(kG * s.mass[i] * s.mass[j] * d / std::pow(d.norm(), 3));
    }
  return torque;
}

Experiment attracted(const std::string& shape, const std::string& method, const Vec3& at,
                     const std::string& partner) {
  Experiment e("mass_model = 'spheres'\n" +
               scene_text({}, "stiffness = 1e9", "method = '" + method + "'",
                          body({.shape = shape, .orientation = Quat(0.8, 0.3, -0.4, 0.3)}) +
                              body({.shape = partner, .size = 2.0, .position = at})));
  e.begin();
  return e;
}

TEST(GravityTorque, AgreesWithMacCullaghFarAwayAndWithDirectSumsNear) {
  const Vec3 direction = Vec3(2.0, -1.0, 1.5).normalized();
  std::vector<report::Curve> curves;
  for (const std::string shape : {"dumbbell", "rod4", "l_shape", "slab"}) {
    report::Curve curve{shape, {}, {}};
    for (const double distance : {10.0, 30.0, 100.0, 300.0, 1000.0}) {
      const Experiment e = attracted(shape, "direct", distance * direction, "sphere");
      const Bodies& bodies = e.state.bodies;
      const Mat3 inertia = inverse_inertia(bodies, 0).inverse();
      const Vec3 far =
          3.0 * kG * bodies.mass[1] / std::pow(distance, 3) * direction.cross(inertia * direction);
      curve.x.push_back(distance);
      curve.y.push_back((bodies.torque[0] - far).norm() / far.norm());
    }
    report::error(shape + ": torque by a point mass 1000 radii away, relative",
                  "MacCullagh, (3 G M / r^3) n x I n", curve.y.back(), 0.02);
    // The next moment of a shape with a centre of symmetry is two orders higher, of others one.
    const double order = shape == "l_shape" ? 1.0 : 2.0;
    const std::size_t last = curve.x.size() - 2;
    report::near(shape + ": order in 1/r of the difference, 10 to 300 radii", "next moment of the shape",
                 -std::log(curve.y[last] / curve.y[last - 1]) / std::log(curve.x[last] / curve.x[last - 1]),
                 order, 0.1);
    curves.push_back(curve);
  }
  report::plot("maccullagh", "Torque on a shape against MacCullagh's formula.",
               {"distance (m)", "relative difference", true, true}, curves);
  for (const std::string shape : {"dumbbell", "l_shape", "tetrahedron", "cube"})
    for (const std::string method : {"direct", "tree"}) {
      const Experiment e = attracted(shape, method, Vec3(5.5, -3.0, 4.0), "rod4");
      const Vec3 sum = direct_torque(e.state.bodies, 0);
      report::error(fmt::format("{} beside a rod, gravity by {}: torque, relative", shape, method),
                    "naive double sum", (e.state.bodies.torque[0] - sum).norm() / sum.norm(),
                    method == "direct" ? 1e-12 : 1e-3);
    }
}

TEST(PrecessingTop, TurnsAtTheSteadyRateOfLagrange) {
  // A rod spinning about its length, inclined to the direction of a planet: both are held in place, the
  // planet's pull turns the rod. V = (kappa / 2) cos^2(theta), kappa = (3 G M / r^3)(I_axis - I_cross).
  constexpr double distance = 400.0, theta = 1.0, spin = 5e-3;
  const Quat inclined(Eigen::AngleAxisd(theta - kPi / 2.0, Vec3::UnitY()));  // rod's x axis to theta from z
  const double dt = 10.0;
  Experiment e("mass_model = 'spheres'\n" +
               scene_text({}, fmt::format("stiffness = 1\ntime_step = {}\nunsafe_time_step = true", dt),
                          "method = 'direct'",
                          body({.shape = "rod4", .orientation = inclined}) +
                              body({.size = 100.0, .density = 3000.0, .position = {0, 0, distance}})));
  Bodies& bodies = e.state.bodies;
  const double axial = bodies.inertia[0][0], cross = bodies.inertia[0][2];
  const Vec3 axis = inclined * Vec3::UnitX();
  const double c = axis.z(), s = std::sqrt(1.0 - c * c);
  const double kappa = 3.0 * kG * bodies.mass[1] / std::pow(distance, 3) * (axial - cross);
  // I' W^2 c - L W + kappa c = 0, the slow root, with L = I_axis times the spin about the axis.
  const double momentum = axial * spin;
  const double rate =
      2.0 * kappa * c / (momentum + std::sqrt(momentum * momentum - 4.0 * cross * kappa * c * c));
  const Vec3 across = (Vec3::UnitZ() - c * axis) / s;
  bodies.spin[0] = momentum * axis + cross * rate * s * across;
  e.begin();
  double nod = 0.0, turned = 0.0, before = std::atan2(axis.y(), axis.x());
  const int steps = std::getenv("CAIRN_LONG") ? 1'000'000 : 50'000;
  for (int k = 0; k < steps; ++k) {
    e.advance(1);
    for (std::size_t b = 0; b < 2; ++b) {  // held in place
      bodies.force[b].setZero();
      bodies.velocity[b].setZero();
    }
    Vec3 now = bodies.orientation[0] * Vec3::UnitX();
    if (now.z() * c < 0.0) now = -now;
    const double angle = std::atan2(now.y(), now.x());
    turned += std::remainder(angle - before, 2.0 * kPi);
    before = angle;
    nod = std::max(nod, std::abs(std::acos(now.z()) - std::acos(std::copysign(c, c))));
  }
  report::close(fmt::format("precession of a rod in a planet's pull over {:.1f} turns, rad/s",
                            std::abs(turned) / (2.0 * kPi)),
                "steady precession of a symmetric top, MacCullagh torque",
                turned / (steps * e.physics.contacts.dt), rate, 1e-3);
  report::error("nodding beside it, rad", "steady: none", nod, 1e-3);
}

/// What a blow leaves behind.
struct After {
  Vec3 velocity, spin;  ///< m/s, rad/s
};

constexpr double kSpeed = 0.01, kStiffness = 1e9, kHalfBond = 0.8660254037844386;

/// A smooth body falls on the floor, its lowest sphere 0.3 of a step inside; returns when contacts end.
After land(const Put& grain, double low, double restitution, double steps_per_contact) {
  Put at = grain;
  at.position.z() = low;
  at.velocity.z() = -kSpeed;
  const auto text = [&] {
    return scene_text({.restitution = restitution},
                      fmt::format("stiffness = {}\nsteps_per_contact = {}", kStiffness, steps_per_contact),
                      "", body(at) + wall());
  };
  Experiment probe(text());
  probe.begin();
  at.position.z() += 0.7 * kSpeed * probe.physics.contacts.dt;
  Experiment e(text());
  e.begin();
  while (!e.touching()) e.advance(1);
  while (e.touching()) e.advance(1);
  return {e.state.bodies.velocity[0], angular_velocity(e.state.bodies, 0)};
}

double damping_share(double restitution) {
  const double log_e = std::log(restitution);
  return -log_e / std::sqrt(kPi * kPi + log_e * log_e);
}

TEST(LandingOnAFloor, DumbbellOfEveryOrientationLeavesAsTheImpulseSays) {
  std::vector<report::Curve> curves;
  for (const double restitution : {1.0, 0.55}) {
    double worst = 0.0, worst_spin = 0.0;
    report::Curve form{fmt::format("impulse, e = {}", restitution), {}, {}},
        blow{fmt::format("dumbbell, e = {}", restitution), {}, {}, false};
    for (double angle = 2.0; angle <= 90.0; angle += 4.0) {  // 90: upright
      const double a = angle * kPi / 180.0;
      const Put grain{.shape = "dumbbell", .orientation = Quat(Eigen::AngleAxisd(a, Vec3::UnitY()))};
      Experiment probe(scene_text({}, "stiffness = 1", "", body(grain)));
      const double mass = probe.state.bodies.mass[0], inertia = probe.state.bodies.inertia[0][2];
      const After out = land(grain, 1.0 + kHalfBond * std::sin(a), restitution, 200);
      const double lever = kHalfBond * std::cos(a);
      const double impulse = (1.0 + restitution) * kSpeed / (1.0 / mass + lever * lever / inertia);
      const double velocity = impulse / mass - kSpeed;
      worst = std::max(worst, std::abs(out.velocity.z() - velocity) / kSpeed);
      // Turning +angle about y puts the +x sphere below: the impulse there turns the dumbbell back.
      worst_spin = std::max(worst_spin, std::abs(out.spin.y() + lever * impulse / inertia) / kSpeed);
      form.x.push_back(angle);
      form.y.push_back(velocity / kSpeed);
      blow.x.push_back(angle);
      blow.y.push_back(out.velocity.z() / kSpeed);
    }
    const std::string what = fmt::format("dumbbell on a floor, e = {}, 2 to 90 degrees: ", restitution);
    report::error(what + "velocity after the first blow, worst, over the speed", "impulse (1 + e) mu v",
                  worst, 2e-3);
    report::error(what + "spin after it, worst, times 1 m over the speed", "impulse (1 + e) mu v", worst_spin,
                  2e-3);
    curves.push_back(form);
    curves.push_back(blow);
  }
  report::plot("dumbbell-floor", "Velocity of a smooth dumbbell after its first blow on a floor.",
               {"angle from level (degrees)", "velocity after / speed before"}, curves);
}

/// Restitution of n equal contacts at once on one body of which each alone has effective mass mu: their
/// springs and dashpots add, (n mu / M)^(1/2) times the damping of one.
double joint_restitution(double restitution, int n, double mass_ratio) {
  const double zeta = damping_share(restitution) * std::sqrt(n * mass_ratio);
  return zeta < 1.0 ? std::exp(-kPi * zeta / std::sqrt(1.0 - zeta * zeta)) : 0.0;
}

TEST(LandingOnAFloor, FlatFacesReturnWhatTheirContactsTogetherGive) {
  struct Face {
    const char* shape;
    int contacts;
    double height, lever2;  ///< squared horizontal distance of a contact from the centre
  };
  const double e55 = 0.55;
  for (const Face& face : {Face{"dumbbell", 2, 1.0, 0.75}, Face{"cube", 4, 1.0 + kHalfBond, 1.5}}) {
    const Put grain{.shape = face.shape};
    Experiment probe(scene_text({}, "stiffness = 1", "", body(grain)));
    const double ratio =
        1.0 / (1.0 + face.lever2 * probe.state.bodies.mass[0] / probe.state.bodies.inertia[0][2]);
    report::Curve curve{face.shape, {}, {}};
    const double expected = joint_restitution(e55, face.contacts, ratio);
    for (const double steps : {25.0, 50.0, 100.0, 200.0, 400.0}) {
      const double out = land(grain, face.height, e55, steps).velocity.z() / kSpeed;
      curve.x.push_back(steps);
      curve.y.push_back(std::abs(out - expected));
      if (steps == 400.0)
        report::near(fmt::format("{} landing flat, {} contacts at once, e = 0.55 each: restitution",
                                 face.shape, face.contacts),
                     "damped oscillator with all springs and dashpots", out, expected, 1e-3);
    }
    report::error(
        fmt::format("{} landing flat: error of the restitution at 50 steps per contact", face.shape),
        "the same", curve.y[1], 0.01);
    report::near(fmt::format("{} landing flat: order of the error, 25 to 400 steps", face.shape),
                 "second order", -order_of(curve.x, curve.y), 2.0, 0.4);
  }
  report::note(
      "A body that lands on several contacts at once does not return the restitution asked for: each contact "
      "is damped for its own effective mass, and they share one body. No choice of dashpots can serve both "
      "cases.");
}

/// A stack of cubes on a floor: straight, a little off each other's centres, or each turned against the last.
std::string stack(int cubes, double turn, double x) {
  std::string out;
  double z = 1.0 + kHalfBond;
  // Spheres on spheres, or, turned by 45 degrees, between them.
  const double apart = turn == 0.0 ? 2.0 : std::sqrt(4.0 - 1.5 * 2.0 + 1.5 * std::sqrt(2.0));
  for (int k = 0; k < cubes; ++k) {
    out += body({.shape = "cube",
                 .position = {turn == 0.0 ? x + 0.02 * k * k : x, turn == 0.0 ? -0.01 * k : 0.0, z},
                 .orientation = Quat(Eigen::AngleAxisd(k * turn, Vec3::UnitZ()))});
    z += 2.0 * kHalfBond + apart;
  }
  return out;
}

TEST(RestingStacks, StayWhereTheyAre) {
  const bool long_run = std::getenv("CAIRN_LONG") != nullptr;
  Experiment e(scene_text({.restitution = 0.3, .friction = 1.0, .rolling = 1.05, .twisting = 1.3},
                          "stiffness = 1e9\nsteps_per_contact = 20", field({0, 0, -0.1}),
                          stack(3, 0.0, 0.0) + stack(3, kPi / 4.0, 10.0) + wall()));
  e.begin();
  e.advance(20'000);  // the springs take up the weight
  const std::vector<Vec3> place = e.state.bodies.spheres.position;
  const std::uint64_t steps = long_run ? 1'000'000 : 50'000;
  double creep = 0.0;
  for (int part = 0; part < 50; ++part) {
    e.advance(steps / 50);
    for (std::size_t s = 0; s < place.size(); ++s)
      creep = std::max(creep, (e.state.bodies.spheres.position[s] - place[s]).norm());
  }
  report::error(
      fmt::format("two stacks of three cubes (straight, and each turned by 45 degrees): creep of any "
                  "sphere in {} steps, radii",
                  steps),
      "at rest", creep, 1e-6);
  report::error("kinetic energy of the stacks at the end, J", "at rest", e.kinetic_energy(), 1e-12);
}

}  // namespace
}  // namespace cairn
