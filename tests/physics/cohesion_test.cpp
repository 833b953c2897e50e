// Cohesion against statics: what a contact bears before it parts, and where a chain breaks.
#include <gtest/gtest.h>

#include <algorithm>

#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kStiffness = 1e8, kCohesion = 2e4, kBeta = 0.5;
const double kHalf = 1.0 + std::sqrt(0.75);                     // half the length of a dumbbell
const Quat kUpright(std::sqrt(0.5), 0.0, std::sqrt(0.5), 0.0);  // dumbbell along z

/// c (2 beta R)^2 (N).
double strength(double effective_radius) {
  return kCohesion * std::pow(2.0 * kBeta * effective_radius, 2);
}

std::string contact_keys() {
  return fmt::format("stiffness = {}", kStiffness);
}

/// Wrenches of the last step in which body 0, led away from the other bodies, still touched.
struct PullOff {
  Vec3 force_0, torque_0, force_1, torque_1;
  double spring;  ///< N, what the overlap that is left pushes
};

/// Overlap of the only contact (m).
double overlap(const Experiment& e) {
  const Spheres& s = e.state.bodies.spheres;
  if (!e.state.walls.empty()) return s.radius[0] - s.position[0].z();
  const ContactRecord r = e.state.contacts.records().front();
  return s.radius[r.i] + s.radius[r.j] - (s.position[r.j] - s.position[r.i]).norm();
}

PullOff pull_off(const std::string& content, const Vec3& away) {
  Experiment e(scene_text({.beta = kBeta, .cohesion = kCohesion}, contact_keys(), "", content));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  PullOff out{};
  while (e.touching()) {
    out = {bodies.force[0], bodies.torque[0], Vec3::Zero(), Vec3::Zero(), kStiffness * overlap(e)};
    if (bodies.size() > 1) {
      out.force_1 = bodies.force[1];
      out.torque_1 = bodies.torque[1];
    }
    lead(e, 0, 1e-7 / e.physics.contacts.dt * away, Vec3::Zero());
    if (bodies.size() > 1) lead(e, 1, Vec3::Zero(), Vec3::Zero());
    e.advance(1);
  }
  return out;
}

TEST(Cohesion, PullOffForceIsCTimesTheSquareOfTheContactWidth) {
  const double start = 1.00005e-4;  // no whole number of the 1e-7 steps: the last touch is at half a step
  const Vec3 z = Vec3::UnitZ();
  const auto check = [&](const std::string& what, const PullOff& p, double radius) {
    EXPECT_LT(p.spring, 1.0);  // within one step of 1e-7 m of parting
    report::close(what + ": pull at the last touch and what its spring pushes, N", "c (2 beta R)^2",
                  p.spring - p.force_0.z(), strength(radius), 1e-11);
  };
  check("spheres of radii 1 and 3",
        pull_off(body({.position = {0, 0, 4.0 - start}}) + body({.size = 3.0}), z), 0.75);
  check("sphere on wall", pull_off(body({.position = {0, 0, 1.0 - start}}) + wall(), z), 1.0);
  // A horizontal dumbbell whose right-hand sphere stands on a sphere.
  const double arm = std::sqrt(0.75);
  const PullOff off = pull_off(body({.shape = "dumbbell", .position = {-arm, 0, 2.0 - start}}) + body({}), z);
  check("end of a dumbbell on a sphere, off-centre", off, 0.5);
  report::close("the same: torque on the dumbbell about its centre, N m", "lever x (c (2 beta R)^2 - spring)",
                off.torque_0.y(), arm * (strength(0.5) - off.spring), 1e-11);
  report::error("the same: force and torque on the sphere against those on the dumbbell, over the pull",
                "equal and opposite about the contact",
                ((off.force_0 + off.force_1).norm() + off.torque_1.norm()) / strength(0.5), 1e-13);
}

constexpr double kRollingLimit = 4.0;

