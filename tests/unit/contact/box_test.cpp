// Pairs across the border of a periodic box, and across cells.
#include "contact/box.h"

#include <gtest/gtest.h>

#include <cmath>

#include "body/cells.h"
#include "contact/candidates.h"
#include "contact/sweep.h"
#include "core/error.h"
#include "core/random.h"
#include "shape/library.h"

namespace cairn {
namespace {

RigidShape shape_of(const std::string& name) {
  return make_rigid(load_shape(name, "."), MassModel::union_volume);
}

/// Bodies of sizes 1 to 2 at random places, also outside of the box.
Bodies cloud(const Vec3& edge, int count, const std::string& name, std::uint64_t seed) {
  const RigidShape shape = shape_of(name);
  Bodies bodies;
  Random random(seed, 0);
  const auto anywhere = [&](double size) {
    return (size > 0.0 ? 3.0 * size : 30.0) * (random.uniform() - 0.5);
  };
  for (int b = 0; b < count; ++b)
    add_body(bodies, shape, 0, random.uniform(1.0, 2.0), 2500.0, 0,
             {.position = {anywhere(edge.x()), anywhere(edge.y()), anywhere(edge.z())},
              .orientation = random.rotation()});
  return bodies;
}

std::vector<Pair> all_images(const Bodies& bodies, const Vec3& edge, double gap) {
  const Spheres& s = bodies.spheres;
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < s.size(); ++i)
    for (std::uint32_t j = i + 1; j < s.size(); ++j) {
      if (s.body[i] == s.body[j]) continue;
      int seen = 0;
      for (int x = -4; x <= 4; ++x)
        for (int y = -4; y <= 4; ++y)
          for (int z = -4; z <= 4; ++z) {
            if ((edge.x() == 0.0 && x != 0) || (edge.y() == 0.0 && y != 0) || (edge.z() == 0.0 && z != 0))
              continue;
            const Vec3 d = s.position[j] - s.position[i] + edge.cwiseProduct(Vec3(x, y, z));
            seen += d.norm() < s.radius[i] + s.radius[j] + gap;
          }
      EXPECT_LE(seen, 1);
      if (seen > 0) pairs.push_back({i, j});
    }
  return pairs;
}

TEST(NearPairs, InABoxMatchBruteForceOverImages) {
  const double gap = 0.1;
  const double tight = 8.0 + 2.0 * gap + 1e-9;  // four largest radii and two gaps
  std::uint64_t seed = 1;
  for (const Vec3& edge : {Vec3(30, 30, 30), Vec3(9, 14, 20), Vec3(tight, tight, tight), Vec3(tight, 0, 25),
                           Vec3(0, 0, 12), Vec3(40, tight, 0)})
    for (const char* name : {"sphere", "dumbbell"}) {
      const Bodies bodies = cloud(edge, 60, name, ++seed);
      std::vector<Pair> pairs;
      NearPairs().find(bodies, {.edge = edge}, gap, pairs);
      const std::vector<Pair> expected = all_images(bodies, edge, gap);
      EXPECT_GT(expected.size(), 4u);
      EXPECT_EQ(pairs, expected) << edge.transpose() << ' ' << name;
    }
}

TEST(NearPairs, BoxInWhichASphereCouldSeeAnotherTwiceIsRefused) {
  Bodies bodies;
  const RigidShape sphere = shape_of("sphere");
  for (int b = 0; b < 2; ++b) add_body(bodies, sphere, 0, 1.0, 1.0, 0, {.position = Vec3(2.05 * b, 0, 0)});
  std::vector<Pair> pairs;
  EXPECT_THROW(NearPairs().find(bodies, {.edge = {4.2, 9.0, 9.0}}, 0.1, pairs), InputError);
  EXPECT_THROW(NearPairs().find(bodies, {.edge = {0.0, 0.0, 4.2}}, 0.1, pairs), InputError);
  NearPairs().find(bodies, {.edge = {4.21, 9.0, 0.0}}, 0.1, pairs);
  EXPECT_EQ(pairs, (std::vector<Pair>{{0, 1}}));
  EXPECT_GT(least_edge(bodies), 4.2);
}

TEST(NearPairs, AcrossCellsMatchThoseOfOneCell) {
  Bodies plain = cloud(Vec3(20, 20, 20), 200, "dumbbell", 5);
  std::vector<Pair> expected, pairs;
  NearPairs().find(plain, {}, 0.1, expected);
  for (const double far : {0.5, 1.5, 1000.5, 1e5 + 0.5}) {
    Bodies bodies = plain;
    bodies.cell_edge = cell_edge(1.0);
    displace(bodies, far * bodies.cell_edge * Vec3(1.0, -1.0, 0.0), Vec3::Zero());
    for (std::size_t b = 0; b < bodies.size(); b += 3) {  // some have gone over the border before
      if (bodies.cell.empty()) bodies.cell.assign(bodies.size(), Vec3::Zero());
      bodies.position[b].x() -= bodies.cell_edge;
      bodies.cell[b].x() += 1.0;
    }
    place_spheres(bodies);
    NearPairs().find(bodies, {}, 0.1, pairs);
    EXPECT_EQ(pairs, expected) << far;
  }
}

/// Two rough dumbbells that overlap and move; wrenches and springs after one sweep.
struct Touch {
  std::vector<Vec3> force, torque;
  std::vector<ContactRecord> records;
  double energy;

