#include "contact/stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "contact/law/pair.h"
#include "core/random.h"
#include "shape/library.h"

namespace cairn {
namespace {

constexpr double kStiffness = 1e6;

/// That of bodies of one material, and walls of it.
ShortestContact shortest_contact(const Bodies& bodies, double k_n, double beta, bool rolling, bool walls) {
  const Material material{.name = "m", .shape_factor = beta};
  const std::vector<std::uint16_t> of(bodies.size(), 0);
  const PairLaw law = make_pair_law(material, material, k_n);
  return cairn::shortest_contact(bodies, {.materials = 1,
                                          .material = of,
                                          .bodies = {&law, 1},
                                          .walls = {&law, walls ? 1u : 0u},
                                          .rolling = rolling});
}

/// `sizes` bodies of each of the shapes, at the origin.
Bodies collection(const std::vector<std::string>& names, const std::vector<double>& sizes) {
  Bodies bodies;
  std::uint32_t index = 0;
  for (const std::string& name : names) {
    const RigidShape shape = make_rigid(load_shape(name, "."), MassModel::union_volume);
    for (double size : sizes) add_body(bodies, shape, index, size, 2500.0, 0, {});
    ++index;
  }
  return bodies;
}

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

double greatest(const Mat3& m) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(m, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

/// One side of a random contact: a sphere of a body and the direction in which it is touched.
struct Side {
  double inverse_mass, radius;
  Mat3 inverse_inertia, mobility;
};

Side touch(const Bodies& bodies, std::uint32_t s, const Vec3& n, const Quat& attitude) {
  const std::uint32_t b = bodies.spheres.body[s];
  const Mat3 axes = attitude.toRotationMatrix();
  const Mat3 inverse = axes * bodies.inertia[b].cwiseInverse().asDiagonal() * axes.transpose();
  const Mat3 arm = cross_matrix(axes * bodies.spheres.offset[s] + bodies.spheres.radius[s] * n);
  return {1.0 / bodies.mass[b], bodies.spheres.radius[s], inverse,
          Mat3::Identity() / bodies.mass[b] + arm * inverse * arm.transpose()};
}

/// Squared frequency of the fastest mode of spring number `kind` at this contact.
double fastest_mode(const Side& a, const Side& b, const Vec3& n, double radius, double beta, int kind) {
  const double k_s = kTangentialRatio * kStiffness, patch2 = std::pow(beta * radius, 2);
  const Mat3 plane = Mat3::Identity() - n * n.transpose();
  const Mat3 mobility = a.mobility + b.mobility, turning = a.inverse_inertia + b.inverse_inertia;
  switch (kind) {
    case 0:
      return kStiffness * n.dot(mobility * n);
    case 1:
      return k_s * greatest(plane * mobility * plane);
    case 2:
      return kStiffness * patch2 * greatest(plane * turning * plane);
    default:
      return 2.0 * k_s * patch2 * n.dot(turning * n);
  }
}

TEST(ShortestContact, OfLooseSpheresIsHalfAPeriodOfTheirReducedMass) {
  const Bodies bodies = collection({"sphere"}, {2.0});
  const double m = bodies.mass[0];
  EXPECT_NEAR(
      shortest_contact(bodies, kStiffness, 0.5, false, false).time / (kPi * std::sqrt(0.5 * m / kStiffness)),
      1.0, 1e-3);
  // The lightest pair counts: of three, there is only one of the lightest.
  const Bodies mixed = collection({"sphere"}, {2.0, 1.0, 5.0});
  const double mu = mixed.mass[0] * mixed.mass[1] / (mixed.mass[0] + mixed.mass[1]);
  const ShortestContact found = shortest_contact(mixed, kStiffness, 0.5, false, false);
  EXPECT_NEAR(found.time / (kPi * std::sqrt(mu / kStiffness)), 1.0, 1e-3);
  EXPECT_EQ(found.encounter.body, 1u);
  EXPECT_EQ(found.encounter.other, 0u);
}

// A ball of a tenth of unit inertia has 1 + 1 / 0.1 times the mobility of its mass in the plane.
TEST(ShortestContact, OfABodyThatTurnsEasilyIsTangential) {
  const RigidShape light{.name = "light",
                         .volume = 1.0,
                         .inertia = {0.1, 0.1, 0.1},
                         .offsets = {Vec3::Zero()},
                         .radii = {1.0},
                         .mass_fractions = {1.0}};
  Bodies bodies;
  add_body(bodies, light, 0, 1.0, 1000.0, 0, {});
  EXPECT_NEAR(shortest_contact(bodies, kStiffness, 0.5, false, false).time /
                  (kPi / std::sqrt(2.0 * 2.0 / 7.0 * kStiffness * 11.0 / 1000.0)),
              1.0, 1e-12);
}

TEST(ShortestContact, ScalesWithStiffnessAndMass) {
  const Bodies bodies = collection({"rod4"}, {1.0}), large = collection({"rod4"}, {2.0});
  const double t = shortest_contact(bodies, kStiffness, 0.5, true, true).time;
  EXPECT_NEAR(shortest_contact(bodies, 4.0 * kStiffness, 0.5, true, true).time, 0.5 * t, 1e-12 * t);
  EXPECT_NEAR(shortest_contact(large, kStiffness, 0.5, true, true).time, std::sqrt(8.0) * t, 1e-9 * t);
}

// A hard heavy ball among soft light ones: there is no pair of two hard ones, and light ones are not hard.
TEST(ShortestContact, CountsOnlyPairsOfMaterialsThatThereAre) {
  Bodies bodies = collection({"sphere"}, {3.0, 1.0, 0.5});
  const Material soft{.name = "soft", .stiffness = 1e6},
      hard{.name = "hard", .stiffness = 1e12, .stiffness_ratio = 1.0},
      idle{.name = "idle", .stiffness = 1e15};
  std::vector<PairLaw> laws, walls;
  for (const Material& a : {soft, hard, idle}) {
    for (const Material& b : {soft, hard, idle}) laws.push_back(make_pair_law(a, b, kStiffness));
    walls.push_back(make_pair_law(a, soft, kStiffness));
  }
  const std::vector<std::uint16_t> material{1, 0, 0};
  ContactLaws all{.materials = 3, .material = material, .bodies = laws, .walls = {}, .rolling = false};
  const auto time = [](double k, double mobility) { return kPi / std::sqrt(k * mobility); };
  const double light = 1.0 / bodies.mass[2], middle = 1.0 / bodies.mass[1], heavy = 1.0 / bodies.mass[0];
  // Of the springs in series of soft and hard balls, twice the soft one; sliding of 4/7 + ... is slower.
  const ShortestContact found = cairn::shortest_contact(bodies, all);
  const double k_s = 2.0 / (1.0 / (2.0 / 7.0 * 1e6) + 1.0 / 1e12);
  EXPECT_NEAR(found.time / std::min(time(2e6, light + heavy), time(k_s, 3.5 * (light + heavy))), 1.0, 2e-3);
  EXPECT_EQ(found.encounter.body + found.encounter.other.value_or(9), 2u);
  EXPECT_GT(time(1e6, light + middle), found.time);
  all.walls = walls;
  EXPECT_NEAR(cairn::shortest_contact(bodies, all).time / found.time, 1.0, 1e-12);
}

// A held ball of a hard material is met by light soft ones; it gives way to none.
TEST(ShortestContact, IsThatWithAHeldBodyOfAHardMaterial) {
  Bodies bodies = collection({"sphere"}, {1.0, 2.0, 2.0});
  bodies.held = {0, 0, 1};
  const Material soft{.name = "soft", .stiffness = 1e6, .stiffness_ratio = 0.1},
      hard{.name = "hard", .stiffness = 1e12, .stiffness_ratio = 0.1};
  std::vector<PairLaw> laws;
  for (const Material& a : {soft, hard})
    for (const Material& b : {soft, hard}) laws.push_back(make_pair_law(a, b, kStiffness));
  const std::vector<std::uint16_t> material{0, 0, 1};
  const ShortestContact found =
      cairn::shortest_contact(bodies, {.materials = 2, .material = material, .bodies = laws, .walls = {}});
  EXPECT_NEAR(found.time / (kPi / std::sqrt(2e6 / bodies.mass[0])), 1.0, 2e-3);
  EXPECT_EQ(found.mode, ShortestContact::Mode::normal);
  EXPECT_EQ(found.encounter.body, 0u);
  EXPECT_EQ(found.encounter.other, 2u);
}

/// No contact found by a random search has a mode faster than the bound, and some come close.
void expect_bound(const Bodies& bodies, double beta, bool walls, double reach) {
  const double bound = std::pow(kPi / shortest_contact(bodies, kStiffness, beta, true, walls).time, 2);
  Random random(1, 0);
  const auto sphere = [&] {
    return static_cast<std::uint32_t>(random.uniform() * static_cast<double>(bodies.spheres.size()));
  };
  double found = 0.0;
  int worst = -1;
  for (int k = 0; k < 40'000; ++k) {
    const Vec3 n = random.direction();
    const std::uint32_t i = sphere(), j = sphere();
    const bool meet =
        bodies.size() == 1 || bodies.spheres.body[i] != bodies.spheres.body[j];  // one: with its like
    const Side a = touch(bodies, i, n, random.rotation()), b = touch(bodies, j, -n, random.rotation());
    const Side wall{0.0, 1e300, Mat3::Zero(), Mat3::Zero()};
    for (int kind = 0; kind < 4; ++kind) {
      const double pair =
          meet ? fastest_mode(a, b, n, a.radius * b.radius / (a.radius + b.radius), beta, kind) : 0.0;
      const double mode = walls ? std::max(pair, fastest_mode(a, wall, n, a.radius, beta, kind)) : pair;
      if (mode > found) {
        found = mode;
        worst = kind;
      }
    }
  }
  EXPECT_LE(found, bound * (1.0 + 1e-3)) << "spring " << worst;
  EXPECT_GE(found, reach * bound) << "spring " << worst;
}

TEST(ShortestContact, NoContactOfAnyTwoBodiesIsFaster) {
  for (const char* name : {"dumbbell", "rod4", "diamond", "tetrahedron", "cube", "l_shape", "needle"}) {
    SCOPED_TRACE(name);
    expect_bound(collection({name}, {1.0}), 0.5, false, 0.7);
  }
  expect_bound(collection({"sphere", "rod4", "diamond", "cube"}, {1.0, 1.5, 2.0}), 0.5, false, 0.3);
}

TEST(ShortestContact, NoContactWithALargePatchIsFaster) {
  for (const char* name : {"sphere", "rod4", "needle", "cube"}) {
    SCOPED_TRACE(name);
    expect_bound(collection({name}, {1.0}), 1.5, false, 0.5);
    expect_bound(collection({name}, {1.0}), 1.5, true, 0.5);
  }
  expect_bound(collection({"sphere", "needle"}, {1.0, 3.0}), 1.5, false, 0.1);
  expect_bound(collection({"sphere", "needle"}, {1.0, 3.0}), 1.5, true, 0.1);
}

TEST(Stiffness, KeepsABlowUnderTheOverlapAskedFor) {
  const Bodies bodies = collection({"cube", "sphere"}, {1.0, 1.0});
  const double speed = 0.4;
  const StiffnessChoice chosen = choose_stiffness(bodies, {.max_overlap = 0.01, .impact_speed = speed});
  const double heaviest = *std::max_element(bodies.mass.begin(), bodies.mass.end());
  const double radius = *std::min_element(bodies.spheres.radius.begin(), bodies.spheres.radius.end());
  const double overlap =
      speed * std::sqrt(0.5 * heaviest / chosen.k_n);  // elastic blow of two of the heaviest
  EXPECT_LE(overlap, 0.01 * radius);
  EXPECT_GE(overlap, 0.005 * radius);
  EXPECT_EQ(chosen.cause, StiffnessChoice::Cause::impact);
  EXPECT_EQ(choose_stiffness(bodies, {}).k_n, 0.0);
  EXPECT_DOUBLE_EQ(choose_stiffness(bodies, {.max_overlap = 0.01, .impact_speed = 2.0 * speed}).k_n,
                   4.0 * chosen.k_n);
}

/// The greatest k of any pair, by trying all.
double stiffness_of_all_pairs(const Bodies& bodies, double aim, double speed, double cohesion) {
  double k = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double a = bodies.length[i], b = bodies.length[j], least = std::min(a, b),
                   radius = a * b / (a + b);
      k = std::max({k, std::min(bodies.mass[i], bodies.mass[j]) * std::pow(speed / (aim * least), 2),
                    cohesion * radius * radius / (aim * least)});
    }
  return k;
}

TEST(Stiffness, OfManySizesIsTheGreatestOfAllPairsThatCanMeet) {
  Random random(3, 0);
  for (int trial = 0; trial < 200; ++trial) {
    Bodies bodies;
    const RigidShape sphere = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
    const int count = 2 + static_cast<int>(8.0 * random.uniform());
    for (int k = 0; k < count; ++k)
      add_body(bodies, sphere, 0, std::exp(6.0 * random.uniform()), 1000.0 * std::exp(4.0 * random.uniform()),
               0, {});
    const ContactDemand blow{.max_overlap = 0.02, .impact_speed = 0.7};
    EXPECT_NEAR(choose_stiffness(bodies, blow).k_n / stiffness_of_all_pairs(bodies, 0.02, 0.7, 0.0), 1.0,
                1e-12);
    const ContactDemand glue{.max_overlap = 0.02, .cohesion = 40.0};
    EXPECT_NEAR(choose_stiffness(bodies, glue).k_n / stiffness_of_all_pairs(bodies, 0.02, 0.0, 40.0), 1.0,
                1e-12);
    EXPECT_NEAR(greatest_pull(bodies, glue) / stiffness_of_all_pairs(bodies, 1.0, 0.0, 40.0), 1.0, 1e-12);
  }
}

// A boulder of half a metre falls on a monolith of 400 m: its effective mass is the boulder's. The heaviest
// mass over the smallest radius would be 5e8 times as much.
TEST(Stiffness, OfABoulderOnAMonolithIsTheBoulders) {
  const Bodies bodies = collection({"sphere"}, {400.0, 0.5});
  const double speed = escape_speed(bodies);
  EXPECT_NEAR(speed / std::sqrt(2.0 * kGravitationalConstant * bodies.mass[0] / 400.0), 1.0, 1e-12);
  const StiffnessChoice chosen = choose_stiffness(
      bodies, {.max_overlap = 0.01, .impact_speed = speed, .self_gravity = true, .cohesion = 100.0});
  const double mu = bodies.mass[0] * bodies.mass[1] / (bodies.mass[0] + bodies.mass[1]);
  EXPECT_NEAR(chosen.k_n / (mu * std::pow(speed / (0.01 * 0.5), 2)), 1.0, 1e-6);
  EXPECT_EQ(chosen.cause, StiffnessChoice::Cause::impact);
  EXPECT_EQ(chosen.sphere, 1u);
  EXPECT_EQ(chosen.encounter.body, 1u);
  EXPECT_EQ(chosen.encounter.other, 0u);
  // On a wall the monolith asks for more.
  const StiffnessChoice on_wall =
      choose_stiffness(bodies, {.max_overlap = 0.01, .impact_speed = speed, .walls = true});
  EXPECT_NEAR(on_wall.k_n / (bodies.mass[0] * std::pow(speed / (0.01 * 400.0), 2)), 1.0, 1e-12);
  EXPECT_FALSE(on_wall.encounter.other.has_value());
}

TEST(Stiffness, BearsCohesionPressureAndColumns) {
  const Bodies bodies = collection({"sphere"}, std::vector<double>(1000, 2.0));
  const double mass = bodies.mass[0], aim = 0.02;
  // c (2 beta R)^2, R = 1 m between two balls of 2 m, 2 m on a wall.
  const double pull = 300.0 * std::pow(2.0 * 0.4, 2);
  EXPECT_NEAR(choose_stiffness(bodies, {.max_overlap = 0.01, .cohesion = pull}).k_n * aim, pull, 1e-9);
  EXPECT_NEAR(choose_stiffness(bodies, {.max_overlap = 0.01, .wall_cohesion = pull, .walls = true}).k_n * aim,
              4.0 * pull, 1e-9);
  // Ten bodies above each other, eight times the mean load.
  EXPECT_NEAR(
      choose_stiffness(bodies, {.max_overlap = 0.01, .field = 1e-3}).k_n * aim / (8.0 * 1e-3 * mass * 10.0),
      1.0, 1e-12);
  // Pressure at the centre of a ball of the pile's mass: 3 G M^2 / (8 pi R^4).
  const double radius = 2.0 * std::cbrt(1000.0 / 0.6);
  const double pressure =
      3.0 * kGravitationalConstant * std::pow(1000.0 * mass, 2) / (8.0 * kPi * std::pow(radius, 4));
  EXPECT_NEAR(choose_stiffness(bodies, {.max_overlap = 0.01, .self_gravity = true}).k_n * aim /
                  (8.0 * pressure * kPi * 4.0),
              1.0, 1e-9);
}

// A sphere bears the pressure times its own area, over its own radius: the largest asks for most.
TEST(Stiffness, OfALoadGrowsWithTheLargestSphereNotWithTheRatioOfSizes) {
  std::vector<double> sizes(1000, 1.0);
  sizes[10] = sizes[20] = 8.0;
  const Bodies bodies = collection({"sphere"}, sizes);
  const StiffnessChoice chosen = choose_stiffness(bodies, {.max_overlap = 0.01, .field = 1e-3});
  double mass = 0.0, cubes = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    mass += bodies.mass[b];
    cubes += std::pow(bodies.length[b], 3);
  }
  const double column = 8.0 * 1e-3 * mass / std::pow(cubes, 2.0 / 3.0);  // N/m^2
  EXPECT_NEAR(chosen.k_n / (column * 8.0 / 0.01), 1.0, 1e-12);
  EXPECT_EQ(chosen.encounter.body, 10u);
  EXPECT_EQ(chosen.encounter.other, 20u);
}

TEST(Stiffness, EscapeSpeedIsThatOfTheBallTheBodiesWouldMake) {
  const Bodies bodies = collection({"sphere"}, std::vector<double>(100, 3.0));
  const double mass = 100.0 * bodies.mass[0], radius = 3.0 * std::cbrt(100.0 / 0.6);
  EXPECT_NEAR(escape_speed(bodies) / std::sqrt(2.0 * kGravitationalConstant * mass / radius), 1.0, 1e-12);
}

TEST(Stiffness, BearsTheLoadOnAWall) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  Bodies bodies;
  add_body(bodies, ball, 0, 2.0, 1000.0, 0, {});
  const ContactDemand demand{.max_overlap = 0.02, .walls = true, .wall_load = 300.0};
  EXPECT_NEAR(choose_stiffness(bodies, demand).k_n, 300.0 / (0.02 * bodies.spheres.radius[0]), 1e-6);
  for (int b = 1; b < 1000; ++b) add_body(bodies, ball, 0, 2.0, 1000.0, 0, {.position = Vec3(9.0 * b, 0, 0)});
  EXPECT_NEAR(choose_stiffness(bodies, demand).k_n, 8.0 / 100.0 * 300.0 / (0.02 * bodies.spheres.radius[0]),
              1e-6);
}

