// The same physics from every side: random pairs of random bodies, exchanged, turned, moved, mirrored, split.
#include <gtest/gtest.h>

#include "core/random.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr int kCases = 200, kSteps = 100;
constexpr double kStiffness = 1e7;

/// A body before any transformation: spheres in the frame of its own, mass centre at `position`.
struct Grain {
  Shape shape;
  Vec3 position, velocity, spin;
  Quat orientation;
  std::uint16_t material;
};

/// How a scene is laid out in space: x -> turn (mirror x) + shift.
struct Layout {
  Quat turn = Quat::Identity();
  Vec3 shift = Vec3::Zero();
  bool mirror = false;
  bool reversed = false;  ///< bodies in the opposite order

  Vec3 polar(const Vec3& v) const { return turn * (mirror ? Vec3(-v.x(), v.y(), v.z()) : v); }
  Vec3 axial(const Vec3& v) const { return turn * (mirror ? Vec3(v.x(), -v.y(), -v.z()) : v); }
};

struct Sample {
  std::vector<Grain> grains;
  Material materials[2];
  std::optional<PlaneSurface> wall = {};  ///< of the second material
};

/// A clump of one to four spheres without symmetry.
Shape random_clump(Random& random) {
  Shape shape{"clump", "", {}, {}};
  const int spheres = 1 + static_cast<int>(4.0 * random.uniform());
  for (int k = 0; k < spheres; ++k) {
    shape.centers.push_back(k == 0 ? Vec3::Zero() : Vec3(shape.centers.back() + 1.1 * random.direction()));
    shape.radii.push_back(random.uniform(0.7, 1.3));
  }
  return shape;
}

Material random_material(Random& random, const std::string& name) {
  return {.name = name,
          .restitution_normal = random.uniform(0.1, 1.0),
          .restitution_tangential = random.uniform(0.1, 1.0),
          .friction = random.uniform(0.1, 1.0),
          .friction_rolling = random.uniform(0.1, 1.0),
          .friction_twisting = random.uniform(0.1, 1.0),
          .shape_factor = random.uniform(0.2, 0.8),
          .cohesion = random.uniform(0.0, 2e3)};
}

/// The smallest gap between two clumps placed as they are (m).
double gap(const Grain& a, const Grain& b, const RigidShape& ra, const RigidShape& rb) {
  double least = 1e300;
  const auto place = [](const Grain& g, const RigidShape& r, std::size_t s) -> Vec3 {
    return g.position + g.orientation * (r.axes * r.offsets[s]);
  };
  for (std::size_t i = 0; i < ra.radii.size(); ++i)
    for (std::size_t j = 0; j < rb.radii.size(); ++j)
      least = std::min(least, (place(a, ra, i) - place(b, rb, j)).norm() - ra.radii[i] - rb.radii[j]);
  return least;
}

/// Two clumps that overlap a little and move against each other.
Sample random_pair(Random& random) {
  Sample s;
  s.materials[0] = random_material(random, "first");
  s.materials[1] = random_material(random, "second");
  for (std::uint16_t b = 0; b < 2; ++b)
    s.grains.push_back({random_clump(random), Vec3::Zero(), 0.02 * random.in_ball(), 0.02 * random.in_ball(),
                        random.rotation(), b});
  const RigidShape a = make_rigid(s.grains[0].shape, MassModel::spheres),
                   b = make_rigid(s.grains[1].shape, MassModel::spheres);
  const Vec3 direction = random.direction();
  const double overlap = random.uniform(1e-5, 1e-3);
  double low = 0.0, high = 20.0;  // bisect the distance for that overlap
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    s.grains[1].position = middle * direction;
    (gap(s.grains[0], s.grains[1], a, b) < -overlap ? low : high) = middle;
  }
  return s;
}

/// A clump that is pressed on a plane a little and moves against it.
Sample random_landing(Random& random) {
  Sample s;
  s.materials[0] = random_material(random, "first");
  s.materials[1] = random_material(random, "second");
  s.grains.push_back({random_clump(random), Vec3::Zero(), 0.02 * random.in_ball(), 0.02 * random.in_ball(),
                      random.rotation(), 0});
  const RigidShape shape = make_rigid(s.grains[0].shape, MassModel::spheres);
  PlaneSurface plane{Vec3::Zero(), random.direction()};
  double low = 1e300;
  for (std::size_t k = 0; k < shape.radii.size(); ++k)
    low = std::min(
        low, (s.grains[0].orientation * (shape.axes * shape.offsets[k])).dot(plane.normal) - shape.radii[k]);
  plane.point = (low + random.uniform(1e-5, 1e-3)) * plane.normal + 5.0 * plane.normal.unitOrthogonal();
  s.wall = plane;
  return s;
}