  explicit Touch(Bodies bodies, const Box& box = {}) {
    const double dt = 1e-3;
    place_spheres(bodies);
    std::vector<Vec3> spin_mid;
    for (std::size_t b = 0; b < bodies.size(); ++b) spin_mid.push_back(angular_velocity(bodies, b));
    std::vector<SphereMotion> motions;
    compute_motions(bodies, spin_mid, dt, motions, box.rate);
    SweepSettings settings;
    settings.dt = dt;
    settings.features = kWhole;
    settings.laws = {make_pair_law({}, {}, 1e7)};
    settings.material.assign(bodies.size(), 0);
    ContactList contacts;
    Candidates().rebuild(bodies, {}, settings.features, contacts, box);
    sweep(motions, settings, contacts, bodies);
    force = bodies.force;
    torque = bodies.torque;
    records = contacts.records();
    energy = stored_energy(bodies, settings, contacts);
  }
};

/// Places are whole multiples of 2^-20 m, so that whole boxes and cells are added without rounding.
Bodies two_dumbbells() {
  const auto on_grid = [](const Vec3& x) -> Vec3 { return (x * 0x1p20).array().round().matrix() * 0x1p-20; };
  const RigidShape shape = shape_of("dumbbell");
  Bodies bodies;
  add_body(bodies, shape, 0, 1.0, 2500.0, 0,
           {.position = on_grid({0.3, 0.2, 0.1}),
            .orientation = Quat(0.9, 0.1, 0.3, 0.2).normalized(),
            .velocity = {0.1, -0.2, 0.05},
            .angular_velocity = {0.3, 0.2, 0.1}});
  add_body(bodies, shape, 0, 1.0, 2500.0, 0,
           {.position = on_grid({2.0, 1.1, 0.4}),
            .orientation = Quat(0.4, 0.5, -0.3, 0.6).normalized(),
            .velocity = {-0.1, 0.1, 0.0},
            .angular_velocity = {0.0, -0.5, 0.4}});
  return bodies;
}

void expect_same(const Touch& a, const Touch& b, double tolerance) {
  ASSERT_GT(a.records.size(), 0u);
  ASSERT_EQ(a.records.size(), b.records.size());
  const double force = a.force[0].norm();
  EXPECT_GT(force, 0.0);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_LE((a.force[k] - b.force[k]).norm(), tolerance * force);
    EXPECT_LE((a.torque[k] - b.torque[k]).norm(), tolerance * force);
  }
  for (std::size_t k = 0; k < a.records.size(); ++k) {
    EXPECT_NEAR(a.records[k].memory.slide.x, b.records[k].memory.slide.x, tolerance);
    EXPECT_NEAR(a.records[k].memory.c_n, b.records[k].memory.c_n, tolerance * a.records[k].memory.c_n);
  }
  EXPECT_NEAR(a.energy, b.energy, tolerance * a.energy);
}