TEST(Stiffness, TakesUpTheFallOfAWall) {
  const RigidShape ball = make_rigid(load_shape("sphere", "."), MassModel::union_volume);
  Bodies bodies;
  add_body(bodies, ball, 0, 2.0, 1000.0, 0, {});
  const double energy = 700.0, aim = 0.02 * bodies.spheres.radius[0], mass = bodies.mass[0];
  ContactDemand demand{.max_overlap = 0.02, .walls = true, .wall_fall = energy, .wall_mass = 1e9 * mass};
  const StiffnessChoice alone = choose_stiffness(bodies, demand);
  EXPECT_NEAR(alone.k_n, 2.0 * energy / (aim * aim), 1e-9 * alone.k_n);
  EXPECT_EQ(alone.cause, StiffnessChoice::Cause::wall_fall);
  for (int b = 1; b < 1000; ++b) add_body(bodies, ball, 0, 2.0, 1000.0, 0, {.position = Vec3(9.0 * b, 0, 0)});
  EXPECT_NEAR(choose_stiffness(bodies, demand).k_n, 8.0 / 100.0 * alone.k_n, 1e-9 * alone.k_n);
  // A ball half as heavy as the wall is thrown by half of its energy, wherever the rest of it goes.
  demand.wall_mass = 2.0 * mass;
  EXPECT_NEAR(choose_stiffness(bodies, demand).k_n, 0.5 * alone.k_n, 1e-9 * alone.k_n);
}

}  // namespace
}  // namespace cairn