/// Does a body hang on from a held unit sphere when its weight has grown to `load` of the strength? Central:
/// a sphere. Off-centre: a level dumbbell by one end, its moment borne by rolling resistance.
bool hangs(double load, bool off_centre) {
  const double weight = load * strength(0.5), overlap = strength(0.5) / kStiffness;
  const Put grain = off_centre ? Put{.shape = "dumbbell", .position = {std::sqrt(0.75), 0, overlap - 2.0}}
                               : Put{.position = {0, 0, overlap - 2.0}};
  Experiment e(scene_text({.restitution = 0.1,
                           .friction = 1.0,
                           .rolling = kRollingLimit,
                           .twisting = 1.0,
                           .beta = kBeta,
                           .cohesion = kCohesion},
                          contact_keys(), "", body({}) + body(grain)));
  e.begin();
  const Bodies& bodies = e.state.bodies;
  constexpr int steps = 20'000;
  for (int k = 0; k < steps; ++k) {
    e.physics.field =
        Vec3(0, 0, -weight / bodies.mass[1] * (0.5 - 0.5 * std::cos(kPi * std::min(1.0, 1.4 * k / steps))));
    lead(e, 0, Vec3::Zero(), Vec3::Zero());
    e.advance(1);
  }
  return e.touching() && bodies.velocity[1].norm() < 1e-5;
}

