// What a scene file says arrives in the structs, and the key table is the whole of what there is to say.
#include "io/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "io/scene_keys.h"
#include "unit/io/sample_scenes.h"

namespace cairn {
namespace {

Scene parse(const std::string& text) {
  return parse_scene(text, "scene.toml", "some/where");
}

TEST(Scene, TopLevelAndCloudArrive) {
  const Scene scene = parse(kPileScene);
  EXPECT_EQ(scene.title, "Two materials, grains of two shapes");
  EXPECT_EQ(scene.seed, 9223372036854775807u);
  EXPECT_EQ(scene.mass_model, MassModel::spheres);
  EXPECT_EQ(scene.text, kPileScene);
  EXPECT_EQ(scene.directory, "some/where");
  ASSERT_EQ(scene.clouds.size(), 1u);
  const CloudSpec& cloud = scene.clouds[0];
  EXPECT_EQ(cloud.count, 500);
  EXPECT_EQ(cloud.filling, 0.05);
  EXPECT_EQ(cloud.distribution, SizeDistribution::power_law);
  EXPECT_EQ(cloud.size, 4.0);
  EXPECT_EQ(cloud.size_max, 32.0);
  EXPECT_EQ(cloud.exponent, 3.5);
  EXPECT_EQ(cloud.density, 3000.0);
  EXPECT_EQ(cloud.material, "rough");
  EXPECT_EQ(cloud.position, Vec3(1, -2.5, 3000));
  EXPECT_EQ(cloud.velocity, Vec3(0.5, 0, -1));
  EXPECT_EQ(cloud.spin_period, 18000.0);
  ASSERT_EQ(cloud.shapes.size(), 2u);
  EXPECT_EQ(cloud.shapes[0].shape, "tetrahedron");
  EXPECT_EQ(cloud.shapes[0].weight, 3.0);
  EXPECT_EQ(cloud.shapes[1].shape, "grains/long.toml");
  EXPECT_EQ(cloud.shapes[1].weight, 1.0);
}

TEST(Scene, MaterialsContactAndGravityArrive) {
  const Scene scene = parse(kPileScene);
  ASSERT_EQ(scene.materials.size(), 2u);
  const Material& rough = scene.materials[0];
  EXPECT_EQ(rough.name, "rough");
  EXPECT_EQ(rough.restitution_normal, 0.5);
  EXPECT_EQ(rough.restitution_tangential, 0.6);
  EXPECT_EQ(rough.friction, 0.7);
  EXPECT_EQ(rough.friction_rolling, 0.8);
  EXPECT_EQ(rough.friction_twisting, 0.9);
  EXPECT_EQ(rough.shape_factor, 0.4);
  EXPECT_EQ(rough.cohesion, 120.0);
  EXPECT_EQ(rough.stiffness, 3e7);
  EXPECT_EQ(rough.stiffness_ratio, 0.8);
  EXPECT_EQ(scene.contact.stiffness, 1e7);
  EXPECT_EQ(scene.contact.time_step, 0.01);
  EXPECT_TRUE(scene.contact.unsafe_time_step);
  EXPECT_EQ(scene.contact.steps_per_contact, 40.0);
  EXPECT_EQ(scene.contact.max_overlap, 0.02);
  EXPECT_EQ(scene.contact.overlap_limit, 0.2);
  EXPECT_EQ(scene.contact.damping_mass, DampingMass::spheres);
  EXPECT_EQ(scene.contact.rolling_slip, RollingSlip::zhang2017);
  EXPECT_EQ(scene.gravity.method, GravityMethod::direct);
  EXPECT_EQ(scene.gravity.opening_angle, 0.6);
  EXPECT_EQ(scene.gravity.order, 6);
  EXPECT_EQ(scene.gravity.interval.unit, Interval::Unit::steps);
  EXPECT_EQ(scene.gravity.interval.value, 10.0);
  EXPECT_EQ(scene.gravity.field, Vec3(0, 0, -9.81));
}

TEST(Scene, StagesAndOutputArrive) {
  const Scene scene = parse(kPileScene);
  ASSERT_EQ(scene.stages.size(), 2u);
  const StageSpec& collapse = scene.stages[0];
  EXPECT_EQ(collapse.name, "collapse");
  EXPECT_EQ(collapse.duration, 5e4);
  EXPECT_EQ(collapse.material, "smooth");
  EXPECT_EQ(collapse.impact_speed, 1.5);
  EXPECT_EQ(collapse.stiffness, 2e7);
  EXPECT_EQ(collapse.time_step, 0.005);
  EXPECT_FALSE(collapse.spin);
  EXPECT_TRUE(scene.stages[1].material.empty());
  ASSERT_TRUE(scene.stages[1].spin);
  const SpinSpec& spin = *scene.stages[1].spin;
  ASSERT_EQ(spin.path.size(), 3u);
  EXPECT_EQ(spin.path[1].time, 7000.0);
  EXPECT_EQ(spin.path[1].period, 10800.0);
  EXPECT_EQ(spin.ramp, 500.0);
  EXPECT_EQ(spin.control_interval, 60.0);
  EXPECT_EQ(spin.check_interval, 30.0);
  EXPECT_EQ(spin.remnant_gap, 0.15);
  EXPECT_EQ(spin.axis_hold, 400.0);
  EXPECT_EQ(spin.on_failure, OnFailure::keep);
  EXPECT_EQ(spin.axis_drop, 0.02);
  EXPECT_TRUE(spin.include_shed);
  EXPECT_EQ(spin.after_failure, 3600.0);
  EXPECT_EQ(scene.output.snapshot_interval, 1000.0);
  EXPECT_EQ(scene.output.series_interval, 10.0);
  EXPECT_EQ(scene.output.checkpoint_interval, 60.0);
  EXPECT_EQ(scene.output.remnant_gap, 0.2);
}

TEST(Scene, BodiesAndWallsArriveWithUnitDirections) {
  const Scene scene = parse(kBodyScene);
  EXPECT_EQ(scene.pile, "rubble.h5");
  ASSERT_EQ(scene.bodies.size(), 2u);
  const BodySpec& body = scene.bodies[0];
  EXPECT_EQ(body.shape, "sphere");
  EXPECT_EQ(body.size, 2.0);
  EXPECT_EQ(body.density, 2500.0);
  EXPECT_EQ(body.material, "stone");
  EXPECT_EQ(body.position, Vec3(0, 0, 5));
  EXPECT_EQ(body.velocity, Vec3(1, 2, 3));
  EXPECT_EQ(body.angular_velocity, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(body.orientation.coeffs(), Quat(0, 0, 0, 1).coeffs());
  ASSERT_EQ(scene.walls.size(), 4u);
  EXPECT_EQ(wall_name(scene, 0), "floor_1");
  EXPECT_EQ(wall_name(scene, 1), "1");
  EXPECT_EQ(scene.walls[0].velocity, Vec3(0, 0.1, 0));
  EXPECT_EQ(scene.walls[0].point, Vec3(0, 0, 1));
  EXPECT_LT((scene.walls[0].normal - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_EQ(scene.walls[0].material, "stone");
  const WallSpec &drum = scene.walls[1], &bowl = scene.walls[2], &ball = scene.walls[3];
  EXPECT_EQ(drum.kind, WallKind::cylinder);
  EXPECT_EQ(drum.axis, Vec3::UnitY());
  EXPECT_EQ(drum.radius, 12.0);
  EXPECT_EQ(drum.side, WallSide::outside);
  EXPECT_EQ(drum.angular_velocity, Vec3(0, 0.5, 0));
  EXPECT_EQ(drum.rotation_point, Vec3(5, 0, 1));
  EXPECT_EQ(bowl.kind, WallKind::mesh);
  EXPECT_EQ(bowl.file, "bowl.stl");
  EXPECT_EQ(bowl.unit, 0.001);
  EXPECT_EQ(bowl.oscillation_amplitude, Vec3(0, 0, 0.01));
  EXPECT_EQ(bowl.oscillation_frequency, 20.0);
  EXPECT_EQ(bowl.oscillation_phase, 1.5);
  EXPECT_EQ(bowl.motion_time, 0.25);
  EXPECT_FALSE(drum.motion_time);
  EXPECT_EQ(ball.kind, WallKind::sphere);
  EXPECT_EQ(ball.side, WallSide::inside);
  EXPECT_EQ(ball.load, -5e4);
  EXPECT_EQ(ball.load_axis, Vec3::UnitZ());
  EXPECT_EQ(ball.load_mass, 1e3);
  EXPECT_EQ(ball.load_damping, 10.0);
  EXPECT_FALSE(bowl.load);
  EXPECT_FALSE(body.held);
  EXPECT_EQ(body.walls, (std::vector<std::string>{"floor_1", "3"}));
  EXPECT_FALSE(scene.bodies.at(1).walls);
  ASSERT_TRUE(scene.bodies[1].held);
  EXPECT_EQ(scene.bodies[1].held->velocity, Vec3::UnitZ());
  EXPECT_EQ(scene.bodies[1].held->oscillation_phase, 1.5);
  EXPECT_EQ(scene.bodies[1].held->rotation_point, Vec3(5, 0, 1));
  EXPECT_EQ(ball.rotation_point, Vec3(1, 2, 3));  // turns about its centre unless told otherwise
}

TEST(Scene, FrameBoxAndStrainArrive) {
  const Scene scene = parse(kBoxScene);
  EXPECT_EQ(scene.frame.position, Vec3(1.5e11, 0, -2));
  EXPECT_EQ(scene.frame.velocity, Vec3(0, 3e4, 0));
  ASSERT_TRUE(scene.box);
  EXPECT_EQ(scene.box->size, Vec3(30, 40, 0));
  EXPECT_EQ(scene.stages[0].extension, 2.5);
  EXPECT_EQ(total_duration(scene), 12.5);
  EXPECT_EQ(scene.stages[0].strain_rate, Vec3(-0.01, -0.02, 0));
  EXPECT_EQ(scene.stages[0].packing, 0.64);
}

TEST(Scene, PerturbersArrive) {
  const Scene scene = parse(kPerturberScene);
  ASSERT_EQ(scene.perturbers.size(), 5u);
  const PerturberSpec &earth = scene.perturbers[0], &sun = scene.perturbers[1], &moon = scene.perturbers[2];
  EXPECT_EQ(earth.name, "Earth");
  EXPECT_EQ(earth.gm, 3.986004e14);
  EXPECT_FALSE(earth.mass);
  EXPECT_EQ(earth.radius, 6.371e6);
  EXPECT_TRUE(earth.tidal);
  ASSERT_TRUE(earth.orbit);
  EXPECT_EQ(earth.orbit->eccentricity, 1.5);
  EXPECT_EQ(earth.orbit->periapsis, 2e7);
  EXPECT_EQ(earth.orbit->inclination, 0.5);
  EXPECT_EQ(earth.orbit->node, -1.0);
  EXPECT_EQ(earth.orbit->argument, 2.0);
  EXPECT_EQ(earth.orbit->periapsis_time, 5000.0);
  EXPECT_EQ(earth.orbit->gm, 4e14);
  EXPECT_EQ(sun.mass, 1.989e30);
  ASSERT_TRUE(sun.orbit);
  EXPECT_EQ(sun.orbit->semi_major_axis, 1.5e11);
  EXPECT_EQ(sun.orbit->mean_anomaly, 1.25);
  EXPECT_FALSE(moon.tidal);
  ASSERT_EQ(moon.track.size(), 2u);
  EXPECT_EQ(moon.track[1], (std::vector<double>{1e4, 1e8, 1e7, 0.0, 0.0, 1e3, 0.0}));
  EXPECT_EQ(scene.perturbers[3].track_file, "io.txt");
  EXPECT_EQ(scene.perturbers[4].position, Vec3(1e3, 0, 0));
  EXPECT_EQ(total_duration(scene), 1e4);
}

TEST(Scene, LeftOutKeysKeepTheDefaultsOfTheStructs) {
  const Scene scene = parse(kShortScene);
  const Scene plain;
  EXPECT_EQ(scene.title, plain.title);
  EXPECT_EQ(scene.seed, plain.seed);
  EXPECT_EQ(scene.mass_model, plain.mass_model);
  EXPECT_EQ(scene.bodies[0].size, BodySpec{}.size);
  EXPECT_EQ(scene.bodies[0].orientation.coeffs(), BodySpec{}.orientation.coeffs());
  EXPECT_EQ(scene.clouds[0].filling, CloudSpec{}.filling);
  EXPECT_EQ(scene.clouds[0].exponent, CloudSpec{}.exponent);
  EXPECT_EQ(scene.walls[0].normal, WallSpec{}.normal);
  EXPECT_EQ(scene.contact.stiffness, plain.contact.stiffness);
  EXPECT_EQ(scene.contact.steps_per_contact, plain.contact.steps_per_contact);
  EXPECT_EQ(scene.contact.overlap_limit, plain.contact.overlap_limit);
  EXPECT_EQ(scene.gravity.method, plain.gravity.method);
  EXPECT_EQ(scene.gravity.interval.unit, plain.gravity.interval.unit);
  EXPECT_EQ(scene.stages[0].spin->axis_drop, SpinSpec{}.axis_drop);
  EXPECT_EQ(scene.stages[0].impact_speed, StageSpec{}.impact_speed);
  EXPECT_EQ(scene.output.checkpoint_interval, plain.output.checkpoint_interval);
}

TEST(Scene, WithoutMaterialsTheNominalOneIsSupplied) {
  const Scene scene = parse(kShortScene);
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0].name, "nominal");
  EXPECT_EQ(scene.materials[0].friction, Material{}.friction);
  EXPECT_EQ(scene.bodies[0].material, "nominal");
  EXPECT_EQ(scene.clouds[0].material, "nominal");
  EXPECT_EQ(scene.walls[0].material, "nominal");
}

TEST(Scene, TheOnlyMaterialIsUsed) {
  const Scene scene = parse(std::string(kShortScene) + "[[material]]\nname = \"ice\"\n");
  EXPECT_EQ(scene.bodies[0].material, "ice");
  EXPECT_EQ(scene.walls[0].material, "ice");
  EXPECT_EQ(scene.materials.size(), 1u);
}

TEST(Scene, LaterErrorsCanNameTheLine) {
  const Scene scene = parse(kPileScene);
  EXPECT_STREQ(scene.sources.error("cloud[0].shape[1].shape", "no such shape").what(),
               "scene.toml:22:11: key 'cloud[0].shape[1].shape': no such shape");
  EXPECT_EQ(scene.sources.find("stage[1].stiffness").line, 66u)
      << "an absent key stands where its table does";
}

// Paths of all keys, as "cloud.shape.weight".
void collect(const std::vector<KeyInfo>& keys, const std::string& path, std::set<std::string>& out) {
  for (const KeyInfo& key : keys) {
    out.insert(path + key.name);
    collect(key.nested, path + key.name + ".", out);
  }
}

std::string without_indices(std::string key) {
  for (std::size_t open; (open = key.find('[')) != std::string::npos;)
    key.erase(open, key.find(']', open) - open + 1);
  return key;
}

TEST(SceneKeys, SamplesCoverEveryKey) {
  std::set<std::string> keys, given;
  collect(scene_keys().infos, "", keys);
  for (const char* const text : {kPileScene, kBodyScene, kBoxScene, kPerturberScene, kRecipeScene})
    for (const std::string& key : parse(text).sources.keys()) given.insert(without_indices(key));
  EXPECT_EQ(given, keys);
  EXPECT_GT(keys.size(), 70u);
}

// Where the section of a table begins, whether its heading is [path] or [[path]].
std::size_t section_of(const std::string& reference, const std::string& path) {
  return std::min(reference.find("\n## [" + path + "]\n"), reference.find("\n## [[" + path + "]]\n"));
}

TEST(SceneKeys, EveryKeyStandsInItsTableOfTheReference) {
  const std::string reference = scene_reference();
  const std::function<void(const std::vector<KeyInfo>&, const std::string&)> check =
      [&](const std::vector<KeyInfo>& keys, const std::string& path) {
        const std::size_t begin = path.empty() ? 0 : section_of(reference, path);
        ASSERT_NE(begin, std::string::npos) << path;
        const std::string section = reference.substr(begin, reference.find("\n## ", begin + 1) - begin);
        for (const KeyInfo& key : keys) {
          EXPECT_FALSE(key.help.empty()) << path << " " << key.name;
          if (key.form != KeyInfo::Form::value) {
            check(key.nested, path.empty() ? key.name : path + "." + key.name);
            continue;
          }
          const std::size_t row = section.find("\n| " + key.name + " ");
          const bool first = section.starts_with("| " + key.name + " ");
          ASSERT_TRUE(first || row != std::string::npos) << path << " " << key.name;
          const std::string line = section.substr(row + 1, section.find('\n', row + 1) - row - 1);
          for (const std::string& part :
               {key.type, key.unit, key.bounds, key.help, key.required ? "required" : key.fallback})
            EXPECT_NE(line.find(part), std::string::npos) << line << " lacks " << part;
        }
      };
  check(scene_keys().infos, "");
}

TEST(SceneKeys, ReferenceTakesDefaultsFromTheStructs) {
  const std::string reference = scene_reference();
  const auto row = [&](const std::string& key) {
    const std::size_t begin = reference.find("\n| " + key + " ") + 1;
    return reference.substr(begin, reference.find('\n', begin) - begin);
  };
  EXPECT_NE(row("friction_rolling").find("| 1.05 "), std::string::npos);
  EXPECT_NE(row("checkpoint_interval").find("| 300 "), std::string::npos);
  EXPECT_NE(row("orientation").find("| [1, 0, 0, 0] "), std::string::npos);
  EXPECT_NE(row("damping_mass").find("| 'bodies' "), std::string::npos);
  EXPECT_NE(row("steps_per_contact").find("| 4 <= x <= 1e6 "), std::string::npos);
}

TEST(SceneFile, IsReadWithItsDirectory) {
  const std::filesystem::path directory = std::filesystem::path(testing::TempDir()) / "cairn_scene";
  std::filesystem::create_directories(directory);
  std::ofstream(directory / "a.toml") << kBodyScene;
  const Scene scene = load_scene(directory / "a.toml");
  EXPECT_EQ(scene.directory, directory);
  EXPECT_EQ(scene.text, kBodyScene);
  std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace cairn