TEST(Shift, PairAcrossTheBorderOfABoxFeelsWhatItFeelsInside) {
  const Touch inside(two_dumbbells());
  const Box box{.edge = {16.0, 0.0, 32.0}};
  expect_same(inside, Touch(two_dumbbells(), box), 0.0);
  for (const Vec3& steps : {Vec3(1, 0, 0), Vec3(-1, 0, 2), Vec3(5, 0, -7)}) {
    Bodies bodies = two_dumbbells();
    bodies.position[1] += box.edge.cwiseProduct(steps);
    expect_same(inside, Touch(bodies, box), 1e-13);
  }
}

TEST(Shift, PairAcrossCellsFeelsWhatItFeelsInOne) {
  const Touch inside(two_dumbbells());
  for (const double cells : {0.0, 1.0, 3e5}) {
    Bodies bodies = two_dumbbells();
    bodies.cell_edge = cell_edge(1.0);
    bodies.cell = {cells * Vec3(1, -1, 1), cells * Vec3(1, -1, 1)};
    bodies.cell[1] += Vec3(1, 0, -1);
    bodies.position[1] -= bodies.cell_edge * Vec3(1, 0, -1);
    expect_same(inside, Touch(bodies), 1e-10);
  }
}

// Images move with the box: the pair approaches as fast as its own places say.
TEST(Shift, ImagesMoveWithAStrainedBox) {
  const Box box{.edge = {16.0, 16.0, 16.0}, .rate = {-0.01, -0.02, 0.005}};
  const Touch inside(two_dumbbells(), box);
  const Touch resting(two_dumbbells(), {.edge = box.edge});
  EXPECT_GT((inside.force[0] - resting.force[0]).norm(), 1e-4 * inside.force[0].norm());
  Bodies bodies = two_dumbbells();
  bodies.position[1] += box.edge.cwiseProduct(Vec3(-3, 2, 1));
  expect_same(inside, Touch(bodies, box), 1e-12);
}

TEST(Strain, EdgesAreAnExactFunctionOfTime) {
  const Strain strain{.start = {2.0, 3.0, 0.0}, .rate = {-0.1, 0.2, 0.0}, .until = 4.0};
  EXPECT_EQ(strain.edge(0.0), Vec3(2.0, 3.0, 0.0));
  const Vec3 expected(2.0 * std::exp(3.0 * -0.1), 3.0 * std::exp(3.0 * 0.2), 0.0);
  EXPECT_LT((strain.edge(3.0) - expected).norm(), 1e-15 * expected.norm());
  EXPECT_EQ(strain.edge(9.0), strain.edge(4.0));
  EXPECT_TRUE(strain.acts(3.9));
  EXPECT_FALSE(strain.acts(4.0));
  EXPECT_FALSE(Strain{}.acts(0.0));
}

// No pair comes to touch unseen while a list lives, however the box is strained.
TEST(Candidates, InAStrainedBoxHoldEveryTouchingPairUntilTheyExpire) {
  Bodies bodies = cloud(Vec3(24, 24, 24), 150, "sphere", 9);
  Box box{.edge = {24, 24, 24}};
  Candidates candidates;
  ContactList contacts;
  candidates.rebuild(bodies, {}, kNormal, contacts, box);
  int lived = 0;
  for (; lived < 100; ++lived) {
    box.edge *= 0.9995;
    for (Vec3& x : bodies.position) x *= 0.9995;
    place_spheres(bodies);
    if (candidates.expired(bodies, 0.0, contacts, box)) break;
    for (const Pair& p : all_images(bodies, box.edge, 0.0)) {
      bool listed = false;
      for (std::size_t slot = 0; slot < contacts.slots(); ++slot)
        listed |=
            contacts.pair(slot) == p && contacts.moved[p.i] + contacts.moved[p.j] >= -contacts.c_n[slot];
      ASSERT_TRUE(listed);
    }
  }
  EXPECT_GT(lived, 10);  // the strain itself is no displacement
  EXPECT_LT(lived, 100);
}

}  // namespace
}  // namespace cairn