double heaviest(bool off_centre) {
  double low = 0.4, high = 1.1;
  while (high - low > 5e-4) {
    const double middle = 0.5 * (low + high);
    (hangs(middle, off_centre) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

TEST(Cohesion, BodyHangsOnUpToTheLoadThatStaticsAllows) {
  report::near("weight of the heaviest sphere that hangs from a sphere, over c (2 beta R)^2", "statics",
               heaviest(false), 1.0, 1e-3);
  // W a = mu_R beta R (F_C - W): cohesion minus weight is what presses the surfaces together.
  const double limit = kRollingLimit * kBeta * 0.5, arm = std::sqrt(0.75);
  report::near("weight of the heaviest dumbbell that hangs level by one end, over c (2 beta R)^2",
               "statics: the moment W a is borne up to mu_R beta R (F_C - W)", heaviest(true),
               limit / (limit + arm), 1e-3);
}

/// A chain of upright dumbbells of the given sizes hanging from a sphere that is held; the field grows until
/// it breaks.
struct Break {
  std::size_t link;  ///< 0: under the held sphere
  double field;      ///< m/s^2
};

Break hang(const std::vector<double>& sizes) {
  double z = 0.0;
  std::string content = body({.size = sizes[0]});
  double above = sizes[0];
  for (const double size : sizes) {
    const double overlap = strength(above * size / (above + size)) / kStiffness;
    z -= (z == 0.0 ? above : kHalf * above) + kHalf * size - overlap;
    content += body({.shape = "dumbbell", .size = size, .position = {0, 0, z}, .orientation = kUpright});
    above = size;
  }
  Experiment e(scene_text({.restitution = 0.1,
                           .friction = 1.0,
                           .rolling = 1.0,
                           .twisting = 1.0,
                           .beta = kBeta,
                           .cohesion = kCohesion},
                          "stiffness = 1e8\nsteps_per_contact = 20", "", content));
  e.begin();
  constexpr int steps = 60'000;
  const auto held = static_cast<std::ptrdiff_t>(sizes.size());
  for (int k = 0; k < steps; ++k) {
    e.physics.field = Vec3(0.0, 0.0, -0.2 * k / steps);
    lead(e, 0, Vec3::Zero(), Vec3::Zero());
    e.advance(1);
    const auto links = e.state.contacts.records();
    if (static_cast<std::ptrdiff_t>(links.size()) == held) continue;
    std::size_t link = 0;  // the first without a record, in order of bodies
    const auto& body_of = e.state.bodies.spheres.body;
    while (link < links.size() && body_of[links[link].i] == link) ++link;
    return {link, -e.physics.field.z()};
  }
  return {sizes.size(), 0.0};
}

TEST(Cohesion, HangingChainOfAggregatesBreaksWhereAndWhenStaticsSays) {
  const std::vector<std::vector<double>> chains{
      {1.0, 1.0, 1.0, 1.0}, {2.0, 1.5, 0.4, 1.2}, {1.5, 1.5, 1.0, 0.3, 1.0}};
  for (const std::vector<double>& sizes : chains) {
    // Weight below each link over its strength; unit-size dumbbells weigh `unit`.
    const double unit =
        Experiment(scene_text({}, contact_keys(), "", body({.shape = "dumbbell"}))).state.bodies.mass[0];
    double below = 0.0, weakest = 1e300;
    std::size_t link = 0;
    for (std::size_t k = sizes.size(); k-- > 0;) {
      below += unit * std::pow(sizes[k], 3);
      const double above = k > 0 ? sizes[k - 1] : sizes[0];
      const double bears = strength(above * sizes[k] / (above + sizes[k])) / below;
      if (bears < weakest) {
        weakest = bears;
        link = k;
      }
    }
    const Break b = hang(sizes);
    const std::string what = fmt::format("chain of dumbbells of sizes {}", fmt::join(sizes, ", "));
    report::near(what + ": link that breaks, from the top", "statics", static_cast<double>(b.link),
                 static_cast<double>(link), 0.0);
    report::close(what + ": field at which it breaks, m/s^2", "strength over weight below", b.field, weakest,
                  5e-3);
  }
}

TEST(Cohesion, EnergyBalancesThroughABreak) {
  for (const double restitution : {1.0, 0.55}) {
    const double mass = 2000.0 * 4.0 / 3.0 * kPi, mu = 0.5 * mass;
    const double depth = strength(0.5) / kStiffness;
    const double bond = 0.5 * strength(0.5) * depth;  // J to part the two from their equilibrium
    const double speed = 3.0 * std::sqrt(2.0 * bond / mu);
    Experiment e(scene_text({.restitution = restitution, .beta = kBeta, .cohesion = kCohesion},
                            fmt::format("stiffness = {}\nsteps_per_contact = 200", kStiffness), "",
                            body({.position = {0, 0, 2.0 - depth}, .velocity = {0, 0, speed}}) + body({})));
    e.begin();
    const double before = e.kinetic_energy() + e.spring_energy(), kinetic = e.kinetic_energy();
    while (e.touching()) e.advance(1);
    e.advance(1);
    const std::string what = fmt::format("two spheres torn apart, e = {}", restitution);
    if (restitution == 1.0)
      report::close(what + ": kinetic energy after, J", "before less F_C^2 / 2k",
                    e.kinetic_energy() - 0.5 * kinetic, 0.5 * kinetic - bond, 1e-3);
    report::error(what + ": energy gone astray over that of the bond",
                  "kinetic + springs + cohesion + dissipated",
                  std::abs(e.kinetic_energy() + e.state.ledger.dissipated - before) / bond, 1e-3);
  }
}

// The end of one dumbbell on the end of another, across it: both spin when they part.
TEST(Cohesion, EnergyBalancesWhenAggregatesBreakOffCentre) {
  const Quat across(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  const double depth = strength(0.5) / kStiffness, bond = 0.5 * strength(0.5) * depth, end = std::sqrt(0.75);
  for (const double restitution : {1.0, 0.55}) {
    const Put below{.shape = "dumbbell"};
    const double mass = Experiment(scene_text({}, contact_keys(), "", body(below))).state.bodies.mass[0];
    const double speed = 8.0 * std::sqrt(2.0 * bond / mass);
    const Put above{.shape = "dumbbell",
                    .position = {end, end, 2.0 - depth},
                    .velocity = {0.3 * speed, 0, speed},
                    .orientation = across};
    Experiment e(scene_text({.restitution = restitution,
                             .friction = 0.6,
                             .rolling = 0.5,
                             .twisting = 0.5,
                             .beta = kBeta,
                             .cohesion = kCohesion},
                            fmt::format("stiffness = {}\nsteps_per_contact = 400", kStiffness), "",
                            body(above) + body(below)));
    e.begin();
    ASSERT_TRUE(e.touching());
    const double before = e.kinetic_energy() + e.spring_energy(), kinetic = e.kinetic_energy();
    while (e.touching()) e.advance(1);
    e.advance(1);
    EXPECT_LT(e.kinetic_energy(), kinetic - 0.5 * bond);
    EXPECT_GT(e.state.bodies.spin[1].norm(), 0.0);
    report::error(
        fmt::format("two dumbbells torn apart off-centre, e = {}: energy gone astray over that of the bond",
                    restitution),
        "kinetic + springs + cohesion + dissipated",
        std::abs(e.kinetic_energy() + e.state.ledger.dissipated - before) / bond, 1e-3);
  }
}

}  // namespace
}  // namespace cairn
