#include "pile/assemble.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

const std::string kCloud = R"(
[[cloud]]
count = 20
filling = 0.1
size = 2
density = 3000
material = "rock"
position = [{}, 0, 0]
shape = [{{ shape = "{}" }}]
)";

TEST(Assemble, PutsCloudsAndThenBodiesAndNamesTheirShapes) {
  const Scene scene = parse_scene(
      fmt::format(fmt::runtime(kCloud), 0, "cube") + fmt::format(fmt::runtime(kCloud), 100, "rod4") + R"(
[[body]]
shape = "cube"
size = 3
density = 1500
material = "ice"
position = [1, 2, 300]
velocity = [4, 5, 6]
angular_velocity = [0, 0, 0.5]
orientation = [0, 0, 0, 1]
[[material]]
name = "rock"
[[material]]
name = "ice"
[[stage]]
name = "s"
duration = 1
)",
      "assemble.toml", ".");
  const auto setup = assemble(scene);
  const Bodies& bodies = setup.bodies;
  ASSERT_EQ(bodies.size(), 41u);
  EXPECT_EQ(setup.shapes, (std::vector<std::string>{"cube", "rod4"}));
  for (std::size_t b = 0; b < 40; ++b) {
    EXPECT_EQ(bodies.shape[b], b / 20);
    EXPECT_EQ(bodies.material[b], 0u);
  }
  EXPECT_EQ(bodies.shape[40], 0u);
  EXPECT_EQ(bodies.material[40], 1u);
  EXPECT_EQ(bodies.position[40], Vec3(1.0, 2.0, 300.0));
  EXPECT_EQ(bodies.velocity[40], Vec3(4.0, 5.0, 6.0));
  EXPECT_EQ(bodies.length[40], 3.0);
  EXPECT_NEAR(bodies.mass[40] / bodies.mass[0], 0.5 * 27.0 / 8.0, 1e-12);
  EXPECT_LT((angular_velocity(bodies, 40) - Vec3(0.0, 0.0, 0.5)).norm(), 1e-15);
}

TEST(Assemble, CloudsOfOneSceneAreNotCopiesOfEachOther) {
  const Scene scene = parse_scene(fmt::format(fmt::runtime(kCloud), 0, "cube") +
                                      fmt::format(fmt::runtime(kCloud), 100, "cube") +
                                      "[[material]]\nname = 'rock'\n[[stage]]\nname = 's'\nduration = 1\n",
                                  "assemble.toml", ".");
  const Bodies bodies = assemble(scene).bodies;
  ASSERT_EQ(bodies.size(), 40u);
  for (std::size_t b = 0; b < 20; ++b)
    EXPECT_GT((bodies.position[20 + b] - bodies.position[b] - Vec3(100.0, 0.0, 0.0)).norm(), 1e-3);
}

}  // namespace
}  // namespace cairn
