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
      shortest_contact_time(bodies, kStiffness, 0.5, false, false) / (kPi * std::sqrt(0.5 * m / kStiffness)),
      1.0, 1e-3);
  // The lightest pair counts.
  const Bodies mixed = collection({"sphere"}, {2.0, 1.0, 5.0});
  EXPECT_NEAR(shortest_contact_time(mixed, kStiffness, 0.5, false, false) /
                  (kPi * std::sqrt(0.5 * mixed.mass[1] / kStiffness)),
              1.0, 1e-3);
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
  EXPECT_NEAR(shortest_contact_time(bodies, kStiffness, 0.5, false, false) /
                  (kPi / std::sqrt(2.0 * 2.0 / 7.0 * kStiffness * 11.0 / 1000.0)),
              1.0, 1e-12);
}

TEST(ShortestContact, ScalesWithStiffnessAndMass) {
  const Bodies bodies = collection({"rod4"}, {1.0}), large = collection({"rod4"}, {2.0});
  const double t = shortest_contact_time(bodies, kStiffness, 0.5, true, true);
  EXPECT_NEAR(shortest_contact_time(bodies, 4.0 * kStiffness, 0.5, true, true), 0.5 * t, 1e-12 * t);
  EXPECT_NEAR(shortest_contact_time(large, kStiffness, 0.5, true, true), std::sqrt(8.0) * t, 1e-9 * t);
}

/// No contact found by a random search has a mode faster than the bound, and some come close.
void expect_bound(const Bodies& bodies, double beta, bool walls, double reach) {
  const double bound = std::pow(kPi / shortest_contact_time(bodies, kStiffness, beta, true, walls), 2);
  Random random(1, 0);
  const auto sphere = [&] {
    return static_cast<std::uint32_t>(random.uniform() * static_cast<double>(bodies.spheres.size()));
  };
  double found = 0.0;
  int worst = -1;
  for (int k = 0; k < 40'000; ++k) {
    const Vec3 n = random.direction();
    const Side a = touch(bodies, sphere(), n, random.rotation()),
               b = touch(bodies, sphere(), -n, random.rotation());
    const Side wall{0.0, 1e300, Mat3::Zero(), Mat3::Zero()};
    for (int kind = 0; kind < 4; ++kind) {
      const double pair = fastest_mode(a, b, n, a.radius * b.radius / (a.radius + b.radius), beta, kind);
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
  const Bodies bodies = collection({"cube", "sphere"}, {1.0});
  const double speed = 0.4;
  const double k = choose_stiffness(bodies, {.max_overlap = 0.01, .impact_speed = speed});
  const double heaviest = *std::max_element(bodies.mass.begin(), bodies.mass.end());
  const double overlap = speed * std::sqrt(0.5 * heaviest / k);  // elastic blow of two of the heaviest
  EXPECT_LE(overlap, 0.01);
  EXPECT_GE(overlap, 0.005);
  EXPECT_EQ(choose_stiffness(bodies, {}), 0.0);
  EXPECT_DOUBLE_EQ(choose_stiffness(bodies, {.max_overlap = 0.01, .impact_speed = 2.0 * speed}), 4.0 * k);
}

TEST(Stiffness, BearsCohesionPressureAndColumns) {
  const Bodies bodies = collection({"sphere"}, std::vector<double>(1000, 2.0));
  const double mass = bodies.mass[0], aim = 0.02;
  EXPECT_NEAR(choose_stiffness(bodies, {.max_overlap = 0.01, .cohesion = 300.0, .shape_factor = 0.4}) * aim,
              300.0 * std::pow(0.4 * 2.0, 2), 1e-9);
  // Ten bodies above each other, eight times the mean load.
  EXPECT_NEAR(
      choose_stiffness(bodies, {.max_overlap = 0.01, .field = 1e-3}) * aim / (8.0 * 1e-3 * mass * 10.0), 1.0,
      1e-12);
  // Pressure at the centre of a ball of the pile's mass: 3 G M^2 / (8 pi R^4).
  const double radius = 2.0 * std::cbrt(1000.0 / 0.6);
  const double pressure =
      3.0 * kGravitationalConstant * std::pow(1000.0 * mass, 2) / (8.0 * kPi * std::pow(radius, 4));
  EXPECT_NEAR(choose_stiffness(bodies, {.max_overlap = 0.01, .self_gravity = true}) * aim /
                  (8.0 * pressure * kPi * 4.0),
              1.0, 1e-9);
}

TEST(Stiffness, EscapeSpeedIsThatOfTheBallTheBodiesWouldMake) {
  const Bodies bodies = collection({"sphere"}, std::vector<double>(100, 3.0));
  const double mass = 100.0 * bodies.mass[0], radius = 3.0 * std::cbrt(100.0 / 0.6);
  EXPECT_NEAR(escape_speed(bodies) / std::sqrt(2.0 * kGravitationalConstant * mass / radius), 1.0, 1e-12);
}

}  // namespace
}  // namespace cairn
