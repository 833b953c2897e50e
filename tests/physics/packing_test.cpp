// Frictionless packings at jamming: packing fraction and number of contacts, against isostaticity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.h"
#include "physics/report.h"
#include "physics/scenes.h"

namespace cairn {
namespace {

constexpr double kStiffness = 1e4;  // N/m, of grains of unit radius and density

/// A ball of grains in a cubic box.
Experiment cloud_in_box(const std::string& shape, int count, double edge, int seed) {
  return Experiment(
      fmt::format("seed = {}\n[box]\nsize = [{}, {}, {}]\n", seed, edge, edge, edge) +
      scene_text({.restitution = 0.1},
                 fmt::format("stiffness = {}\nsteps_per_contact = 20\noverlap_limit = 0.5", kStiffness), "",
                 cloud(shape, count, 1.0, 1.0)));
}

class Packing {
 public:
  Packing(const std::string& shape, int count, double edge, int least_contacts, int seed)
      : e_(cloud_in_box(shape, count, edge, seed)), least_(least_contacts) {
    Random random(static_cast<std::uint64_t>(seed), 9);
    for (Vec3& v : e_.state.bodies.velocity) v = 2.0 * random.in_ball();
    e_.begin();
  }

  double fraction() const { return packing_fraction(e_.physics, e_.state.box); }

  /// Strains the box at `rate` (per shortest contact time) until the packing fraction.
  void strain_to(double packing, double rate) {
    StageSpec& stage = e_.scene.stages[0];
    stage.strain_rate = Vec3::Constant(std::copysign(rate, fraction() - packing) / e_.physics.contact_time);
    stage.packing = packing;
    const std::vector<ContactRecord> contacts = e_.state.contacts.records();
    e_.state.clock.step = 0;
    e_.physics = resolve_physics(e_.scene, 0, e_.state.bodies, kStiffness);
    begin_stage(e_.physics, contacts, e_.state, e_.scratch);
    while (e_.state.strain.acts(e_.state.clock.stage_time())) e_.advance(1);
  }

  /// Lets motion die out in a viscous medium, until the net force on a body that others hold is 1e-4 of a
  /// contact force, or nothing is left to hold.
  void relax() {
    for (int k = 0; k < 200; ++k) {
      for (int s = 0; s < 500; ++s) {
        e_.advance(1);
        for (Vec3& v : e_.state.bodies.velocity) v *= 0.995;
        for (Vec3& l : e_.state.bodies.spin) l *= 0.995;
      }
      measure();
      if (held_ == 0 || unbalanced_ < 1e-4 * kStiffness * mean_overlap_) break;
    }
  }

  /// Contacts of bodies that at least `least_` contacts hold, the others taken out one after the other.
  void measure() {
    const Bodies& bodies = e_.state.bodies;
    const std::vector<ContactRecord> records = e_.state.contacts.records();
    const auto body = [&](std::uint32_t s) { return bodies.spheres.body[s]; };
    std::vector<bool> out(bodies.size(), false);
    std::vector<int> contacts(bodies.size(), 0);
    for (bool changed = true; changed;) {
      changed = false;
      std::fill(contacts.begin(), contacts.end(), 0);
      for (const ContactRecord& r : records)
        if (!out[body(r.i)] && !out[body(r.j)]) {
          ++contacts[body(r.i)];
          ++contacts[body(r.j)];
        }
      for (std::size_t b = 0; b < out.size(); ++b)
        if (!out[b] && contacts[b] < least_) out[b] = changed = true;
    }
    held_ = static_cast<std::size_t>(std::count(out.begin(), out.end(), false));
    const int sum = std::accumulate(contacts.begin(), contacts.end(), 0);
    per_body_ = held_ == 0 ? 0.0 : static_cast<double>(sum) / static_cast<double>(held_);
    unbalanced_ = largest_overlap_ = 0.0;
    for (std::size_t b = 0; b < out.size(); ++b)
      if (!out[b]) unbalanced_ = std::max(unbalanced_, bodies.force[b].norm());
    double overlaps = 0.0;
    std::size_t count = 0;
    for (std::size_t slot = 0; slot < e_.state.contacts.slots(); ++slot) {
      const Pair& p = e_.state.contacts.pair(slot);
      if (!e_.state.contacts.touching(slot) || out[body(p.i)] || out[body(p.j)]) continue;
      const auto& x = bodies.spheres.position;
      const double overlap = 2.0 - (x[p.j] - x[p.i] + e_.state.contacts.shift_of(slot)).norm();
      overlaps += overlap;
      ++count;
      largest_overlap_ = std::max(largest_overlap_, overlap);
    }
    mean_overlap_ = count == 0 ? 0.0 : overlaps / static_cast<double>(count);
  }

  /// Compresses to `dense`, relaxes, and opens the box again in steps that halve the overlaps.
  void jam(double loose, double dense) {
    strain_to(loose, 2e-3);
    strain_to(dense, 1e-4);
    relax();
    EXPECT_GT(held_, 0u);
    for (int k = 0; k < 20 && largest_overlap_ > 3e-4; ++k) {
      const double growth = 0.5 * mean_overlap_ / 2.0;  // of the edges
      strain_to(fraction() * std::exp(-3.0 * growth), 1e-4);
      relax();
    }
  }

  std::size_t size() const { return e_.state.bodies.size(); }
  std::size_t held_ = 0;
  double per_body_ = 0.0, mean_overlap_ = 0.0, largest_overlap_ = 0.0, unbalanced_ = 0.0;
  std::uint64_t steps() const { return e_.state.clock.total_steps; }

 private:
  Experiment e_;
  int least_;
};

void print(const std::string& what, const Packing& p) {
  fmt::print(
      "{}: packing {:.4f}, {} of {} held, {:.3f} contacts each, overlaps {:.2e} mean, {:.2e} at most, net "
      "force {:.1e} of a contact's, {} steps\n",
      what, p.fraction(), p.held_, p.size(), p.per_body_, p.mean_overlap_, p.largest_overlap_,
      p.unbalanced_ / (kStiffness * p.mean_overlap_), p.steps());
}

TEST(Packings, SmoothSpheresJamAtRandomClosePacking) {
  Packing p("sphere", 500, 27.4, 4, 1);
  p.jam(0.60, 0.65);
  print("spheres", p);
  report::error("smooth spheres, isotropic compression: greatest overlap, in radii", "hard spheres",
                p.largest_overlap_, 3e-4);
  report::near("the same: packing fraction at jamming", "random close packing", p.fraction(), 0.64, 0.01);
  report::near("the same: contacts of a sphere that is held", "isostatic, 2 x 3", p.per_body_, 6.0, 0.2);
  report::within("the same: part of the spheres that is held", "rattlers are a few per cent",
                 static_cast<double>(p.held_) / static_cast<double>(p.size()), 0.93, 1.0);
}

TEST(Packings, SmoothDumbbellsAreIsostatic) {
  Packing p("dumbbell", 200, 37.5, 6, 2);
  p.jam(0.62, 0.74);
  print("dumbbells", p);
  report::error("smooth dumbbells (centres sqrt 3 radii apart): greatest overlap, in radii", "hard grains",
                p.largest_overlap_, 3e-4);
  report::near("the same: contacts of a dumbbell that is held", "isostatic, 2 x 5", p.per_body_, 10.0, 0.4);
  report::within("the same: packing fraction at jamming", "denser than spheres", p.fraction(), 0.65, 0.74);
}

}  // namespace
}  // namespace cairn
