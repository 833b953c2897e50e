#include "pile/operate.h"

#include <gtest/gtest.h>

#include "analysis/budget.h"
#include "analysis/coordination.h"
#include "core/error.h"
#include "pile/assemble.h"

namespace cairn {
namespace {

constexpr const char* kScene = R"(
[[lattice]]
kind = "sc"
shape = "dumbbell"
size = 1
density = 2000
spacing = 4.0
material = "rock"
random_orientation = true
[lattice.region]
kind = "box"
size = [39, 39, 39]
position = [7, 8, 9]
[[material]]
name = "rock"
[[material]]
name = "ice"
[[stage]]
name = "do"
)";

struct Pile {
  Scene scene;
  State state;
  std::vector<ContactRecord> contacts;

  explicit Pile(const std::string& operation) : scene(parse_scene(kScene + operation, "do.toml", ".")) {
    Setup setup = assemble(scene);
    state.bodies = std::move(setup.bodies);
    for (std::size_t b = 0; b < state.bodies.size(); ++b) {
      state.bodies.velocity[b] = Vec3(1.0, 0.1 * static_cast<double>(b), 0.0);
      state.bodies.spin[b] = 1e-3 * state.bodies.inertia[b];
    }
    for (std::uint32_t s = 1; s + 1 < state.bodies.spheres.size(); s += 2)  // of one body and the next
      contacts.push_back(
          {s, s + 1, {.c_n = 1.0 * s, .c_s = 0.0, .slide = {1.0, 2.0, 3.0}, .roll = {}, .twist = 0.0}});
  }
  std::string operate() { return cairn::operate(scene, 0, state, contacts); }
};

TEST(Operate, CarvingKeepsBodiesAndContactsOfTheRegion) {
  const std::string kBall = "[stage.carve]\nregion = { kind = 'ball', radius = 10, position = [2, 0, 0] }\n";
  Pile pile(kBall), whole(kBall + "whole = true\n"), rest(kBall + "outside = true\n");
  const Bodies before = pile.state.bodies;
  const Vec3 middle = budget(before).center + Vec3(2.0, 0.0, 0.0);
  std::size_t inside = 0, contained = 0;
  for (std::size_t b = 0; b < before.size(); ++b) {
    inside += (before.position[b] - middle).norm() < 10.0;
    bool all = true;
    for (std::uint32_t s = before.first_sphere[b]; s < before.first_sphere[b + 1]; ++s)
      all = all && (before.spheres.position[s] - middle).norm() + before.spheres.radius[s] <= 10.0;
    contained += all;
  }
  pile.operate();
  whole.operate();
  rest.operate();
  const Bodies& bodies = pile.state.bodies;
  EXPECT_EQ(bodies.size(), inside);
  EXPECT_EQ(whole.state.bodies.size(), contained);
  EXPECT_LT(contained, inside);
  EXPECT_EQ(rest.state.bodies.size(), before.size() - inside);
  EXPECT_NEAR(pile.state.region_volume, 4000.0 / 3.0 * kPi, 1e-9);
  EXPECT_EQ(rest.state.region_volume, 0.0);
  // The contacts that are left join the last sphere of a body with the first of the one that came next.
  ASSERT_GT(pile.contacts.size(), 5u);
  for (const ContactRecord& c : pile.contacts) {
    ASSERT_EQ(c.j, c.i + 1);
    EXPECT_EQ(bodies.spheres.body[c.j], bodies.spheres.body[c.i] + 1);
    const double former = 0.5 * (c.memory.c_n - 1.0);  // number of the body before
    EXPECT_NEAR(bodies.velocity[bodies.spheres.body[c.i]].y(), 0.1 * former, 1e-9);
  }
}

TEST(Operate, ScalingByMassKeepsPlacesAndMotion) {
  Pile pile("scale = { density = 500, volume = 2e4 }\n");
  const Bodies before = pile.state.bodies;
  pile.operate();
  const Bodies& bodies = pile.state.bodies;
  EXPECT_NEAR(budget(bodies).mass, 500.0 * 2e4, 1e-6);
  const double factor = bodies.mass[0] / before.mass[0];
  EXPECT_EQ(bodies.position, before.position);
  EXPECT_EQ(bodies.velocity, before.velocity);
  EXPECT_EQ(bodies.volume, before.volume);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_LT((angular_velocity(bodies, b) - angular_velocity(before, b)).norm(), 1e-15);
    EXPECT_NEAR(bodies.mass[b], bodies.spheres.mass[2 * b] + bodies.spheres.mass[2 * b + 1],
                1e-9 * bodies.mass[b]);
    EXPECT_LT((bodies.inertia[b] - factor * before.inertia[b]).norm(), 1e-12 * bodies.inertia[b].norm());
  }
}