/// Bodies, in the order of the sample, as a run has left them, turned back into the layout of the sample.
struct Outcome {
  std::vector<Vec3> position, force, torque;
};

/// After the first evaluation and after kSteps steps.
struct History {
  Outcome first, last;
  double unbalanced_force = 0.0, unbalanced_torque = 0.0;  ///< N, N m: greatest of all steps
};

History run(const Sample& sample, const Layout& layout, const std::vector<std::size_t>& members) {
  Experiment e(fmt::format(R"(
[contact]
stiffness = {}
[gravity]
method = "none"
[[stage]]
name = "test"
duration = 1e3
[[body]]
shape = "sphere"
density = 1
material = "first"
[[material]]
name = "first"
[[material]]
name = "second"
{}
)",
                           kStiffness, sample.wall ? "[[wall]]\nkind = 'plane'\nmaterial = 'second'" : ""));
  e.scene.materials = {sample.materials[0], sample.materials[1]};
  if (sample.wall)
    e.state.walls.walls[0].surface =
        PlaneSurface{layout.polar(sample.wall->point) + layout.shift, layout.polar(sample.wall->normal)};
  Bodies& bodies = e.state.bodies = Bodies{};
  std::vector<std::size_t> order = members;
  if (layout.reversed) std::reverse(order.begin(), order.end());
  for (const std::size_t g : order) {
    const Grain& grain = sample.grains[g];
    // The mirror image of R p is (S R S)(S p): a mirrored shape in a mirrored attitude.
    Shape shape = grain.shape;
    Quat attitude = grain.orientation;
    if (layout.mirror) {
      for (Vec3& c : shape.centers) c.x() = -c.x();
      attitude = Quat(attitude.w(), attitude.x(), -attitude.y(), -attitude.z());
    }
    add_body(bodies, make_rigid(shape, MassModel::spheres), 0, 1.0, 2000.0, grain.material,
             {.position = layout.polar(grain.position) + layout.shift,
              .orientation = layout.turn * attitude,
              .velocity = layout.polar(grain.velocity),
              .angular_velocity = layout.axial(grain.spin)});
  }
  e.state.remnant.assign(bodies.size(), 1);
  e.begin();
  // One step for all: the choice of the program looks at the whole scene.
  e.physics.contacts.dt = 1e-3;
  const auto back = [&](const Vec3& v, double across, double along) {  // x and y, z when mirrored
    const Vec3 u = layout.turn.conjugate() * v;
    return layout.mirror ? Vec3(across * u.x(), along * u.y(), along * u.z()) : u;
  };
  const auto outcome = [&] {
    Outcome out;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::size_t b = layout.reversed ? order.size() - 1 - k : k;
      out.position.push_back(back(bodies.position[b] - layout.shift, -1.0, 1.0));
      out.force.push_back(back(bodies.force[b], -1.0, 1.0));
      out.torque.push_back(back(bodies.torque[b], 1.0, -1.0));
    }
    return out;
  };
  History all{outcome(), {}};
  for (int k = 0; k < kSteps; ++k) {
    e.advance(1);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      force += bodies.force[b];
      torque += bodies.torque[b] + bodies.position[b].cross(bodies.force[b]);
    }
    all.unbalanced_force = std::max(all.unbalanced_force, force.norm());
    all.unbalanced_torque = std::max(all.unbalanced_torque, torque.norm());
  }
  all.last = outcome();
  return all;
}

/// Greatest difference: forces over k_N r, torques over k_N r^2, positions over r (r = 1 m).
double difference(const Outcome& a, const Outcome& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.position.size(); ++k)
    worst =
        std::max({worst, (a.force[k] - b.force[k]).norm() / kStiffness,
                  (a.torque[k] - b.torque[k]).norm() / kStiffness, (a.position[k] - b.position[k]).norm()});
  return worst;
}

