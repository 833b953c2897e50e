// The same physics anywhere: near the zero, 1.5e11 m away at 30 km/s, and in two places 1e9 m apart.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/budget.h"
#include "body/cells.h"
#include "core/random.h"
#include "physics/report.h"
#include "physics/scenes.h"
#include "sim/warnings.h"

namespace cairn {
namespace {

const Vec3 kFar(1.5e11, -6.3e10, 2.2e9);  // m
const Vec3 kFast(3e4, -1.2e4, 7.7e3);     // m/s

std::string scene(const std::string& gravity, const std::string& bodies) {
  return fmt::format(R"(
[[material]]
name = "rough"
restitution_normal = 0.4
cohesion = 5
[contact]
stiffness = 1e7
overlap_limit = 1
steps_per_contact = 20
[gravity]
method = "{}"
[[stage]]
name = "blow"
duration = 1e6
{}
)",
                     gravity, bodies);
}

/// An off-centre blow of two rough aggregates at 1 m/s.
Experiment blow() {
  return Experiment(scene("none", R"(
[[body]]
shape = "tetrahedron"
density = 2000
velocity = [1, 0, 0]
angular_velocity = [0.5, 0.2, -0.3]
orientation = [0.9, 0.1, 0.4, 0.2]
[[body]]
shape = "cube"
density = 2000
position = [3.6, 0.7, -0.4]
angular_velocity = [0, 0.2, 0.6]
)"));
}

struct Difference {
  double place = 0.0, velocity = 0.0, spin = 0.0;  // greatest, m, m/s, of the greater spin
  int steps_apart = 0;                             // while the two bodies were in different cells
};

/// The blow `there` against the one near the zero; the clock of both runs from before the first touch.
Difference compare(Experiment& here, Experiment& there, std::uint64_t steps) {
  Difference out;
  here.begin();
  there.begin();
  for (std::uint64_t k = 0; k < steps; ++k) {
    here.advance(1);
    there.advance(1);
    const Bodies &a = here.state.bodies, &b = there.state.bodies;
    if (!b.cell.empty() && b.cell[0] != b.cell[1]) ++out.steps_apart;
    out.place = std::max(out.place, (separation(a, 0, 1) - separation(b, 0, 1)).norm());
    out.velocity =
        std::max(out.velocity, ((a.velocity[1] - a.velocity[0]) - (b.velocity[1] - b.velocity[0])).norm());
    out.spin = std::max(out.spin, (a.spin[0] - b.spin[0]).norm() / a.spin[0].norm());
  }
  return out;
}

TEST(Frames, ABlowFarAwayIsTheBlowNearTheZero) {
  const std::uint64_t steps = 1500;
  // In the frame that a scene gets: the bodies' own.
  Experiment here = blow(), framed = blow();
  displace(framed.state.bodies, kFar, kFast);
  const Frame frame = take_frame(framed.state.bodies);
  place_spheres(framed.state.bodies);
  EXPECT_LT((frame.position - kFar).norm(), 4e3);
  const Difference own = compare(here, framed, steps);
  EXPECT_GT(here.state.ledger.dissipated, 100.0);  // J; they did meet
  report::error("blow of a tetrahedron and a cube 1.5e11 m away at 34 km/s: relative place, in radii",
                "the same blow at the zero", own.place, 1e-9);
  report::error("the same: relative velocity (m/s, of 1 m/s)", "the same blow at the zero", own.velocity,
                1e-9);
  report::error("the same: spin, relative", "the same blow at the zero", own.spin, 1e-9);

  // In a frame in which the bodies do move that fast, with a border of the cells where they touch.
  Experiment again = blow(), moving = blow();
  Bodies& bodies = moving.state.bodies;
  again.begin();
  while (!again.touching()) again.advance(1);
  const double touch = again.state.clock.time();
  again = blow();
  const double edge = bodies.cell_edge, reach = kCellReach * edge;
  const Vec3 fast(20.0, 3e4, -7e3);
  displace(bodies, 2e7 * edge * Vec3::UnitX(), fast);
  for (Vec3& x : bodies.position) x.x() += reach - fast.x() * (touch + 0.05);
  const Difference raw = compare(again, moving, steps);
  EXPECT_GT(raw.steps_apart, 0);
  report::error("the same in a frame at rest, across a border of cells: relative place, in radii",
                "the same blow at the zero", raw.place, 1e-9);
  report::error("the same: relative velocity (m/s, of 1 m/s)", "the same blow at the zero", raw.velocity,
                1e-9);
}

/// Two clouds of grains that fall together, at x = 0 and at x = `apart`.
std::string two_clouds(double apart, bool both) {
  const auto cloud = [](double x, double y) {
    return fmt::format(R"(
[[cloud]]
count = 30
filling = 0.2
size = 4
density = 3000
material = "rough"
position = [{}, 0, 0]
velocity = [0, {}, 0]
shape = [{{ shape = "tetrahedron" }}, {{ shape = "dumbbell" }}]
)",
                       x, y);
  };
  return cloud(0.0, 0.25) + (both ? cloud(apart, -0.25) : "");
}

/// Throws every cloud together.
void squeeze(Bodies& bodies, const Vec3& second) {
  Random random(5, 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vec3 from = b < 30 ? bodies.position[b] : Vec3(place(bodies, b) - second);
    bodies.velocity[b] += 0.2 * random.in_ball() - 0.03 * from;
  }
}

TEST(Frames, PartsOfABinaryAreAsGoodAsOneAlone) {
  const double apart = 1e9;
  Experiment alone(scene("none", two_clouds(apart, false))), binary(scene("none", two_clouds(apart, true)));
  ASSERT_TRUE(alone.state.bodies.cell.empty());
  ASSERT_EQ(binary.state.bodies.cell.size(), 60u);
  squeeze(alone.state.bodies, Vec3::Zero());
  squeeze(binary.state.bodies, separation(binary.state.bodies, 0, 30));
  // Rounding differs with the place in a cell, and every blow multiplies it: start from the same offsets.
  for (std::size_t b = 0; b < 30; ++b) {
    alone.state.bodies.position[b] = binary.state.bodies.position[b];
    alone.state.bodies.velocity[b] = binary.state.bodies.velocity[b];
  }
  alone.begin();
  binary.begin();
  double place = 0.0, overlap = 0.0, deepest = 0.0;
  std::size_t contacts = 0;
  for (int k = 0; k < 60; ++k) {
    alone.advance(100);
    binary.advance(100);
    const Bodies &a = alone.state.bodies, &b = binary.state.bodies;
    for (std::size_t i = 1; i < 30; ++i)
      place = std::max(place, (separation(a, 0, i) - separation(b, 0, i)).norm());
    const auto records = alone.state.contacts.records();
    contacts = std::max(contacts, records.size());
    for (const ContactRecord& r : records) {
      const auto depth = [&](const Bodies& c) {
        const Spheres& s = c.spheres;
        const Vec3 d = separation(c, s.body[r.i], s.body[r.j]) + (s.position[r.j] - c.position[s.body[r.j]]) -
                       (s.position[r.i] - c.position[s.body[r.i]]);
        return s.radius[r.i] + s.radius[r.j] - d.norm();
      };
      deepest = std::max(deepest, depth(a));
      overlap = std::max(overlap, std::abs(depth(a) - depth(b)));
    }
  }
  EXPECT_GT(contacts, 10u);
  EXPECT_GT(deepest, 1e-3);
  report::error("binary 1e9 m wide, 6000 steps: overlaps of a part, in radii (4 m)", "that part alone",
                overlap / 4.0, 1e-9);
  report::error("the same: places in the part, in radii", "that part alone", place / 4.0, 1e-9);
}

TEST(Frames, PlacesTooFarFromTheZeroAreWarnedOf) {
  // Walls stay where they are, and their bodies with them: no frame of their own.
  const auto said = [](double height) {
    Experiment e(scene_text({}, "stiffness = 1e6", "",
                            body({.position = {0, 0, height + 1.0}}) + wall(Vec3::UnitZ(), {0, 0, height})));
    e.begin();
    return fmt::format("{}", fmt::join(warnings(e.physics, e.state.bodies, e.state.walls), "\n"));
  };
  EXPECT_EQ(said(1e6), "");
  const std::string far = said(1e10);
  EXPECT_NE(far.find("places 1e+10 m from the zero are rounded to 2e-06 of the smallest radius"),
            std::string::npos)
      << far;
}

TEST(Frames, BinaryKeepsItsAngularMomentum) {
  const double apart = 1e9;
  for (const bool wide : {false, true}) {
    Experiment binary(scene("direct", two_clouds(wide ? apart : 150.0, true)));
    squeeze(binary.state.bodies, separation(binary.state.bodies, 0, 30));
    binary.begin();
    const Budget before = budget(binary.state.bodies);
    double drift = 0.0, linear = 0.0;
    for (int k = 0; k < 20; ++k) {
      binary.advance(500);
      const Budget now = budget(binary.state.bodies);
      drift = std::max(drift, angular_drift(before, now));
      linear = std::max(linear, momentum_drift(before, now));
    }
    EXPECT_GT(binary.state.ledger.dissipated, 1000.0);
    const std::string what = wide ? "binary 1e9 m wide" : "binary 150 m wide";
    report::error(what + ", direct gravity, 1e4 steps: drift of the total angular momentum, relative", "0",
                  drift, 1e-12);
    report::error(what + ": drift of the total momentum, relative", "0", linear, 1e-12);
  }
  report::note(
      "Far from the origin and far apart: places are kept in cells, so a pile 1.5e11 m away and each part of "
      "a binary behave as one at the origin. Give single bodies that touch each other there from a [frame] "
      "near "
      "them. With walls or a periodic box places are counted from the zero of the scene; the program warns "
      "where "
      "that costs more than 1e-9 of a radius.");
}

}  // namespace
}  // namespace cairn
