// The shape library and the messages for bad shape files.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "core/error.h"
#include "core/suggest.h"
#include "folder.h"
#include "shape/library.h"

namespace cairn {
namespace {

namespace fs = std::filesystem;

class LibraryTest : public testing::Test {
 protected:
  void TearDown() override { unsetenv("CAIRN_SHAPES"); }

  fs::path write(const std::string& file, const std::string& text) const {
    std::ofstream(directory_ / file) << text;
    return directory_ / file;
  }

  // The message for a bad file, which must be one line that begins with the file's name.
  std::string message(const std::string& text) const {
    const fs::path path = write("bad.toml", text);
    try {
      load_shape("bad.toml", directory_);
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      EXPECT_TRUE(what.starts_with(path.string() + ":")) << what;
      return what.substr(path.string().size());
    }
    return "accepted";
  }

  const Folder scratch_;
  const fs::path directory_ = scratch_.path();
};

const std::string kGood = "name = \"grain\"\n[[sphere]]\ncenter = [0, 0.5, 0]\nradius = 1\n";

TEST_F(LibraryTest, TextsThatTheParserWouldNotSurviveAreRefused) {
  std::string deep;
  for (int i = 0; i < 1'000'000; ++i) deep += "a.";
  EXPECT_EQ(message(deep + "a = 1"), ":1:16: a key has more than 8 parts");
  EXPECT_EQ(message("name \uFD00 = 1"), ":1:6: expected only ASCII characters outside strings and comments");
  EXPECT_EQ(message("a = 1\"\u06DB\""), ":1:6: expected only ASCII characters outside strings and comments");
  EXPECT_EQ(message("description = 'größe'  # µ\n" + kGood), "accepted");
}

TEST_F(LibraryTest, EveryShapeLoads) {
  const std::vector<std::string> names = library_names();
  for (const char* name : {"sphere", "dumbbell", "rod4", "diamond", "tetrahedron", "cube", "octahedron",
                           "l_shape", "cross", "ellipsoid", "slab", "needle"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const Shape shape = load_shape(name);
    EXPECT_EQ(shape.name, name);
    EXPECT_FALSE(shape.description.empty());
    const RigidShape rigid = make_rigid(shape, MassModel::union_volume);
    EXPECT_TRUE(std::isfinite(rigid.moment_error));
    EXPECT_LT(rigid.moment_error, 0.1);
    RecordProperty(name + "_moment_error", std::to_string(rigid.moment_error));
    EXPECT_LT(rigid.inertia[2], rigid.inertia[0] + rigid.inertia[1]);
  }
}

TEST_F(LibraryTest, EllipsoidFillsItsEllipsoid) {
  const Shape shape = load_shape("ellipsoid");
  const RigidShape rigid = make_rigid(shape, MassModel::union_volume);
  EXPECT_LT(rigid.volume, 4.0 * kPi);
  EXPECT_GT(rigid.volume, 0.85 * 4.0 * kPi);
  EXPECT_NEAR(rigid.bounding_radius, 2.0, 0.01);
}

TEST_F(LibraryTest, ReadsFilesRelativeToTheBase) {
  write("grain.toml", kGood);
  const Shape shape = load_shape("grain.toml", directory_);
  EXPECT_EQ(shape.name, "grain");
  EXPECT_EQ(shape.description, "");
  EXPECT_EQ(shape.centers.at(0), Vec3(0.0, 0.5, 0.0));
  EXPECT_EQ(shape.radii.at(0), 1.0);
  EXPECT_EQ(load_shape((directory_ / "grain.toml").string()).name, "grain");
}

TEST_F(LibraryTest, EnvironmentChoosesTheDirectory) {
  write("pebble.toml", kGood);
  setenv("CAIRN_SHAPES", directory_.c_str(), 1);
  EXPECT_EQ(library_names(), std::vector<std::string>{"pebble"});
  EXPECT_EQ(load_shape("pebble").name, "grain");
  setenv("CAIRN_SHAPES", (directory_ / "none").c_str(), 1);
  EXPECT_THROW(library_names(), InputError);
}

TEST_F(LibraryTest, UnknownNameSuggestsTheNearest) {
  try {
    load_shape("tetraedron");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'tetrahedron'?"), std::string::npos)
        << error.what();
  }
  for (const char* name : {"", "xyzzyxyzzy", ".."}) {
    try {
      load_shape(name);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("expected one of "), std::string::npos) << error.what();
    }
  }
}

TEST_F(LibraryTest, MessagesNameLineColumnAndKey) {
  EXPECT_EQ(message(kGood + "radus = 2\n"), ":5:1: key 'radus': unknown, did you mean 'radius'?");
  EXPECT_EQ(message("descripton = \"x\"\n" + kGood),
            ":1:1: key 'descripton': unknown, did you mean 'description'?");
  EXPECT_EQ(message("name = \"a\"\nzzzzzzzzz = 1\n"),
            ":2:1: key 'zzzzzzzzz': unknown, expected name, description, body, mesh, error, fit, sphere");
  EXPECT_EQ(message("name = 3\n"), ":1:8: key 'name': expected one line of text in quotes");
  EXPECT_EQ(message("name = \"\"\n"), ":1:8: key 'name': expected a name, found an empty string");
  EXPECT_EQ(message("name = \"a\"\n"), ":1:1: key 'sphere': missing, expected at least one [[sphere]] table");
  EXPECT_EQ(message("name = \"a\"\nsphere = []\n"),
            ":2:10: key 'sphere': expected one [[sphere]] table for each sphere");
  EXPECT_EQ(message("name = \"a\"\n[sphere]\nradius = 1\n"),
            ":2:1: key 'sphere': expected one [[sphere]] table for each sphere");
  EXPECT_EQ(message("name = \"a\"\n[[sphere]]\nradius = 1\n").substr(0, 37),
            ":2:1: key 'center': missing, expected");
  EXPECT_EQ(message(kGood + "[[sphere]]\ncenter = [0, 0.5, 0.0]\nradius = 1.0\n"),
            ":5:1: key 'sphere': expected distinct spheres, found a copy of the one on line 2");
}

TEST_F(LibraryTest, RejectsBadNumbers) {
  const auto sphere = [&](const std::string& center, const std::string& radius) {
    return message("name = \"a\"\n[[sphere]]\ncenter = " + center + "\nradius = " + radius + "\n");
  };
  for (const char* radius : {"0", "-1", "nan", "inf", "true", "\"1\"", "[1]", "1e9", "1e-9"})
    EXPECT_TRUE(sphere("[0, 0, 0]", radius).starts_with(":4:10: key 'radius': expected a number")) << radius;
  for (const char* center : {"0", "[0, 0]", "[0, 0, 0, 0]", "\"x\"", "{ x = 1 }"})
    EXPECT_TRUE(sphere(center, "1").starts_with(":3:10: key 'center': expected three numbers")) << center;
  for (const char* center : {"[nan, 0, 0]", "[inf, 0, 0]", "[-1e7, 0, 0]", "[\"0\", 0, 0]"})
    EXPECT_TRUE(sphere(center, "1").starts_with(":3:11: key 'center': expected three numbers")) << center;
}

TEST_F(LibraryTest, MassesOfTheShapesOwnAreReadAndRefused) {
  const std::string second = "[[sphere]]\ncenter = [1, 0, 0]\nradius = 1\n", body = "[body]\n";
  EXPECT_EQ(message(kGood + "mass = 2\n" + second + "mass = 1e-3\n" + body + "inertia = [1, 1, 2]\n"),
            "accepted");
  const Shape shape = load_shape("bad.toml", directory_);
  EXPECT_EQ(shape.own.of_spheres, (std::vector{2.0, 1e-3}));
  EXPECT_EQ(shape.own.inertia, Mat3(Vec3(1, 1, 2).asDiagonal()));
  EXPECT_FALSE(shape.own.center);
  EXPECT_TRUE(message(kGood + second + "mass = 1\n")
                  .starts_with(":8:8: key 'mass': expected masses of all spheres or of none"));
  EXPECT_TRUE(
      message(kGood + "mass = 1\n" + second).starts_with(":6:1: key 'mass': missing, expected a number"));
  for (const char* mass : {"0", "-1", "nan", "inf", "true", "\"1\"", "1e31"})
    EXPECT_TRUE(message(kGood + "mass = " + mass + "\n").starts_with(":5:8: key 'mass': expected a number"))
        << mass;
  EXPECT_TRUE(message(kGood + body + "inertias = 1\n")
                  .starts_with(":6:1: key 'inertias': unknown, did you mean 'inertia'?"));
  for (const char* inertia : {"1", "[1, 1]", "[1, 1, 1, 0]", "[1, 1, 1, 0, 0, nan]", "['a', 1, 1]"})
    EXPECT_NE(message(kGood + body + "inertia = " + inertia + "\n").find("key 'inertia': expected"),
              std::string::npos)
        << inertia;
  EXPECT_TRUE(message(kGood + body + "inertia = [1, 2, 4]\n")
                  .starts_with(":6:11: key 'inertia': expected no principal moment above the sum"));
  EXPECT_TRUE(message(kGood + body + "inertia = [2, 2, 2, 0.5, 0.5, 0.5]\n") == "accepted");
  EXPECT_TRUE(message(kGood + body + "inertia = [2, 2, 2, 2, 0, 0]\n")
                  .starts_with(":6:11: key 'inertia': expected principal moments above 0"));
  EXPECT_TRUE(message(kGood + body + "center_of_mass = [0, 0, 0]\n")
                  .starts_with(":6:18: key 'center_of_mass': expected an inertia about it"));
  EXPECT_TRUE(
      message(kGood + "mass = 1\n" + body + "center_of_mass = [0, 0, 0]\n")
          .starts_with(":7:18: key 'center_of_mass': expected that of the spheres' masses, [0, 0.5, 0]"));
}

TEST_F(LibraryTest, InertiaIsHeldAgainstTheReachFromTheCentreOfTheMassesGiven) {
  // The light sphere is 11 from the mass centre; the mean by volume is in the middle.
  const auto end = [&](const char* light, const char* inertia) {
    return message(kGood + "mass = 1\n[[sphere]]\ncenter = [10, 0.5, 0]\nradius = 1\nmass = " + light +
                   "\n[body]\ninertia = " + inertia + "\n");
  };
  EXPECT_EQ(end("1e-6", "[150, 150, 150]"), "accepted");  // a radius of gyration of 15
  EXPECT_NE(end("1", "[150, 150, 150]").find("whose spheres reach 6 from its mass centre, found 15"),
            std::string::npos);
  EXPECT_NE(end("1e-6", "[400, 400, 400]").find("whose spheres reach 11 from its mass centre, found 24.49"),
            std::string::npos);
}

TEST_F(LibraryTest, MassesOfTheShapesOwnAreWritten) {
  Shape shape{
      .name = "grain", .description = "", .centers = {Vec3::Zero(), Vec3::UnitX()}, .radii = {1.0, 0.3}};
  shape.own.of_spheres = {1.0, 1.0 / 3.0};
  save_shape(shape, directory_ / "grain.toml", false);
  EXPECT_EQ(load_shape("grain.toml", directory_).own.of_spheres, shape.own.of_spheres);
  shape.own.center = Vec3(0.25, 0.0, 0.0);
  shape.own.inertia = (Mat3() << 1.0, 0.1, 0.0, 0.1, 1.0 / 3.0, -0.2, 0.0, -0.2, 0.9).finished();
  save_shape(shape, directory_ / "grain.toml", true);
  const Shape back = load_shape("grain.toml", directory_);
  EXPECT_EQ(back.own.center, shape.own.center);
  EXPECT_EQ(back.own.inertia, shape.own.inertia);
}

TEST_F(LibraryTest, RejectsWhatIsNotToml) {
  EXPECT_TRUE(message("name = \n").starts_with(":1:")) << message("name = \n");
  EXPECT_NE(message("name = \"a\"\nname = \"b\"\n").find(":2:"), std::string::npos);
  EXPECT_NE(message("name = \"\xff\"\n"), "accepted");
  EXPECT_NE(message(std::string("name\0 = 1\n", 10)), "accepted");
  EXPECT_NE(message(std::string(5000, '[')), "accepted");
  EXPECT_NE(message("name = \"a\\nb\"\n"), "accepted");
  EXPECT_NE(message("\"a\\nb\" = 1\n"), "accepted");
  EXPECT_EQ(message(""), ":1:1: key 'name': missing, expected one line of text in quotes");
}

TEST_F(LibraryTest, RejectsWhatIsNotAFile) {
  EXPECT_THROW(load_shape("none.toml", directory_), InputError);
  fs::create_directory(directory_ / "folder.toml");
  EXPECT_THROW(load_shape("folder.toml", directory_), InputError);
  ASSERT_EQ(mkfifo((directory_ / "pipe.toml").c_str(), 0600), 0);
  EXPECT_THROW(load_shape("pipe.toml", directory_), InputError);
  write("large.toml", "");
  fs::resize_file(directory_ / "large.toml", (std::uintmax_t{64} << 20) + 1);
  EXPECT_THROW(load_shape("large.toml", directory_), InputError);
}

TEST_F(LibraryTest, MeshesAreNotShapes) {
  for (const char* name : {"rock.obj", "a/rock.STL", "rock.ply", "rock.off"}) {
    try {
      load_shape(name, directory_);
      FAIL();
    } catch (const InputError& error) {
      EXPECT_TRUE(
          std::string(error.what())
              .starts_with(std::string(name) + ": expected a shape file, found a mesh: `cairn shape fit`"))
          << error.what();
    }
  }
}

TEST_F(LibraryTest, OnlyShapesThatReadBackAreWritten) {
  Shape shape{.name = "grain", .description = "", .centers = {Vec3::Zero()}, .radii = {1.0}};
  save_shape(shape, directory_ / "grain.toml", false);
  EXPECT_EQ(load_shape("grain.toml", directory_).name, "grain");
  const auto refused = [&](const Shape& bad, const std::string& words) {
    try {
      save_shape(bad, directory_ / "bad.toml", true);
      ADD_FAILURE() << words;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
    EXPECT_FALSE(fs::exists(directory_ / "bad.toml"));
  };
  shape.name = "two\nlines";
  refused(shape, "bad.toml (not written):1:8: key 'name': expected one line of text");
  shape.name = "grain";
  shape.radii[0] = 1e-9;
  refused(shape, "key 'radius'");
  shape.radii[0] = 1.0;
  shape.source = SourceMesh{};
  shape.source->file = "rock.obj";
  shape.source->size = 1e-30;
  refused(shape, "key 'size': expected a number from 1e-12 to 1e+12");
}

TEST(NearestName, FewestEdits) {
  EXPECT_EQ(nearest_name("cubes", {"cross", "cube", "sphere"}), "cube");
  EXPECT_EQ(nearest_name("shpere", {"cross", "cube", "sphere"}), "sphere");
  EXPECT_EQ(nearest_name("banana", {"cross", "cube", "sphere"}), "");
  EXPECT_EQ(nearest_name("", {"cross"}), "");
}

}  // namespace
}  // namespace cairn