TEST(Symmetry, RandomPairsAreTheSameFromEverySide) {
  struct Worst {
    const char* name;
    double first = 0.0, last = 0.0;
  };
  Worst worst[] = {{"exchange of the two bodies"},
                   {"rotation of the scene"},
                   {"translation by 10 m"},
                   {"mirror image"},
                   {"all of these at once"}};
  double force = 0.0, torque = 0.0, pressed = 0.0;
  const std::vector<std::size_t> both{0, 1};
  for (int c = 0; c < kCases; ++c) {
    Random random(17, static_cast<std::uint64_t>(c));
    const Sample sample = random_pair(random);
    const Quat turn = random.rotation();
    const Vec3 shift = 10.0 * random.direction();
    const Layout layouts[] = {{.reversed = true},
                              {.turn = turn},
                              {.shift = shift},
                              {.mirror = true},
                              {.turn = turn, .shift = shift, .mirror = true, .reversed = true}};
    const History plain = run(sample, {}, both);
    force = std::max(force, plain.unbalanced_force / kStiffness);
    torque = std::max(torque, plain.unbalanced_torque / kStiffness);
    pressed = std::max(pressed, plain.last.force[0].norm() / kStiffness);
    for (std::size_t k = 0; k < std::size(layouts); ++k) {
      const History other = run(sample, layouts[k], both);
      worst[k].first = std::max(worst[k].first, difference(plain.first, other.first));
      worst[k].last = std::max(worst[k].last, difference(plain.last, other.last));
    }
  }
  const std::string cases = fmt::format(", worst of {} random pairs", kCases);
  for (const Worst& w : worst) {
    report::error(std::string(w.name) + ": one evaluation, difference over k_N r" + cases, "same physics",
                  w.first, 1e-12);
    report::error(fmt::format("{}: after {} steps{}", w.name, kSteps, cases), "same physics", w.last, 1e-12);
  }
  report::error("sum of the forces on all bodies, over k_N r" + cases, "zero", force, 1e-15);
  report::error("sum of the torques about the origin, over k_N r^2" + cases, "zero", torque, 1e-14);
  EXPECT_GT(pressed, 1e-4);  // they do press on each other
}

TEST(Symmetry, RandomBodiesOnAWallAreTheSameFromEverySide) {
  struct Worst {
    const char* name;
    double first = 0.0, last = 0.0;
  };
  Worst worst[] = {{"rotation"}, {"translation by 10 m"}, {"mirror image"}, {"all of these at once"}};
  double pressed = 0.0;
  for (int c = 0; c < kCases; ++c) {
    Random random(23, static_cast<std::uint64_t>(c));
    const Sample sample = random_landing(random);
    const Quat turn = random.rotation();
    const Vec3 shift = 10.0 * random.direction();
    const Layout layouts[] = {
        {.turn = turn}, {.shift = shift}, {.mirror = true}, {.turn = turn, .shift = shift, .mirror = true}};
    const History plain = run(sample, {}, {0});
    pressed = std::max(pressed, plain.last.force[0].norm() / kStiffness);
    for (std::size_t k = 0; k < std::size(layouts); ++k) {
      const History other = run(sample, layouts[k], {0});
      worst[k].first = std::max(worst[k].first, difference(plain.first, other.first));
      worst[k].last = std::max(worst[k].last, difference(plain.last, other.last));
    }
  }
  for (const Worst& w : worst) {
    const std::string what = fmt::format("body on a wall, {}: ", w.name);
    report::error(what + fmt::format("one evaluation, difference over k_N r, worst of {} bodies", kCases),
                  "same physics", w.first, 1e-12);
    report::error(what + fmt::format("after {} steps", kSteps), "same physics", w.last, 1e-12);
  }
  EXPECT_GT(pressed, 1e-4);
}

TEST(Symmetry, TwoHalvesThatDoNotMeetAreTwoScenes) {
  double worst = 0.0;
  for (int c = 0; c < kCases / 2; ++c) {
    Random random(19, static_cast<std::uint64_t>(c));
    Sample all = random_pair(random);
    const Sample other = random_pair(random);
    const Vec3 away = 60.0 * random.direction();
    for (Grain g : other.grains) {
      g.position += away;
      all.grains.push_back(g);
    }
    const Outcome whole = run(all, {}, {0, 1, 2, 3}).last;
    const Outcome first = run(all, {}, {0, 1}).last, second = run(all, {}, {2, 3}).last;
    Outcome halves = first;
    for (const auto part : {&Outcome::position, &Outcome::force, &Outcome::torque})
      (halves.*part).insert((halves.*part).end(), (second.*part).begin(), (second.*part).end());
    worst = std::max(worst, difference(whole, halves));
  }
  report::error(fmt::format("two halves run together or apart: difference after {} steps, worst of {}",
                            kSteps, kCases / 2),
                "same physics", worst, 1e-12);
}

}  // namespace
}  // namespace cairn
