// Every mistake in a scene is one line that says where, which key, and what was expected.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "io/scene.h"

namespace cairn {
namespace {

std::string error_of(const std::string& text) {
  try {
    parse_scene(text, "s.toml", ".");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// A scene without fault on lines 1 to 6, to which a test adds from line 7 on.
const std::string kGood = "[[body]]\nshape = 'sphere'\ndensity = 1000\n[[stage]]\nname = 'a'\nduration = 1\n";

struct Case {
  std::string added, message;
};

void expect_errors(const std::string& start, const std::vector<Case>& cases) {
  EXPECT_EQ(error_of(kGood), "no error");
  for (const auto& [added, message] : cases) EXPECT_EQ(error_of(start + added), message) << added;
}

TEST(SceneErrors, UnknownKeys) {
  expect_errors(
      kGood,
      {{"[contact]\nstifness = 1",
        "s.toml:8:1: key 'contact.stifness': unknown key; did you mean 'stiffness'?"},
       {"[gravity]\ncontact = 1",
        "s.toml:8:1: key 'gravity.contact': unknown key; expected 'method', 'error', 'opening_angle', "
        "'order', 'interval' or 'field'"},
       {"[gravity]\nerror = 1e-4\nopening_angle = 0.5",
        "s.toml:9:17: key 'gravity.opening_angle': expected either 'error' or 'opening_angle'"},
       {"[gravity]\norder = 6",
        "s.toml:8:9: key 'gravity.order': has no effect without opening_angle; 'error' chooses the order"},
       {"[contat]", "s.toml:7:2: key 'contat': unknown key; did you mean 'contact'?"},
       {"[stage.spin]\npath = [[0, 1]]\ninclude_shde = true",
        "s.toml:9:1: key 'stage[0].spin.include_shde': unknown key; did you mean 'include_shed'?"},
       {"[contact]\n  \"a\\nb\\u202E\" = 1\n[gravity]\nx = 1",
        "s.toml:8:3: key 'contact.a\\nb\\u202E': unknown key; expected 'enabled', 'stiffness', 'time_step', "
        "'unsafe_time_step', 'steps_per_contact', 'max_overlap', 'overlap_limit', 'damping_mass' or "
        "'rolling_slip'"}});
}

TEST(SceneErrors, WrongTypes) {
  expect_errors(
      kGood,
      {{"[contact]\nstiffness = '1e7'",
        "s.toml:8:13: key 'contact.stiffness': expected a number in N/m, found a string"},
       {"[contact]\nmax_overlap = true",
        "s.toml:8:15: key 'contact.max_overlap': expected a number, found a boolean"},
       {"[contact]\nunsafe_time_step = 1",
        "s.toml:8:20: key 'contact.unsafe_time_step': expected true or false, found an integer"},
       {"[gravity]\ninterval = 2.0",
        "s.toml:8:12: key 'gravity.interval': expected 'auto', an integer number of steps, or seconds such "
        "as "
        "'5 s', found a floating-point number"},
       {"[gravity]\nmethod = 1979-05-27",
        "s.toml:8:10: key 'gravity.method': expected 'none', 'direct' or 'tree', found a date or time"},
       {"[gravity]\nfield = 9.81",
        "s.toml:8:9: key 'gravity.field': expected an array of 3 numbers in m/s^2, found a floating-point "
        "number"},
       {"[gravity]\nfield = [0, '1', 0]",
        "s.toml:8:13: key 'gravity.field[1]': expected a number in m/s^2, found a string"},
       {"[gravity]\nfield = [0, 1]",
        "s.toml:8:9: key 'gravity.field': expected an array of 3 numbers in m/s^2, found an array of 2"},
       {"[[material]]\nname = 5", "s.toml:8:8: key 'material[0].name': expected a string, found an integer"},
       {"[material]\nname = 'x'", "s.toml:7:1: key 'material': expected tables [[material]], found a table"},
       {"[[gravity]]", "s.toml:7:1: key 'gravity': expected a table [gravity], found an array"},
       {"[[wall]]\nkind = 'plane'\n[[cloud]]\nshape = ['sphere']",
        "s.toml:10:10: key 'cloud[0].shape[0]': expected a table [cloud.shape], found a string"},
       {"[stage.spin]\npath = [[0, 1, 2]]",
        "s.toml:8:9: key 'stage[0].spin.path[0]': expected an array of 2 numbers in s, found an array of 3"},
       {"[stage.spin]\npath = 3",
        "s.toml:8:8: key 'stage[0].spin.path': expected an array of pairs of numbers in s, found an "
        "integer"}});
}

TEST(SceneErrors, OutOfBounds) {
  expect_errors(
      kGood,
      {{"[[material]]\nname = 'm'\nrestitution_normal = 1.2",
        "s.toml:9:22: key 'material[0].restitution_normal': expected 0 <= x <= 1, found 1.2"},
       {"[contact]\nstiffness = 0",
        "s.toml:8:13: key 'contact.stiffness': expected 0 < x <= 1e20 in N/m, found 0"},
       {"[contact]\ntime_step = nan",
        "s.toml:8:13: key 'contact.time_step': expected a finite number in s, found nan"},
       {"[gravity]\nfield = [0, -inf, 0]",
        "s.toml:8:13: key 'gravity.field[1]': expected a finite number in m/s^2, found -inf"},
       {"[gravity]\ninterval = 0", "s.toml:8:12: key 'gravity.interval': expected 0 < x <= 1e6, found 0"},
       {"[gravity]\nmethod = 'tre'",
        "s.toml:8:10: key 'gravity.method': expected 'none', 'direct' or 'tree', found 'tre'; did you mean "
        "'tree'?"},
       {"[[material]]\nname = ''",
        "s.toml:8:8: key 'material[0].name': expected a string of 1 to 64 bytes, found 0"},
       {"[[material]]\nname = \"a\\tb\"",
        "s.toml:8:8: key 'material[0].name': expected text without control characters, found 'a\\tb'"}});
  EXPECT_EQ(error_of("seed = -1\n" + kGood), "s.toml:1:8: key 'seed': expected 0 <= x, found -1");
  EXPECT_EQ(error_of("title = '" + std::string(201, 'x') + "'\n" + kGood),
            "s.toml:1:9: key 'title': expected a string of 0 to 200 bytes, found 201");
}

TEST(SceneErrors, MissingKeysNameTheirTable) {
  expect_errors(
      kGood,
      {{"\n[[material]]\nfriction = 1",
        "s.toml:8:1: key 'material[0].name': missing key; table 'material[0]' that starts "
        "on line 8 requires it (string)"},
       {"[[lattice]]\nsize = 1\nregion = { kind = 'ball', radius = 1 }",
        "s.toml:7:1: key 'lattice[0].density': missing key; table 'lattice[0]' that starts on "
        "line 7 requires it (number in kg/m^3)"},
       {"[[body]]\nshape = 'x'", "s.toml:7:1: key 'body[1]': expected one of the keys 'density' or 'mass'"},
       {"[[body]]\nshape = 'x'\ndensity = 1\nmass = 2",
        "s.toml:10:8: key 'body[1].mass': expected only one of 'density' or 'mass'"},
       {"[[cloud]]\ncount = 1\nsize = 1\ndensity = 1\nshape = []",
        "s.toml:7:1: key 'cloud[0].shape': missing key; table 'cloud[0]' that starts on "
        "line 7 requires it (at least one [[...]] table)"},
       {"[stage.spin]",
        "s.toml:7:1: key 'stage[0].spin.path': missing key; table 'stage[0].spin' that "
        "starts on line 7 requires it ([[a, b], ...] in s)"}});
  EXPECT_EQ(error_of(""),
            "s.toml:1:1: key 'stage': missing key; the file requires it (at least one "
            "[[...]] table)");
  EXPECT_EQ(error_of("[[stage]]\nname = 'a'\nduration = 1\n"),
            "s.toml:1:1: the scene has no bodies; expected 'pile', [[lattice]], [[cloud]] or [[body]]");
}

TEST(SceneErrors, SyntaxAndDuplicates) {
  expect_errors(
      kGood,
      {{"[contact]\nstiffness = 1\n  stiffness = 2", "s.toml:9:3: key 'stiffness': given twice"},
       {"[contact]\n[gravity]\n[contact]", "s.toml:9:1: key 'contact': given twice"},
       {"gravity = { interval = 1, interval = 2 }", "s.toml:7:27: key 'interval': given twice"},
       {"[contact\nstiffness = 1", "s.toml:7:9: syntax error: parsing table header: expected ']', saw '\\n'"},
       {"[contact]\nstiffness = ",
        "s.toml:8:13: syntax error: parsing key-value pair: encountered end-of-file"},
       {"title = \"\xff\"", "s.toml:7:9: syntax error: Encountered invalid utf-8 sequence"}});
  EXPECT_EQ(error_of(std::string(1, '\0')),
            "s.toml:1:1: syntax error: parsing root table: expected keys, tables, whitespace or comments, "
            "saw '\\u0000'");
}

TEST(SceneErrors, Materials) {
  const std::string two = "[[material]]\nname = 'ice'\n[[material]]\nname = 'rock'\n";
  EXPECT_EQ(error_of(kGood + two),
            "s.toml:1:1: key 'body[0].material': missing key; required because there are several materials, "
            "expected 'ice' or 'rock'");
  EXPECT_EQ(error_of(kGood + "[[wall]]\nkind = 'plane'\nmaterial = 'nominl'"),
            "s.toml:9:12: key 'wall[0].material': no [[material]] is called 'nominl'; did you mean "
            "'nominal'?");
  EXPECT_EQ(error_of(kGood + "material = 'wood'\n[[material]]\nname = 'ice'"),
            "s.toml:7:12: key 'stage[0].material': no [[material]] is called 'wood'; expected 'ice'");
  EXPECT_EQ(error_of(kGood + "[[material]]\nname = 'ice'\n[[material]]\nname = 'ice'"),
            "s.toml:10:8: key 'material[1].name': expected a name of its own, found 'ice' for a second time");
}

TEST(SceneErrors, Clouds) {
  // Lines 7 to 11; the test adds from line 12 on.
  const std::string cloud =
      kGood + "[[cloud]]\ncount = 9\nsize = 2\ndensity = 1\nshape = [{ shape = 'a', weight = 1 }]\n";
  EXPECT_EQ(error_of(cloud), "no error");
  EXPECT_EQ(error_of(cloud + "distribution = 'uniform'\nsize_max = 2"), "no error");
  expect_errors(
      cloud, {{"distribution = 'uniform'",
               "s.toml:7:1: key 'cloud[0].size_max': missing key; required unless the "
               "distribution is 'single'"},
              {"distribution = 'uniform'\nsize_max = 1.5",
               "s.toml:13:12: key 'cloud[0].size_max': expected at least the size of 2 m, found 1.5"},
              {"size_max = 3",
               "s.toml:12:12: key 'cloud[0].size_max': has no effect with the distribution 'single'"},
              {"exponent = 3",
               "s.toml:12:12: key 'cloud[0].exponent': has no effect unless the distribution is "
               "'power_law'"},
              {"filling = 0.4", "s.toml:12:11: key 'cloud[0].filling': expected 0 < x <= 0.3, found 0.4"}});
  EXPECT_EQ(error_of(kGood +
                     "[[cloud]]\ncount = 9\nsize = 2\ndensity = 1\nshape = [{ shape = 'a', weight = 0 }]\n"),
            "s.toml:11:9: key 'cloud[0].shape': expected a positive sum of weights, found 0");
}

TEST(SceneErrors, Directions) {
  expect_errors(kGood, {{"[[wall]]\nkind = 'plane'\nnormal = [0, 0, 0]",
                         "s.toml:9:10: key 'wall[0].normal': expected a vector other than zero"},
                        {"[[body]]\nshape = 'a'\ndensity = 1\norientation = [0, 0, 0, 0.0]",
                         "s.toml:10:15: key 'body[1].orientation': expected a vector other than zero"}});
}

TEST(SceneErrors, LatticesRegionsAndOperations) {
  const std::string lattice = "[[lattice]]\nsize = 1\ndensity = 1\n[lattice.region]\n";
  expect_errors(
      kGood,
      {{lattice + "kind = 'bal'",
        "s.toml:11:8: key 'lattice[0].region.kind': expected 'ball', 'ellipsoid', 'box' or 'mesh', found "
        "'bal'; "
        "did you mean 'ball'?"},
       {lattice + "kind = 'ball'",
        "s.toml:10:1: key 'lattice[0].region.radius': missing key; required because the kind is 'ball'"},
       {lattice + "kind = 'mesh'",
        "s.toml:10:1: key 'lattice[0].region.file': missing key; required because the kind is 'mesh'"},
       {lattice + "kind = 'box'\nradius = 3",
        "s.toml:12:10: key 'lattice[0].region.radius': has no effect unless the kind is 'ball'"},
       {lattice + "kind = 'box'",
        "s.toml:10:1: key 'lattice[0].region.size': missing key; required because the kind is 'ellipsoid' or "
        "'box'"},
       {lattice + "kind = 'ball'\nradius = 1\norientation = [0, 0, 0, 0]",
        "s.toml:13:15: key 'lattice[0].region.orientation': expected a vector other than zero"},
       {"[[stage]]\nname = 'x'\n[stage.assign]\nregion = { kind = 'ball', radius = 1 }",
        "s.toml:9:1: key 'stage[1].assign': expected one of the keys 'density', 'density_factor' or "
        "'material'"},
       {"[[stage]]\nname = 'x'\nduration = 1\nquiet_speed = 0",
        "s.toml:10:15: key 'stage[1].quiet_speed': expected 0 < x <= 1e6 in m/s, found 0"}});
}

TEST(SceneErrors, WallsHaveTheKeysOfTheirKind) {
  expect_errors(
      kGood,
      {{"[[wall]]\npoint = [0, 0, 1]",
        "s.toml:7:1: key 'wall[0].kind': missing key; table 'wall[0]' that starts on line 7 requires it "
        "(string)"},
       {"[[wall]]\nkind = 'box'",
        "s.toml:8:8: key 'wall[0].kind': expected 'plane', 'sphere', 'cylinder' or 'mesh', found 'box'"},
       {"[[wall]]\nkind = 'sphere'",
        "s.toml:7:1: key 'wall[0].radius': missing key; required because the kind is 'sphere' or "
        "'cylinder'"},
       {"[[wall]]\nkind = 'mesh'",
        "s.toml:7:1: key 'wall[0].file': missing key; required because the kind is 'mesh'"},
       {"[[wall]]\nkind = 'plane'\nradius = 3",
        "s.toml:9:10: key 'wall[0].radius': has no effect unless the kind is 'sphere' or 'cylinder'"},
       {"[[wall]]\nkind = 'sphere'\nradius = 3\naxis = [0, 0, 1]",
        "s.toml:10:8: key 'wall[0].axis': has no effect unless the kind is 'cylinder'"},
       {"[[wall]]\nkind = 'cylinder'\nradius = 3\nfile = 'a.stl'",
        "s.toml:10:8: key 'wall[0].file': has no effect unless the kind is 'mesh'"},
       {"[[wall]]\nkind = 'cylinder'\nradius = 3\naxis = [0, 0, 0]",
        "s.toml:10:8: key 'wall[0].axis': expected a vector other than zero"},
       {"[[wall]]\nkind = 'plane'\noscillation_amplitude = [0, 0, 1]",
        "s.toml:7:1: key 'wall[0].oscillation_frequency': missing key; required because there is an "
        "oscillation_amplitude"},
       {"[[wall]]\nkind = 'plane'\noscillation_phase = 1",
        "s.toml:9:21: key 'wall[0].oscillation_phase': has no effect without oscillation_amplitude"},
       {"[[wall]]\nkind = 'plane'\nname = 'a/b'",
        "s.toml:9:8: key 'wall[0].name': expected letters, digits, '_' and '-' only, found 'a/b'"},
       {"[[wall]]\nkind = 'plane'\nload = 1",
        "s.toml:7:1: key 'wall[0].load_mass': missing key; required because there is a load"},
       {"[[wall]]\nkind = 'plane'\nload_mass = 1",
        "s.toml:9:13: key 'wall[0].load_mass': has no effect without load"},
       {"[[wall]]\nkind = 'sphere'\nradius = 3\nload = 1\nload_mass = 2",
        "s.toml:7:1: key 'wall[0].load_axis': missing key; required because there is a load, and the kind is "
        "not "
        "'plane'"},
       {"[[wall]]\nkind = 'plane'\nload = 1\nload_mass = 2\nvelocity = [1, 0, 1]",
        "s.toml:11:12: key 'wall[0].velocity': expected a direction across load_axis, along which the load "
        "moves "
        "the wall"},
       {"[[body]]\nshape = 'sphere'\ndensity = 1\nwalls = ['lid']\n[[wall]]\nkind = 'plane'",
        "s.toml:10:9: key 'body[1].walls': no [[wall]] is called 'lid'; expected some of '0'"},
       {"[[body]]\nshape = 'sphere'\ndensity = 1\nwalls = ['lid']",
        "s.toml:10:9: key 'body[1].walls': no [[wall]] is called 'lid'; the scene has none"},
       {"[[body]]\nshape = 'sphere'\ndensity = 1\nheld = {}\nvelocity = [1, 0, 0]",
        "s.toml:11:12: key 'body[1].velocity': has no effect on what is held; expected it in 'held'"},
       {"[[body]]\nshape = 'sphere'\ndensity = 1\nheld = { oscillation_phase = 1 }",
        "s.toml:10:30: key 'body[1].held.oscillation_phase': has no effect without oscillation_amplitude"},
       {"[[body]]\nshape = 'sphere'\ndensity = 1\nheld = { rotation_point = [1, 0, 0] }",
        "s.toml:10:27: key 'body[1].held.rotation_point': has no effect without a rotation; expected "
        "angular_velocity beside it"},
       {"[[body]]\nshape = 'sphere'\ndensity = 1\n[body.held]\nangular_velocity = [0, 0, 0]\nrotation_point "
        "= [1, 0, 0]",
        "s.toml:12:18: key 'body[1].held.rotation_point': has no effect without a rotation; expected "
        "angular_velocity beside it"},
       {"[[wall]]\nkind = 'plane'\nload = 1\nload_mass = 2\nmotion_time = 3",
        "s.toml:11:15: key 'wall[0].motion_time': has no effect without a motion that is prescribed; "
        "expected "
        "velocity, oscillation_amplitude or angular_velocity beside it, a load moves the wall from its "
        "place"},
       {"[[wall]]\nkind = 'plane'\nvelocity = [0, 0, 0]\nmotion_time = 3",
        "s.toml:10:15: key 'wall[0].motion_time': has no effect without a motion that is prescribed; "
        "expected velocity, oscillation_amplitude or angular_velocity beside it"},
       {"[[wall]]\nkind = 'plane'\nname = '12'",
        "s.toml:9:8: key 'wall[0].name': expected more than digits, which stand for walls without a name, "
        "found '12'"},
       {"[[wall]]\nkind = 'plane'\nname = 'lid'\n[[wall]]\nkind = 'plane'\nname = 'lid'",
        "s.toml:12:8: key 'wall[1].name': expected a name of its own, found 'lid' for a second time"},
       {"[[wall]]\nkind = 'plane'\nname = 'lid'\n[[wall]]\nkind = 'plane'\nname = 'lid_mean'",
        "s.toml:12:8: key 'wall[1].name': found 'lid_mean' beside 'lid', whose columns of the series have "
        "such "
        "names; expected another"}});
}

TEST(SceneErrors, Stages) {
  expect_errors(
      kGood,
      {{"[[stage]]\nname = 'a'\nduration = 2",
        "s.toml:8:8: key 'stage[1].name': expected a name of its own, found 'a' for a second time"},
       {"spin.path = []", "s.toml:7:13: key 'stage[0].spin.path': expected at least one pair [time, period]"},
       {"spin.path = [[0, 10], [5, 0]]",
        "s.toml:7:23: key 'stage[0].spin.path[1]': expected a period above 0 s, found 0"},
       {"spin.path = [[0, 10], [5, 9], [5, 8]]",
        "s.toml:7:31: key 'stage[0].spin.path[2]': expected a time after 5 s, found 5"},
       {"spin.path = [[-1, 10]]",
        "s.toml:7:15: key 'stage[0].spin.path[0][0]': expected 0 <= x <= 1e15 in s, found -1"},
       {"spin.path = [[0, 10]]\nrelax = {}",
        "s.toml:8:9: key 'stage[0].relax': a stage either relaxes or is spun; expected no 'spin'"},
       {"strain_rate = [1, 0, 0]\nrelax = {}\n[gravity]\nmethod = 'none'\n[box]\nsize = [9, 9, 9]",
        "s.toml:8:9: key 'stage[0].relax': a stage either relaxes or is strained; expected no 'strain_rate'"},
       {"relax = { rate = 0 }",
        "s.toml:7:18: key 'stage[0].relax.rate': expected 0 < x <= 1e12 in 1/s, found 0"},
       {"[[stage]]\nname = 'x'\nscale = { density = 1, volume = 1 }\nrelax = {}",
        "s.toml:10:9: key 'stage[1].relax': has no effect in a stage that carves, scales or assigns"},
       {"[contact]\noverlap_limit = 0.001",
        "s.toml:8:17: key 'contact.overlap_limit': expected max_overlap <= overlap_limit, found 0.01 and "
        "0.001"}});
  EXPECT_EQ(error_of(kGood + "[contact]\nmax_overlap = 0.05\noverlap_limit = 0.05"), "no error");
}

TEST(SceneErrors, StiffnessesOfMaterials) {
  const std::string one = kGood + "[[material]]\nname = 'a'\n";  // lines 7 and 8
  expect_errors(
      one,
      {{"stiffness = 0", "s.toml:9:13: key 'material[0].stiffness': expected 0 < x <= 1e20 in N/m, found 0"},
       {"stiffness = 'hard'",
        "s.toml:9:13: key 'material[0].stiffness': expected a number in N/m, found a string"},
       {"stiffness_ratio = 0",
        "s.toml:9:19: key 'material[0].stiffness_ratio': expected 0 < x <= 10, found 0"},
       {"stiffness_ratio = 10.5",
        "s.toml:9:19: key 'material[0].stiffness_ratio': expected 0 < x <= 10, found 10.5"},
       {"stiffness = 5\n[contact]\nstiffness = 3",
        "s.toml:11:13: key 'contact.stiffness': has no effect, because every material has a stiffness of its "
        "own"}});
  // A stage's counts where its material or that of a wall takes it.
  const std::string bodies =
      "[[material]]\nname = 'a'\nstiffness = 5\n[[material]]\nname = 'b'\n"
      "[[body]]\nshape = 'sphere'\ndensity = 1000\nmaterial = 'b'\n[[stage]]\nname = 'a'\nduration = 1\n";
  const std::string of_a = "stiffness = 3\nmaterial = 'a'\n";  // on line 13
  EXPECT_EQ(
      error_of(bodies + of_a),
      "s.toml:13:13: key 'stage[0].stiffness': has no effect, because the materials of the stage have a "
      "stiffness of their own");
  EXPECT_EQ(error_of(bodies + of_a + "[[wall]]\nkind = 'plane'\nmaterial = 'b'\n"), "no error");
  EXPECT_EQ(error_of(bodies + "stiffness = 3\nmaterial = 'b'\n"), "no error");
}

TEST(SceneErrors, Perturbers) {
  const std::string one = kGood + "[[perturber]]\nname = 'P'\n";  // lines 7 and 8
  const std::string moon = one + "mass = 1\n";                    // line 9; the test adds from line 10 on
  EXPECT_EQ(error_of(moon + "position = [1, 0, 0]"), "no error");
  expect_errors(
      one,
      {{"position = [1, 0, 0]", "s.toml:7:1: key 'perturber[0]': expected one of the keys 'mass' or 'gm'"},
       {"mass = 1\ngm = 1\nposition = [1, 0, 0]",
        "s.toml:10:6: key 'perturber[0].gm': expected only one of 'mass' or 'gm'"},
       {"mass = 1\norbit = 3",
        "s.toml:10:9: key 'perturber[0].orbit': expected a table [perturber.orbit], found an integer"}});
  expect_errors(
      moon,
      {{"",
        "s.toml:7:1: key 'perturber[0]': expected one of the keys 'position', 'orbit', 'track' or "
        "'track_file'"},
       {"position = [1, 0, 0]\n[perturber.orbit]\neccentricity = 0\nperiapsis = 1",
        "s.toml:11:1: key 'perturber[0].orbit': expected only one of 'position', 'orbit', 'track' or "
        "'track_file'"},
       {"position = [0, 0, 0]",
        "s.toml:10:12: key 'perturber[0].position': expected a place other than the zero, which falls freely "
        "in its pull unless tidal = false"},
       {"orbit = { eccentricity = -0.1 }",
        "s.toml:10:26: key 'perturber[0].orbit.eccentricity': expected 0 <= x <= 1e6, found -0.1"},
       {"orbit = { eccentricity = 0.5 }",
        "s.toml:10:9: key 'perturber[0].orbit': expected one of the keys 'periapsis' or 'semi_major_axis'"},
       {"orbit = { eccentricity = 0.5, periapsis = 1, semi_major_axis = 2 }",
        "s.toml:10:64: key 'perturber[0].orbit.semi_major_axis': expected only one of 'periapsis' or "
        "'semi_major_axis'"},
       {"orbit = { eccentricity = 0.5, semi_major_axis = -2 }",
        "s.toml:10:49: key 'perturber[0].orbit.semi_major_axis': expected above 0 for the eccentricity 0.5, "
        "found -2"},
       {"orbit = { eccentricity = 1.5, semi_major_axis = 2 }",
        "s.toml:10:49: key 'perturber[0].orbit.semi_major_axis': expected below 0 for the eccentricity 1.5, "
        "found 2"},
       {"orbit = { eccentricity = 1, periapsis = 2, mean_anomaly = 0 }",
        "s.toml:10:59: key 'perturber[0].orbit.mean_anomaly': a parabola (eccentricity 1) has none"},
       {"orbit = { eccentricity = 0, periapsis = 2, periapsis_time = 1, mean_anomaly = 0 }",
        "s.toml:10:79: key 'perturber[0].orbit.mean_anomaly': expected only one of 'periapsis_time' or "
        "'mean_anomaly'"},
       {"track = [[0, 1, 0, 0], [1, 1, 0, 0]]",
        "s.toml:10:9: key 'perturber[0].track': expected at least 4 rows without velocities, found 2"},
       {"track = [[0, 1, 0, 0, 0, 0, 0]]",
        "s.toml:10:9: key 'perturber[0].track': expected at least 2 rows, found 1"},
       {"track = [[0, 1, 0]]",
        "s.toml:10:10: key 'perturber[0].track[0]': expected a row of 4 or 7 numbers in s, m, m/s, found 3"},
       {"track = [[0, 1, 0, 0], [1, 1, 0, 0, 0, 0, 0]]",
        "s.toml:10:24: key 'perturber[0].track[1]': expected a row of 4 numbers in s, m, m/s, found 7"},
       {"track = [[0, 1, 0, 0], 3]",
        "s.toml:10:24: key 'perturber[0].track[1]': expected a row of 4 numbers in s, m, m/s, found an "
        "integer"},
       {"track = [[0, 1, 0, 0], [2, 1, 0, 0], [2, 1, 0, 0], [3, 1, 0, 0]]",
        "s.toml:10:38: key 'perturber[0].track[2]': expected a time after 2 s, found 2"},
       {"track = [[0, 1, 0, 0, 0, 0, 0], [0.5, 1, 0, 0, 0, 0, 0]]",
        "s.toml:10:9: key 'perturber[0].track': expected times that cover the run, 0 to 1 s, found 0 to 0.5 "
        "s"},
       {"position = [1, 0, 0]\n[gravity]\nmethod = 'none'\n[box]\nsize = [9, 0, 9]",
        "s.toml:7:1: key 'perturber[0]': has no meaning in a periodic box"}});
}

TEST(SceneErrors, TrackFiles) {
  const auto error = [&](const std::string& text) -> std::string {
    try {
      parse_track(text, "track", 10.0);
    } catch (const InputError& caught) {
      const std::string what = caught.what();
      return what.starts_with("track") ? what.substr(5) : what;
    }
    return "no error";
  };
  const std::string good = "# t x y z\n0 1e3, 2e3,\t+3\n\n5, 4 5 6 # half\r\n8 1 1 1\n10 7 8 9";
  EXPECT_EQ(error(good), "no error");
  EXPECT_EQ(parse_track(good, "track", 10.0)[1], (std::vector<double>{5.0, 4.0, 5.0, 6.0}));
  EXPECT_EQ(error("0 1 2 3 4 5 6\n10 7 8 9 0 0 0\n"), "no error");
  EXPECT_EQ(error("0 1 2 3\n5 4 x 6\n"), ":2: expected a number of at most 1e15, found 'x'");
  EXPECT_EQ(error("0 1 2 3\n5 4 nan 6\n"), ":2: expected a number of at most 1e15, found 'nan'");
  EXPECT_EQ(error("0 1 2\n"), ":1: expected a row of 4 or 7 numbers, found 3");
  EXPECT_EQ(error("0 1 2 3\n\n5 4 4\n"), ":3: expected a row of 4 numbers, found 3");
  EXPECT_EQ(error("0 1 2 3\n5 1 2 3\n# x\n4 1 2 3\n10 0 0 0\n"), ":4: expected a time after 5 s, found 4");
  EXPECT_EQ(error("0 1 2 3\n5 1 2 3\n6 1 2 3\n9 0 0 0\n"),
            ":4: expected times that cover the run, 0 to 10 s, found 0 to 9 s");
  EXPECT_EQ(error(""), ":1: expected at least 4 rows without velocities, found 0");
}

TEST(SceneErrors, HostileTexts) {
  std::string deep_key, distinct, rows, brackets = "a = ";
  for (int i = 0; i < 1'000'000; ++i) deep_key += "a.";
  for (int i = 0; i < 120'000; ++i) distinct += fmt::format("[[a{}]]\n", i);
  for (int i = 0; i < 600'000; ++i) rows += "[0,1],";
  brackets.append(1'000'000, '[');
  EXPECT_EQ(error_of(deep_key + "a = 1"), "s.toml:1:16: a key has more than 8 parts");
  EXPECT_EQ(error_of("\n[" + deep_key + "a]"), "s.toml:2:17: a key has more than 8 parts");
  EXPECT_EQ(error_of(distinct), "s.toml:50001:1: more than 50000 tables and dotted keys");
  EXPECT_TRUE(error_of("a = [" + rows).ends_with("more than 1000000 values"));
  EXPECT_TRUE(error_of(brackets).find("maximum nested value depth") != std::string::npos);
  EXPECT_EQ(error_of(std::string(16'000'001, '#')), "s.toml: larger than 16 MB");
  const std::string long_key = error_of(std::string(1'000'000, 'k') + " = 1\n");
  EXPECT_TRUE(long_key.starts_with("s.toml:1:1: key 'kkk"));
  EXPECT_LT(long_key.size(), 1000u);
}

TEST(SceneErrors, CharactersBeyondAsciiBelongInStringsAndComments) {
  EXPECT_EQ(error_of("\xEF\xBB\xBFtitle = 'größe \uFD00'  # µ\n" + kGood), "no error");
  EXPECT_TRUE(error_of("title = [{a='é', b=[\"é\",'é']}]").find("ASCII") == std::string::npos);
  EXPECT_EQ(error_of("title='é'\n" + kGood), "no error");
  EXPECT_EQ(error_of("title = \"\"\"é \\\n  e é \\\\é\"\"\"\n" + kGood), "no error");
  for (const std::string text : {"\nfriction \uFD00 = 1", "\nsize = 10é", "\n[é]", "\n µ", "\nsize = 1\"é\"",
                                 "\nsize = [1, 2=\"é\"]", "\nsize = 1['é']", "\nsize = {a=1=\"é\"}"})
    EXPECT_TRUE(error_of(text).ends_with("expected only ASCII characters outside strings and comments"))
        << error_of(text);
  EXPECT_TRUE(error_of(" é").starts_with("s.toml:1:2: "));
  EXPECT_TRUE(error_of("title = \"\\é\"").ends_with("expected an ASCII character behind '\\'"));
  EXPECT_TRUE(
      error_of("title = \"\"\" \\\r\n \n é\"\"\"").ends_with("expected an ASCII character behind '\\'"));
}

TEST(SceneErrors, DotsAndCommasInsideTextDoNotCount) {
  const std::string dots = "title = 'a.b.c.d.e.f.g.h.i.j' # a.b.c.d.e.f.g.h.i.j\n";
  EXPECT_EQ(error_of(dots + kGood), "no error");
  EXPECT_EQ(error_of("title = \"\"\"a.b.c.d\\\"\"\"e.f.g.h.i.j\"\"\"\"\n" + kGood), "no error");
  EXPECT_EQ(error_of("title = \"\\\\\" # '.........'\n" + kGood), "no error");
  EXPECT_TRUE(
      error_of("title = 'open\npile = 'a.b.c.d.e.f.g.h.i.j'\n").starts_with("s.toml:1:14: syntax error: "));
}

TEST(SceneErrors, FilesThatCannotBeRead) {
  const auto error = [](const std::filesystem::path& path) -> std::string {
    try {
      load_scene(path);
    } catch (const InputError& caught) {
      return caught.what();
    }
    return "no error";
  };
  const std::filesystem::path directory = std::filesystem::path(testing::TempDir()) / "cairn_bad_scene";
  std::filesystem::create_directories(directory);
  const auto in = [&](const char* name) { return (directory / name).string(); };
  ASSERT_EQ(mkfifo(in("pipe").c_str(), 0600), 0);
  std::ofstream(in("long")) << std::string(16'000'001, '\n');
  EXPECT_EQ(error(in("none")), in("none") + ": no such file");
  EXPECT_EQ(error(in("a\nb")), in("a\\nb") + ": no such file");
  EXPECT_EQ(error(directory), directory.string() + ": expected a file, found a directory");
  EXPECT_EQ(error(in("pipe")), in("pipe") + ": expected a file, found a pipe");
  EXPECT_EQ(error(in("long")), in("long") + ": larger than 16 MB");
  std::filesystem::remove_all(directory);
}

TEST(SceneErrors, WhatAPeriodicBoxCannotHave) {
  const std::string box = kGood + "[gravity]\nmethod = 'none'\n[box]\nsize = [9, 0, 9]\n";  // lines 7 to 10
  EXPECT_EQ(error_of(box), "no error");
  expect_errors(kGood, {{"[box]\nsize = [9, 9, 9]",
                         "s.toml:1:1: key 'gravity.method': self-gravity has no meaning in a periodic box; "
                         "expected 'none' with [box]"},
                        {"[gravity]\nmethod = 'tree'\n[box]\nsize = [9, 9, 9]",
                         "s.toml:8:10: key 'gravity.method': self-gravity has no meaning in a periodic box; "
                         "expected 'none' with [box]"},
                        {"strain_rate = [1, 0, 0]",
                         "s.toml:7:15: key 'stage[0].strain_rate': has no effect without a [box]"},
                        {"[gravity]\nmethod = 'none'\n[box]\nsize = [0, 0, 0]",
                         "s.toml:10:8: key 'box.size': expected an edge above 0 m, or a pile that has a box"},
                        {"[box]\nsize = [9, -9, 9]",
                         "s.toml:8:12: key 'box.size[1]': expected 0 <= x <= 1e12 in m, found -9"}});
  const std::string good = box.substr(0, box.find("[gravity]"));
  EXPECT_EQ(error_of(good + "strain_rate = [0, 1, 0]" + box.substr(good.size() - 1)),
            "s.toml:7:15: key 'stage[0].strain_rate': expected 0 along the open directions of the box");
  EXPECT_EQ(
      error_of(good + "packing = 0.6" + box.substr(good.size() - 1)),
      "s.toml:7:11: key 'stage[0].packing': has no effect unless strain_rate changes the volume of the box");
  EXPECT_EQ(error_of(good + "[stage.spin]\npath = [[0, 9]]" + box.substr(good.size() - 1)),
            "s.toml:7:1: key 'stage[0].spin': a periodic box cannot spin");
  EXPECT_EQ(error_of(box + "[[wall]]\nkind = 'plane'\nnormal = [1, 0, 0]"),
            "s.toml:13:10: key 'wall[0].normal': expected 0 along the periodic directions of the box");
  EXPECT_EQ(error_of(box + "[[wall]]\nkind = 'plane'\nnormal = [0, 1, 0]"), "no error");
}

TEST(SceneErrors, KeysThatOnlyContactsGiveAMeaning) {
  const std::string none = kGood + "[contact]\nenabled = false\n";  // lines 7 and 8
  expect_errors(none,
                {{"stiffness = 1",
                  "s.toml:9:13: key 'contact.stiffness': has no effect, because no stage has contacts"},
                 {"overlap_limit = 0.2",
                  "s.toml:9:17: key 'contact.overlap_limit': has no effect, because no stage has contacts"},
                 {"[[wall]]\nkind = 'plane'",
                  "s.toml:9:1: key 'wall[0]': has no effect, because no stage has contacts"}});
  EXPECT_NO_THROW(parse_scene(none + "time_step = 3\n", "s.toml", "."));
  EXPECT_NO_THROW(parse_scene(none + "stiffness = 1\n[[stage]]\nname = 'b'\nduration = 1\ncontacts = true\n",
                              "s.toml", "."));
  const std::string stage = kGood + "[[stage]]\nname = 'b'\nduration = 1\ncontacts = false\n";  // to line 10
  expect_errors(
      stage,
      {{"stiffness = 1", "s.toml:11:13: key 'stage[1].stiffness': has no effect in a stage without contacts"},
       {"impact_speed = 1",
        "s.toml:11:16: key 'stage[1].impact_speed': has no effect in a stage without contacts"},
       {"relax = {}", "s.toml:11:9: key 'stage[1].relax': has no effect in a stage without contacts"},
       {"[stage.relax]\nrate = 1",
        "s.toml:11:1: key 'stage[1].relax': has no effect in a stage without contacts"},
       {"[[wall]]\nkind = 'plane'\nstages = ['b']",
        "s.toml:13:10: key 'wall[0].stages': has no effect in stage 'b', which has no contacts"},
       {"[[stage]]\nname = 'c'\ncontacts = true\nscale = { density = 1, volume = 1 }",
        "s.toml:13:12: key 'stage[2].contacts': has no effect in a stage that carves, scales or assigns"}});
  const Scene scene = parse_scene(stage + "[[wall]]\nkind = 'plane'\n", "s.toml", ".");
  EXPECT_TRUE(contacts_of(scene, 0) && has_wall(scene, 0, 0));
  EXPECT_FALSE(contacts_of(scene, 1) || has_wall(scene, 1, 0));
}

}  // namespace
}  // namespace cairn
