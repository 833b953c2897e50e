#include "contact/law/law-inl.h"

#include <gtest/gtest.h>

#include <cmath>

#include "contact/law/pair.h"
#include "unit/contact/random_contact-inl.h"

namespace cairn {
namespace {

using namespace HWY_NAMESPACE;

constexpr double kStiffness = 1e6;

PairLaw rough_law(double cohesion = 0.0) {
  const Material m{.name = "m",
                   .restitution_normal = 0.6,
                   .restitution_tangential = 0.4,
                   .friction = 0.8,
                   .cohesion = cohesion};
  return make_pair_law(m, m, kStiffness);
}

/// A contact at rest with normal z and overlap `x`.
State resting(double x) {
  State s{};
  s.geometry = {triple(Vec3::UnitZ()), triple(Vec3::UnitZ()), x, 0.5, 0.0};
  s.motion.dt = 1e-3;
  return s;
}

template <Features F>
ContactAction<double> act(const PairLaw& law, State& s) {
  return evaluate<F>(LawConstants<double>(law), s.geometry, s.motion, s.memory);
}

TEST(DampingRatio, RunsFromNoneToCritical) {
  EXPECT_EQ(damping_ratio(1.0), 0.0);
  EXPECT_EQ(damping_ratio(0.0), 2.0);
  EXPECT_NEAR(damping_ratio(1e-300), 2.0, 1e-4);
  // x'' + C x' + x = 0 returns with speed e = exp(-pi zeta / sqrt(1 - zeta^2)), zeta = C / 2.
  for (const double e : {0.05, 0.2, 0.55, 0.9}) {
    const double zeta = 0.5 * damping_ratio(e);
    EXPECT_NEAR(std::exp(-kPi * zeta / std::sqrt(1.0 - zeta * zeta)), e, 1e-14);
  }
}

TEST(EffectiveMass, LooseSpheresHaveTwoSeventhsOfTheReducedMassInThePlane) {
  const double m = 3.0, r = 2.0;
  const Inertia ball{1.0 / m, Mat3::Identity() / (0.4 * m * r * r)};
  const Vec3 n = Vec3(1.0, 2.0, -2.0) / 3.0;
  const EffectiveMass mu = effective_mass(ball, r * n, ball, -r * n, n);
  EXPECT_NEAR(mu.normal, 0.5 * m, 1e-14);
  EXPECT_NEAR(mu.tangential, 2.0 / 7.0 * 0.5 * m, 1e-14);
  const EffectiveMass wall = effective_mass(ball, r * n, {}, Vec3::Zero(), n);
  EXPECT_NEAR(wall.normal, m, 1e-14);
  EXPECT_NEAR(wall.tangential, 2.0 / 7.0 * m, 1e-14);
}

TEST(EffectiveMass, IsTheSameFromBothSidesAndFollowsTheLever) {
  Random random(1, 0);
  for (int k = 0; k < 50; ++k) {
    const Mat3 axes = random.rotation().toRotationMatrix();
    const Inertia i{0.5, axes * Vec3(1.0, 0.3, 0.2).asDiagonal() * axes.transpose()},
        j{2.0, 0.7 * Mat3::Identity()};
    const Vec3 a = random.in_ball(), b = random.in_ball(), n = random.direction();
    const EffectiveMass one = effective_mass(i, a, j, b, n), other = effective_mass(j, b, i, a, -n);
    EXPECT_NEAR(one.normal, other.normal, 1e-15);
    EXPECT_NEAR(one.tangential, other.tangential, 1e-15);
    const Vec3 lever = a.cross(n);
    EXPECT_NEAR(1.0 / one.normal, 2.5 + lever.dot(i.inverse_inertia * lever) + 0.7 * b.cross(n).squaredNorm(),
                1e-13);
  }
}

TEST(Law, FrictionHoldsToTheCoulombLimitAndNoFurther) {
  const PairLaw law = rough_law();
  State s = resting(1e-3);
  const double limit = law.friction * kStiffness * 1e-3;
  s.motion.u_mid = {0.01, 0.0, 0.0};  // dashpots see no velocity: springs alone
  double slid = 0.0;
  for (int k = 0; k < 1000; ++k) {
    slid += s.motion.dt * s.motion.u_mid.x;
    const ContactAction<double> a = act<kFriction>(law, s);
    EXPECT_NEAR(a.force.x, std::min(law.k_s * slid, limit), 1e-9 * limit);
    EXPECT_EQ(a.force.y, 0.0);
    EXPECT_NEAR(a.force.z, -kStiffness * 1e-3, 1e-9);
  }
  EXPECT_NEAR(s.memory.slide.x, limit / law.k_s, 1e-15);
  s.motion.u_mid.x *= -1.0;  // turning back unloads the spring at once
  EXPECT_NEAR(act<kFriction>(law, s).force.x, limit - law.k_s * 1e-5, 1e-9 * limit);
}

TEST(Law, ASpringAtItsLimitTurnsTowardsTheSlipAtSecondOrder) {
  // Held at the length H while the slip goes on at speed u, the spring turns by u sin(angle) / H.
  const PairLaw law = rough_law();
  const double length = law.friction * kStiffness * 1e-3 / law.k_s, way = 1.5 * length;
  std::vector<double> errors;
  for (const int steps : {10, 20, 40, 80}) {
    State s = resting(1e-3);
    s.motion.dt = 1e-4;
    s.motion.u_mid = {way / steps / s.motion.dt, 0.0, 0.0};
    s.memory.slide = {0.0, length, 0.0};  // across: no part of it is unloaded
    for (int k = 0; k < steps; ++k) act<kFriction>(law, s);
    const double angle = 2.0 * std::atan(std::exp(-way / length));
    EXPECT_NEAR(std::hypot(s.memory.slide.x, s.memory.slide.y), length, 1e-12 * length);
    errors.push_back(std::abs(std::atan2(s.memory.slide.y, s.memory.slide.x) - angle));
  }
  EXPECT_LT(errors[1], 2e-3);
  for (std::size_t k = 1; k < errors.size(); ++k) EXPECT_GT(std::log2(errors[k - 1] / errors[k]), 1.8) << k;
}

TEST(Law, DashpotAndSpringTogetherStayWithinTheLimit) {
  Random random(3, 0);
  const PairLaw law = rough_law();
  for (int k = 0; k < 2000; ++k) {
    State s = random_state(random);
    const double press =
        std::max(0.0, kStiffness * s.geometry.overlap - s.memory.c_n * dot(s.motion.u, s.geometry.n));
    const ContactAction<double> a = act<kWhole>(law, s);
    const Vec3 n = vector(s.geometry.n), couple = vector(a.couple);
    const double radius = s.geometry.radius, near = 1.0 + 1e-12;
    EXPECT_LE(flat(vector(a.force), n).norm(), near * law.friction * press + 1e-9);
    EXPECT_LE(flat(couple, n).norm(), near * 1.05 * 0.5 * radius * press + 1e-9);
    EXPECT_LE(std::abs(couple.dot(n)), near * 1.3 * 0.5 * radius * 0.8 * press + 1e-9);
  }
}

TEST(Law, TwistingAndRollingSpringsHaveTheStiffnessAndTheLimitOfTheirPatch) {
  const PairLaw law = rough_law();
  const double press = kStiffness * 1e-3, radius = 0.5, patch2 = 0.25 * radius * radius;
  State s = resting(1e-3);
  s.motion.w_mid = {0.3, 0.0, -0.1};
  for (int k = 1; k <= 400; ++k) {
    const ContactAction<double> a = act<kWhole>(law, s);
    const double t = k * s.motion.dt;
    const double roll = kStiffness * patch2 * 0.3 * t, twist = 2.0 * law.k_s * patch2 * 0.1 * t;
    EXPECT_NEAR(a.couple.x, std::min(roll, 1.05 * 0.5 * radius * press), 1e-9 * press);
    EXPECT_NEAR(a.couple.z, -std::min(twist, 1.3 * 0.5 * radius * 0.8 * press), 1e-9 * press);
    EXPECT_EQ(a.couple.y, 0.0);
  }
  EXPECT_NEAR(s.memory.roll.x * kStiffness * patch2, 1.05 * 0.5 * radius * press, 1e-9 * press);
  EXPECT_NEAR(s.memory.twist * 2.0 * law.k_s * patch2, -1.3 * 0.5 * radius * 0.8 * press, 1e-9 * press);
}

TEST(Law, CohesionPullsWithItsStrengthTimesThePatch) {
  const double cohesion = 120.0, radius = 0.5, beta = 0.5;
  const double pull = cohesion * std::pow(2.0 * beta * radius, 2);
  const PairLaw law = rough_law(cohesion);
  State s = resting(0.0);  // at the moment of parting
  EXPECT_NEAR(act<kFrictionCohesion>(law, s).force.z, pull, 1e-12 * pull);
  s = resting(pull / kStiffness);  // where spring and cohesion balance
  EXPECT_NEAR(act<kFrictionCohesion>(law, s).force.z, 0.0, 1e-12 * pull);
  s.motion.u_mid = {1.0, 0.0, 0.0};  // friction is borne by the spring that cohesion compresses
  for (int k = 0; k < 100; ++k) act<kFrictionCohesion>(law, s);
  EXPECT_NEAR(act<kFrictionCohesion>(law, s).force.x, law.friction * pull, 1e-12 * pull);
}

TEST(Law, SlipTermActsOnlyWhenAskedFor) {
  const PairLaw law = rough_law();
  State s = resting(1e-3);
  s.geometry.slip_lever = 0.4;
  s.motion.u_mid = {0.02, 0.0, 0.0};
  State without = s;
  act<kWholeSlip>(law, s);
  act<kWhole>(law, without);
  EXPECT_NEAR(s.memory.roll.y, s.motion.dt * 0.4 * 0.02, 1e-18);
  EXPECT_EQ(without.memory.roll.y, 0.0);
}

/// A loaded contact that is carried by a rigid rotation exerts the force that turns with it.
TEST(Law, RigidRotationLeavesTheSpringsAsTheyAre) {
  Random random(4, 0);
  const PairLaw law = rough_law();
  for (int round = 0; round < 5; ++round) {
    const Vec3 n0 = random.direction(), w = 2.0 * random.direction();
    State s = resting(1e-3);
    const Vec3 slide0 = 1e-4 * flat(random.direction(), n0), roll0 = 1e-4 * flat(random.direction(), n0);
    s.memory.slide = triple(slide0);
    s.memory.roll = triple(roll0);
    s.memory.twist = 1e-4;
    const int steps = 5000;
    s.motion.dt = 1e-3;
    s.motion.turn = triple(2.0 / s.motion.dt * std::tan(0.5 * s.motion.dt * w.norm()) * w.normalized());
    ContactAction<double> a{};
    for (int k = 1; k <= steps; ++k) {
      const auto at = [&](double t) { return Vec3(Eigen::AngleAxisd(w.norm() * t, w.normalized()) * n0); };
      s.geometry.n = triple(at(k * s.motion.dt));
      s.geometry.n_mid = triple(at((k - 0.5) * s.motion.dt));
      a = act<kWhole>(law, s);
    }
    const Mat3 turn = Eigen::AngleAxisd(w.norm() * steps * s.motion.dt, w.normalized()).toRotationMatrix();
    EXPECT_LT((vector(s.memory.slide) - turn * slide0).norm(), 1e-11 * slide0.norm());
    EXPECT_LT((vector(s.memory.roll) - turn * roll0).norm(), 1e-11 * roll0.norm());
    EXPECT_EQ(s.memory.twist, 1e-4);
    const Vec3 force = turn * (-kStiffness * 1e-3 * n0 + law.k_s * slide0);
    EXPECT_LT((vector(a.force) - force).norm(), 1e-11 * force.norm());
    EXPECT_EQ(a.dissipated, 0.0);
  }
}

/// Two masses on a line under the normal law alone: what motion has lost is what the ledger counts.
double unaccounted_loss(double restitution, double dt) {
  const Material m{.name = "m", .restitution_normal = restitution, .friction = 0.0};
  const PairLaw law = make_pair_law(m, m, kStiffness);
  const double mu = 10.0, speed = 0.3;
  State s = resting(0.0);
  s.memory.c_n = law.damping_n * std::sqrt(kStiffness * mu);
  s.motion.dt = dt;
  double overlap = 1e-9, closing = speed, force = 0.0, lost = 0.0;
  while (overlap > 0.0) {
    closing += 0.5 * dt * force / mu;
    overlap += dt * closing;
    s.geometry.overlap = overlap;
    s.motion.u_mid = {0.0, 0.0, -closing};
    s.motion.u = {0.0, 0.0, -(closing + 0.5 * dt * force / mu)};
    const ContactAction<double> a = act<kNormal>(law, s);
    force = a.force.z;
    closing += 0.5 * dt * force / mu;
    lost += a.dissipated;
    const double stored = stored_energy<kNormal>(LawConstants<double>(law), overlap, 0.5, s.memory);
    // In the middle of the blow, too, no energy goes missing.
    if (overlap > 0.0 && closing < 0.0)
      return 1.0 - (0.5 * mu * closing * closing + stored + lost) / (0.5 * mu * speed * speed);
  }
  return 1.0;
}

TEST(Law, WorkLedgerClosesAsTheStepShrinks) {
  const double contact = kPi * std::sqrt(10.0 / kStiffness);
  for (const double e : {0.3, 0.8}) {
    const double coarse = std::abs(unaccounted_loss(e, contact / 50)),
                 fine = std::abs(unaccounted_loss(e, contact / 800));
    EXPECT_LT(coarse, 0.05) << e;
    EXPECT_LT(fine, 0.2 * coarse) << e;
    EXPECT_LT(fine, 0.005) << e;
  }
}

/// Power that a contact takes from the motion of its partners, per step of length dt, against what it stores
/// and what it says it loses; the error over the work.
double unaccounted_work(Vec3 (*velocity)(double), Vec3 (*spin)(double), double dt) {
  const PairLaw law = rough_law();
  State s = resting(1e-3);
  s.memory.c_n = 400.0;
  s.memory.c_s = 200.0;
  s.motion.dt = dt;
  const LawConstants<double> constants(law);
  const double start = stored_energy<kWhole>(constants, 1e-3, 0.5, s.memory);
  double work = 0.0, lost = 0.0;
  for (double t = 0.5 * dt; t < 1.0; t += dt) {
    s.motion.u = s.motion.u_mid = triple(velocity(t));
    s.motion.w = s.motion.w_mid = triple(spin(t));
    const ContactAction<double> a = act<kWhole>(law, s);
    work += dt * (dot(a.force, s.motion.u) + dot(a.couple, s.motion.w));
    lost += a.dissipated;
  }
  EXPECT_GT(lost, 0.2 * work);
  return std::abs(work - lost - stored_energy<kWhole>(constants, 1e-3, 0.5, s.memory) + start) / work;
}

/// Back and forth and around, within the limits of the springs and beyond.
TEST(Law, WorkLedgerClosesForSlidingRollingAndTwisting) {
  const auto none = [](double) -> Vec3 { return Vec3::Zero(); };
  const auto around = [](double t) -> Vec3 {
    return {0.03 * std::cos(9.0 * t), 0.02 * std::sin(7.0 * t), 0.0};
  };
  const auto roll = [](double t) -> Vec3 { return {0.1 * std::cos(9.0 * t), 0.1 * std::sin(7.0 * t), 0.0}; };
  const auto twist = [](double t) -> Vec3 { return {0.0, 0.0, 0.1 * std::cos(9.0 * t)}; };
  EXPECT_LT(unaccounted_work(around, none, 1e-5), 1e-3);
  EXPECT_LT(unaccounted_work(none, roll, 1e-5), 1e-3);
  EXPECT_LT(unaccounted_work(none, twist, 1e-5), 1e-3);
}

TEST(Law, DashpotsResistTheMotionAtTheEndOfTheStep) {
  const Material sticky{.name = "sticky", .friction = 1e6};
  const PairLaw law = make_pair_law(sticky, sticky, kStiffness);
  State s = resting(1e-2);
  s.memory.c_n = 500.0;
  s.memory.c_s = 300.0;
  s.motion.u = {0.03, 0.0, 0.2};  // parts and slides
  s.motion.w = {0.05, -0.04, 0.07};
  s.geometry.slip_lever = 0.4;
  const double patch2 = std::pow(0.5 * 0.5, 2);
  State with_slip = s;
  const ContactAction<double> a = act<kWhole>(law, s), slip = act<kWholeSlip>(law, with_slip);
  const double press = kStiffness * 1e-2 - 500.0 * 0.2;
  EXPECT_LT((vector(a.force) - Vec3(300.0 * 0.03, 0.0, -press)).norm(), 1e-12 * press);
  const Vec3 couple(500.0 * patch2 * 0.05, -500.0 * patch2 * 0.04, 2.0 * 300.0 * patch2 * 0.07);
  EXPECT_LT((vector(a.couple) - couple).norm(), 1e-14);
  // Zhang et al. 2017, eq. 8: the rolling velocity gains (l_j - l_i) / (2 l_i l_j) n x u_t.
  EXPECT_LT((vector(slip.couple) - couple - 500.0 * patch2 * 0.4 * 0.03 * Vec3::UnitY()).norm(), 1e-14);
}

TEST(Mix, TakesGeometricMeansAndTheMeanShapeFactor) {
  const Material a{.name = "a", .friction = 0.5, .shape_factor = 0.2, .cohesion = 100.0},
      b{.name = "b", .friction = 2.0, .shape_factor = 0.6, .cohesion = 4.0};
  const Material m = mix(a, b);
  EXPECT_DOUBLE_EQ(m.friction, 1.0);
  EXPECT_DOUBLE_EQ(m.shape_factor, 0.4);
  EXPECT_DOUBLE_EQ(m.cohesion, 20.0);
  EXPECT_DOUBLE_EQ(m.restitution_normal, 0.55);
  const PairLaw one = make_pair_law(a, b, kStiffness), other = make_pair_law(b, a, kStiffness);
  EXPECT_EQ(one.friction, other.friction);
  EXPECT_EQ(one.cohesion, other.cohesion);
  EXPECT_EQ(one.k_s, 2.0 / 7.0 * kStiffness);
}

TEST(Mix, SpringsActInSeries) {
  const Material plain{.name = "plain"}, soft{.name = "soft", .stiffness = 2e5, .stiffness_ratio = 0.5},
      hard{.name = "hard", .stiffness = 6e5, .stiffness_ratio = 1.0},
      rigid{.name = "rigid", .stiffness = 1e20};
  const PairLaw own = make_pair_law(soft, soft, kStiffness), none = make_pair_law(plain, plain, kStiffness);
  EXPECT_EQ(own.k_n, 2e5);
  EXPECT_EQ(own.k_s, 1e5);
  EXPECT_EQ(none.k_n, kStiffness);
  EXPECT_EQ(none.k_s, 2.0 / 7.0 * kStiffness);
  const PairLaw pair = make_pair_law(soft, hard, kStiffness);
  EXPECT_DOUBLE_EQ(1.0 / pair.k_n, 0.5 / 2e5 + 0.5 / 6e5);
  EXPECT_DOUBLE_EQ(1.0 / pair.k_s, 0.5 / 1e5 + 0.5 / 6e5);
  EXPECT_EQ(make_pair_law(hard, soft, kStiffness).k_n, pair.k_n);
  EXPECT_DOUBLE_EQ(1.0 / make_pair_law(plain, hard, kStiffness).k_n, 0.5 / kStiffness + 0.5 / 6e5);
  EXPECT_NEAR(make_pair_law(soft, rigid, kStiffness).k_n, 4e5, 1e-6);
}

TEST(Mix, EveryPropertyHasItsOwnMean) {
  const Material a{.name = "a",
                   .restitution_normal = 0.9,
                   .restitution_tangential = 0.2,
                   .friction_rolling = 0.5,
                   .friction_twisting = 0.1},
      b{.name = "b",
        .restitution_normal = 0.4,
        .restitution_tangential = 0.8,
        .friction_rolling = 2.0,
        .friction_twisting = 0.9};
  const Material m = mix(a, b);
  EXPECT_DOUBLE_EQ(m.restitution_normal, 0.6);
  EXPECT_DOUBLE_EQ(m.restitution_tangential, 0.4);
  EXPECT_DOUBLE_EQ(m.friction_rolling, 1.0);
  EXPECT_DOUBLE_EQ(m.friction_twisting, 0.3);
  const PairLaw law = make_pair_law(a, b, kStiffness);
  EXPECT_DOUBLE_EQ(law.damping_n, damping_ratio(0.6));
  EXPECT_DOUBLE_EQ(law.damping_s, damping_ratio(0.4));
}

TEST(RequiredFeatures, AreThoseThatSomePairNeeds) {
  const Material smooth{.name = "s", .friction = 0.0, .friction_rolling = 0.0, .friction_twisting = 0.0};
  Material sliding = smooth, glued = smooth, nominal{.name = "n"};
  sliding.friction = 0.5;
  glued.cohesion = 1.0;
  EXPECT_EQ(required_features({smooth}, true), kNormal);
  EXPECT_EQ(required_features({sliding}, true), kFriction);
  EXPECT_EQ(required_features({glued, smooth}, false), kNormalCohesion);
  EXPECT_EQ(required_features({glued, sliding}, false), kFrictionCohesion);
  EXPECT_EQ(required_features({smooth, nominal}, false), kWhole);
  EXPECT_EQ(required_features({nominal}, true), kWholeSlip);
}

}  // namespace
}  // namespace cairn