TEST(Operate, ScalingBySizeKeepsMassesAndMotion) {
  Pile pile("scale = { density = 500, volume = 2e4, by = 'size' }\n");
  const Bodies before = pile.state.bodies;
  pile.operate();
  const Bodies& bodies = pile.state.bodies;
  EXPECT_EQ(bodies.mass, before.mass);
  EXPECT_EQ(bodies.velocity, before.velocity);
  const double factor = std::cbrt(budget(before).mass / 2e4 / 500.0);
  EXPECT_NEAR(budget(bodies).mass / pile.state.region_volume, 500.0, 1e-9);
  const Spheres &now = bodies.spheres, &then = before.spheres;
  ASSERT_EQ(now.size(), 1458u);
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 7}, {3, 1400}}) {
    EXPECT_NEAR((now.position[a] - now.position[b]).norm(),
                factor * (then.position[a] - then.position[b]).norm(), 1e-9);
    EXPECT_NEAR(now.radius[a], factor * then.radius[a], 1e-12);
  }
  EXPECT_LT((budget(bodies).center - budget(before).center).norm(), 1e-9);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    EXPECT_LT((angular_velocity(bodies, b) - angular_velocity(before, b)).norm(), 1e-15);
  EXPECT_NEAR(pile.contacts[0].memory.slide.z, 3.0 * factor, 1e-12);
}

TEST(Operate, AssigningChangesTheBodiesOfTheRegionOnly) {
  Pile pile(
      "assign = { region = { kind = 'box', size = [20, 20, 20] }, density_factor = 1.5, material = 'ice' "
      "}\n");
  const Bodies before = pile.state.bodies;
  const Vec3 middle = budget(before).center;
  pile.operate();
  const Bodies& bodies = pile.state.bodies;
  std::size_t changed = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bool in = (before.position[b] - middle).cwiseAbs().maxCoeff() < 10.0;
    changed += in;
    EXPECT_EQ(bodies.material[b], in ? 1 : 0);
    EXPECT_NEAR(bodies.mass[b] / before.mass[b], in ? 1.5 : 1.0, 1e-12);
  }
  EXPECT_GT(changed, 50u);
}

TEST(Operate, SaysWhatCannotBeDone) {
  const auto error = [](const std::string& operation) -> std::string {
    try {
      Pile(operation).operate();
    } catch (const InputError& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_EQ(error("scale = { density = 500 }\n"),
            "do.toml:20:9: key 'stage[0].scale': no region has been carved whose volume is known; expected "
            "'volume'");
  EXPECT_EQ(error("carve = { region = { kind = 'ball', radius = 0.1, position = [1e3, 0, 0] } }\n"),
            "do.toml:20:9: key 'stage[0].carve': no body is left");
  EXPECT_EQ(error("assign = { region = { kind = 'ball', radius = 1e6 }, outside = true, density = 1 }\n"),
            "do.toml:20:10: key 'stage[0].assign': no body is outside the region");
  EXPECT_NE(error("carve = { region = { kind = 'mesh', file = 'none.obj' } }\n").find("none.obj"),
            std::string::npos);
  const auto same = error("carve = { region = { kind = 'ball', radius = 1 } }\nscale = { density = 1 }\n");
  EXPECT_EQ(same, "do.toml:21:9: key 'stage[0].scale': expected only one of 'carve', 'scale' or 'assign'");
  EXPECT_EQ(
      error("scale = { density = 1 }\nduration = 3\n"),
      "do.toml:21:12: key 'stage[0].duration': has no effect in a stage that carves, scales or assigns");
}

}  // namespace
}  // namespace cairn
