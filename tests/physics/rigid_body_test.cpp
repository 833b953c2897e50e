// Aggregates as rigid bodies: gravity torques, a precessing top, blows on a floor, stacks at rest.
#include <gtest/gtest.h>

#include <cstdlib>

#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kG = kGravitationalConstant;

using Long3 = Eigen::Matrix<long double, 3, 1>;

/// Acceleration (m/s^2) of sphere i by every sphere of the other bodies, summed naively.
Vec3 direct_acceleration(const Spheres& s, std::size_t i) {
  Long3 sum = Long3::Zero();
  for (std::size_t j = 0; j < s.size(); ++j) {
    if (s.body[j] == s.body[i]) continue;
    const Long3 d = s.position[j].cast<long double>() - s.position[i].cast<long double>();
    const long double r2 = d.squaredNorm();
    sum += kG * s.mass[j] / (r2 * std::sqrt(r2)) * d;
  }
  return sum.cast<double>();
}

/// Torque on body b (N m) by every sphere of the others, summed naively.
Vec3 direct_torque(const Bodies& bodies, std::size_t b) {
  const Spheres& s = bodies.spheres;
  Vec3 torque = Vec3::Zero();
  for (std::size_t i = bodies.first_sphere[b]; i < bodies.first_sphere[b + 1]; ++i)
    torque += (s.position[i] - bodies.position[b]).cross(s.mass[i] * direct_acceleration(s, i));
  return torque;
}

Experiment attracted(const std::string& shape, const std::string& method, const Vec3& at,
                     const std::string& partner, double density = 2000.0) {
  Experiment e("mass_model = 'spheres'\n" +
               scene_text({}, "stiffness = 1e9", "method = '" + method + "'",
                          body({.shape = shape, .orientation = Quat(0.8, 0.3, -0.4, 0.3)}) +
                              body({.shape = partner, .size = 2.0, .density = density, .position = at})));
  e.begin();
  return e;
}

/// Torque on body 0 by a point mass `distance` away, up to its moments of the given order: the field at a
/// point d of the body is that at its centre times sum_k C_k(cos) (|d| / r)^k, C_k the Gegenbauer polynomial
/// of index 3/2. The first order is MacCullagh's, of the inertia of the body itself.
Vec3 multipole_torque(const Bodies& bodies, double distance, const Vec3& direction, int order) {
  const double field = kG * bodies.mass[1] / std::pow(distance, 2);
  const Mat3 inertia = inverse_inertia(bodies, 0).inverse();
  Vec3 torque = 3.0 * field / distance * direction.cross(inertia * direction);
  for (std::size_t i = bodies.first_sphere[0]; i < bodies.first_sphere[1]; ++i) {
    const Vec3 d = bodies.spheres.position[i] - bodies.position[0];
    const double size = d.norm();
    if (size == 0.0) continue;
    const double x = d.dot(direction) / size, near = size / distance;
    const double gegenbauer[] = {1.5 * (5.0 * x * x - 1.0), 2.5 * x * (7.0 * x * x - 3.0)};
    for (int k = 2; k <= order; ++k)
      torque += field * bodies.spheres.mass[i] * gegenbauer[k - 2] * std::pow(near, k) * d.cross(direction);
  }
  return torque;
}

