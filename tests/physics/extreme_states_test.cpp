// States that a random scene never has: bodies in one place, on an edge, at rest to the last bit, all but at
// rest; contacts that end and begin again.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"
#include "grid_mesh.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

TEST(ExtremeStates, BodiesOnTopOfEachOther) {
  for (const char* shape : {"sphere", "cube"}) {
    Experiment e(scene_text({.friction = 0.5}, "stiffness = 1e6", "method = 'direct'",
                            body({.shape = shape}) + body({.shape = shape})));
    try {
      e.begin();
      ADD_FAILURE() << shape;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("of bodies 0 and 1 overlap at the start by 2 of the smaller"),
                std::string::npos)
          << error.what();
    }
  }
  report::note(
      "Bodies in exactly the same place, and all that overlap at the start by more than overlap_limit, are "
      "refused; the message names the two spheres, their bodies and the overlap.");
}

/// Two slopes that meet in a straight line along y, through the origin; `rise` of z over |x|.
std::shared_ptr<const MeshSurface> fold(double rise) {
  return std::make_shared<const MeshSurface>(grid_mesh(2, [&](double u, double v) {
    const double x = 40.0 * u - 20.0;
    return Vec3(x, 40.0 * v - 20.0, rise * std::abs(x));
  }));
}

struct Resting {
  double creep, depth;
  std::size_t contacts;
};

/// A body let go on a fold of two slopes; m after 20 000 steps.
Resting rest_on(double rise, const std::string& shape, double height) {
  constexpr double g = 1.0, stiffness = 1e6;
  Experiment e(scene_text({.restitution = 0.1, .friction = 0.5, .rolling = 0.3, .twisting = 0.3},
                          fmt::format("stiffness = {}", stiffness), field({0, 0, -g}),
                          wall() + body({.shape = shape, .position = {0, 0, height}})));
  e.state.walls.walls[0].surface = fold(rise);
  e.begin();
  e.advance(10000);
  const Vec3 settled = e.state.bodies.position[0];
  e.advance(10000);
  return {(e.state.bodies.position[0] - settled).norm(), height - e.state.bodies.position[0].z(),
          e.state.walls.contacts.size()};
}

TEST(ExtremeStates, AtRestExactlyOnAnEdge) {
  const double weight = 2000.0 * 4.0 / 3.0 * kPi;
  const Resting flat = rest_on(0.0, "sphere", 1.0);
  EXPECT_EQ(flat.contacts, 1u);  // one touch, though two triangles share the edge
  report::close("a sphere on the edge between two triangles of a level floor: depth, m",
                "weight over stiffness", flat.depth, weight / 1e6, 1e-6);
  report::error("its creep in 1e4 steps, over the radius", "at rest", flat.creep, 1e-12);
  const Resting ridge = rest_on(-1.0, "sphere", 1.0);
  EXPECT_EQ(ridge.contacts, 1u);
  report::close("a sphere balanced on a ridge: depth, m", "weight over stiffness", ridge.depth, weight / 1e6,
                1e-6);
  report::error("its creep in 1e4 steps, over the radius", "balanced", ridge.creep, 1e-9);
  const Resting valley = rest_on(1.0, "sphere", std::sqrt(2.0));
  EXPECT_EQ(valley.contacts, 2u);
  report::error("a sphere in a valley of two slopes: creep in 1e4 steps, over the radius", "at rest",
                valley.creep, 1e-9);
  const Resting cube = rest_on(-0.1, "cube", 0.5 * std::sqrt(3.0) + std::sqrt(1.0 - 0.75) + 0.4);
  report::error("a cube astride a ridge: creep in 1e4 steps, over the radius", "at rest", cube.creep, 1e-9);
  EXPECT_EQ(cube.contacts, 4u);
  report::note(
      "On an edge or a corner of a mesh a sphere has one contact, whose normal points away from the nearest "
      "point; a balance that is unstable in nature lasts here until something disturbs it.");
}

TEST(ExtremeStates, NothingMovesWithoutACause) {
  // Zero gravity, zero friction, zero speed, spheres that just touch: not one bit changes.
  Experiment e(
      scene_text({.restitution = 0.5}, "stiffness = 1e6", "",
                 body({.position = {0, 0, 0}}) + body({.position = {2, 0, 0}}) +
                     body({.shape = "cube", .position = {0, 9, 0}, .orientation = {0.5, 0.5, 0.5, 0.5}})));
  e.begin();
  const Bodies before = e.state.bodies;
  e.advance(10000);
  for (std::size_t b = 0; b < before.size(); ++b) {
    EXPECT_EQ(e.state.bodies.position[b], before.position[b]);
    EXPECT_EQ(e.state.bodies.orientation[b].coeffs(), before.orientation[b].coeffs());
  }
  EXPECT_EQ(e.kinetic_energy(), 0.0);
  report::note(
      "Without gravity, friction and motion not one bit changes in 10 000 steps. Where nothing loads the "
      "contacts no stiffness can be chosen and the program asks for contact.stiffness. Friction coefficients "
      "of zero leave the springs that they limit out of the run.");
}