TEST(GravityTorque, AgreesWithMacCullaghFarAwayAndTheNextMomentsNearer) {
  const Vec3 direction = Vec3(2.0, -1.0, 1.5).normalized();
  // The difference falls with a power of r that says which is the next moment of the shape: the odd ones of a
  // shape with a centre of symmetry vanish, and of a tetrahedron the second and the fifth.
  struct Case {
    const char* shape;
    int order;
    double power;
  };
  const Case cases[] = {{"dumbbell", 1, 2}, {"dumbbell", 3, 4},   {"rod4", 1, 2},    {"rod4", 3, 4},
                        {"slab", 1, 2},     {"slab", 3, 4},       {"l_shape", 1, 1}, {"l_shape", 2, 2},
                        {"l_shape", 3, 3},  {"tetrahedron", 3, 3}};
  const std::vector<double> distances{10.0, 30.0, 100.0, 300.0, 1e3, 1e4, 1e5};
  std::vector<report::Curve> curves;
  for (const auto& [shape, order, power] : cases) {
    // Farther away the difference drowns in rounding.
    const std::size_t points = order == 1 ? 7 : 5, from = order == 3 ? 1 : 2;
    const char* const names[] = {"second moments", "second and third moments", "second to fourth moments"};
    report::Curve curve{fmt::format("{}, {}", shape, names[order - 1]), {}, {}};
    for (std::size_t k = 0; k < points; ++k) {
      const Experiment e = attracted(shape, "direct", distances[k] * direction, "sphere", 1e-6);
      const Vec3 torque = e.state.bodies.torque[0];
      curve.x.push_back(distances[k]);
      curve.y.push_back((torque - multipole_torque(e.state.bodies, distances[k], direction, order)).norm() /
                        torque.norm());
    }
    const std::string what =
        fmt::format("{}, torque by a point mass against its {}: ", shape, names[order - 1]);
    report::error(what + fmt::format("difference {:.0f} radii away, relative", curve.x.back()),
                  order == 1 ? "MacCullagh, (3 G M / r^3) n x I n" : "multipole expansion of the masses",
                  curve.y.back(),
                  order == 1   ? 1e-4
                  : order == 2 ? 2e-5
                               : 1e-7);
    report::near(
        what + fmt::format("order of it in 1/r, {:g} to {:g} radii", curve.x[from], curve.x[from + 1]),
        "next moment of the shape",
        -std::log(curve.y[from + 1] / curve.y[from]) / std::log(curve.x[from + 1] / curve.x[from]), power,
        0.05);
    curves.push_back(curve);
  }
  report::plot("maccullagh", "Torque by a point mass on a shape against its moments of mass.",
               {"distance (m)", "relative difference", true, true}, curves);
}

TEST(GravityTorque, AgreesWithDirectSumsNear) {
  for (const std::string shape : {"dumbbell", "l_shape", "tetrahedron", "cube"})
    for (const std::string method : {"direct", "tree"}) {
      const Experiment e = attracted(shape, method, Vec3(5.5, -3.0, 4.0), "rod4");
      const Bodies& bodies = e.state.bodies;
      const Vec3 sum = direct_torque(bodies, 0);
      report::error(fmt::format("{} beside a rod, gravity by {}: torque, relative", shape, method),
                    "naive sum in long double", (bodies.torque[0] - sum).norm() / sum.norm(), 1e-12);
      double worst = 0.0;
      for (std::size_t i = 0; i < bodies.spheres.size(); ++i) {
        const Vec3 g = direct_acceleration(bodies.spheres, i);
        worst = std::max(worst, (e.scratch.acceleration[i] - g).norm() / g.norm());
      }
      report::error(
          fmt::format("{} beside a rod, gravity by {}: acceleration of every sphere, worst", shape, method),
          "naive sum in long double", worst, 1e-14);
    }
  // Enough bodies that the tree takes most of them as cells.
  for (const double asked : {1e-2, 1e-3}) {
    Experiment e("seed = 5\n" + scene_text({}, "stiffness = 1e9", fmt::format("error = {}", asked),
                                           cloud("l_shape", 500, 1.0, 2000.0)));
    e.begin();
    const Bodies& bodies = e.state.bodies;
    double field = 0.0, of_field = 0.0, torque = 0.0, of_torque = 0.0, of_levers = 0.0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      double levers = 0.0;
      for (std::size_t i = bodies.first_sphere[b]; i < bodies.first_sphere[b + 1]; ++i) {
        const Vec3 g = direct_acceleration(bodies.spheres, i);
        field += (e.scratch.acceleration[i] - g).squaredNorm();
        of_field += g.squaredNorm();
        levers +=
            (bodies.spheres.position[i] - bodies.position[b]).norm() * bodies.spheres.mass[i] * g.norm();
      }
      const Vec3 sum = direct_torque(bodies, b);
      torque += (bodies.torque[b] - sum).squaredNorm();
      of_torque += sum.squaredNorm();
      of_levers += levers * levers;
    }
    const std::string what = fmt::format("cloud of 500 bodies of l_shape, gravity error {}: ", asked);
    report::error(what + "accelerations of the spheres, RMS, relative", "naive sum in long double",
                  std::sqrt(field / of_field), asked);
    report::error(what + "torques on the bodies, RMS, over that of sum |x_i - X| m_i g_i", "the same",
                  std::sqrt(torque / of_levers), asked);
    report::error(what + "torques on the bodies, RMS, relative", "the same", std::sqrt(torque / of_torque),
                  10.0 * asked);
  }
  report::note(
      "The error asked for is that of the field. A body feels as torque only what the field differs by from "
      "one of its spheres to the next, so in a pile the torque of gravity is relatively some ten times less "
      "accurate. Ask for a smaller error where gravity's torque on single grains matters; contacts give far "
      "greater ones.");
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