TEST(ExtremeStates, NumbersTooSmallForFullPrecision) {
  // Speeds, spins and springs down to the smallest denormal: squares of them vanish, quotients must not be
  // NaN.
  for (const double tiny : {1e-150, 1e-200, 1e-300, 5e-324}) {
    Experiment e(
        scene_text({.restitution = 0.5, .friction = 0.5, .rolling = 0.3, .twisting = 0.3, .cohesion = 10.0},
                   "stiffness = 1e6", "method = 'direct'",
                   wall({0, 0, 1}, {0, 0, -0.9999}) + body({}) + body({.position = {1.9999, 0, 0}}) +
                       body({.shape = "dumbbell", .position = {0, 9, 5}})));
    e.begin();
    for (std::size_t b = 0; b < 3; ++b) {
      e.state.bodies.velocity[b] = {tiny, -tiny, tiny};
      e.state.bodies.spin[b] = {tiny, tiny, -tiny};
    }
    const std::vector<ContactRecord> sprung{
        {0,
         1,
         {.c_n = 1.0, .c_s = 1.0, .slide = {0.0, tiny, -tiny}, .roll = {0.0, tiny, tiny}, .twist = tiny}}};
    e.begin(sprung);
    const double energy = mechanical_energy(e);
    e.advance(2000);
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_TRUE(e.state.bodies.position[b].allFinite()) << tiny;
      EXPECT_TRUE(e.state.bodies.velocity[b].allFinite()) << tiny;
      EXPECT_TRUE(e.state.bodies.spin[b].allFinite()) << tiny;
      EXPECT_TRUE(e.state.bodies.orientation[b].coeffs().allFinite()) << tiny;
    }
    EXPECT_TRUE(std::isfinite(e.state.ledger.dissipated));
    EXPECT_LE(std::abs(mechanical_energy(e) + e.state.ledger.dissipated - energy),
              1e-3 * std::abs(energy) + 1e-3);
  }
  report::note(
      "Speeds, spins and springs down to 5e-324 pass without a NaN; nothing is flushed to zero, and the user "
      "need do nothing.");
}

TEST(ExtremeStates, TheLastContactEndsAndAnotherBegins) {
  // The same blow three times: histories of ended contacts leave nothing behind.
  Experiment e(
      scene_text({.restitution = 0.5, .friction = 0.5, .rolling = 0.3, .twisting = 0.3, .cohesion = 10.0},
                 "stiffness = 1e6", "", body({}) + body({.shape = "tetrahedron"})));
  std::vector<Vec3> left, spun;
  const Vec3 place(2.6, 0.3, 1.5);
  const Quat attitude = Quat(0.9, 0.1, -0.3, 0.2).normalized();
  for (int blow = 0; blow < 3; ++blow) {
    Bodies& bodies = e.state.bodies;
    bodies.position = {Vec3::Zero(), place};
    bodies.remainder = {Vec3::Zero(), Vec3::Zero()};
    bodies.velocity = {Vec3::Zero(), -0.05 * place.normalized() + Vec3(0.0, 0.01, 0.0)};
    bodies.orientation = {Quat::Identity(), attitude};
    bodies.spin = {Vec3::Zero(), Vec3::Zero()};
    if (blow == 0) e.begin();
    place_spheres(bodies);
    std::size_t touched = 0;
    for (std::uint64_t k = 0; k < 20000; ++k) {
      e.advance(1);
      touched += e.touching();
    }
    ASSERT_GT(touched, 10u);
    EXPECT_FALSE(e.touching());
    EXPECT_TRUE(e.state.contacts.records().empty());
    EXPECT_EQ(e.spring_energy(), 0.0);
    left.push_back(bodies.velocity[1]);
    spun.push_back(bodies.spin[1]);
  }
  for (int blow = 1; blow < 3; ++blow)
    report::error(
        fmt::format("blow {} of the same two bodies against the first: velocity after, m/s", blow + 1),
        "the same bits", (left[blow] - left[0]).norm() + (spun[blow] - spun[0]).norm(), 0.0);
  report::note(
      "When the last contact of a scene has ended nothing of it is left: the next blow is the first one "
      "again, "
      "bit for bit. The user need do nothing.");
}

}  // namespace
}  // namespace cairn
